// Modelled time: the work of each stage, divided by the rates of described hardware.
//
// A stage takes as long as its busiest unit. A core works on several bins at a time; where its memory has no room for
// as many, the stages that work on pixels wait as much longer. The model knows no latency, no divergence within warps
// and no driver, so that real frames take longer. Ratios say more than times.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "stages/cost/counters.h"
#include "tools/evaluate/hardware.h"

namespace beampipe {

// What a frame's time depends on.
struct FrameWork {
  const std::vector<StageCounters>& stages;
  double bin_bytes = 0;                                // that the pixels of a bin take on chip; 0: they are in memory
  std::span<const std::uint64_t> bin_operations = {};  // as in FrameResult
};

// Milliseconds of each unit that the stage uses, by name ("triangles", "shader", "dram", ...).
std::map<std::string, double> unit_times(const Hardware& hardware, const Implementation& implementation,
                                         const StageCounters& stage, double bin_bytes = 0);

// How many bins of that size a core has room for, at most as many as it works on at a time, and at least one.
std::uint32_t bins_held(const MemoryParameters& memory, double bin_bytes);

// How much longer the busiest of `cores` works than they do on average. Bins start in their order, each on the core
// that is free first. 1 if there is no work.
double imbalance(std::span<const std::uint64_t> bin_operations, std::uint32_t cores);

// The counters of a frame's stages with what the hardware says that invocations of fragment shaders cost.
std::vector<StageCounters> with_shading(const Hardware& hardware, const std::vector<StageCounters>& stages);

struct StageTime {
  Stage stage;
  double ms = 0;
  std::string busiest;  // the name of the unit that takes so long
};

struct ModelledTime {
  double at_once_ms = 0;  // all stages at once, evenly on all cores: the time of the busiest unit, over all stages
  // After vertex_setup come the bins, each on a core of its own with all its stages at once. A bin's share of the work
  // of cores (shaders, textures, masks, composition) is its share of the operations. Other units serve all bins evenly.
  double on_cores_ms = 0;
  double in_turn_ms = 0;          // one stage after the other: the sum of `stages`
  std::string busiest;            // the unit of at_once_ms
  std::vector<StageTime> stages;  // in the order of the stages
};

ModelledTime modelled_time(const Hardware& hardware, const Implementation& implementation, const FrameWork& work);

}  // namespace beampipe
