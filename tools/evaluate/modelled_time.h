// Modelled time: the work of each stage, divided by the rates of described hardware.
//
// A stage takes as long as its busiest unit. Cores hold several bins at a time, as many as their memory on chip has
// room for. The threads of a bin are its pixels in stages that take the fragments of a pixel in order, and in others
// its items. Where threads in flight are too few to hide how long operations, loads and sectors take, the unit
// `latency` is the busiest. The model knows no divergence within warps and no driver, so that real frames take longer.
// Ratios say more than times.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "stages/cost/counters.h"
#include "tools/evaluate/hardware.h"

namespace beampipe {

// The bins of a frame.
struct BinSize {
  double bytes = 0;   // that the pixels of a bin take on chip; 0: they are in memory
  double pixels = 0;  // of the largest bin; 0: not known, threads fill the cores
};

// What a frame's time depends on.
struct FrameWork {
  const std::vector<StageCounters>& stages;
  BinSize bin = {};
  std::span<const std::uint64_t> bin_operations = {};   // as in FrameResult
  std::span<const std::uint64_t> bin_invocations = {};  // the same
};

// Milliseconds of each unit that the stage uses, by name ("triangles", "shader", "dram", ...), as if it were the only
// one of its frame, in so many bins.
std::map<std::string, double> unit_times(const Hardware& hardware, const Implementation& implementation,
                                         const StageCounters& stage, const BinSize& bin = {}, double bins = 1);

// How the work of cores is spread over bins: operations in stages that shaders can do, and those that the hardware adds
// to each invocation. All are 1 if there is no work, and where nothing is binned.
struct BinSpread {
  double busiest_core = 1;  // its work over the mean of all cores. Bins start in their order, on the core free first
  double p99 = 1;           // work of the bin at rank ceil(99 n / 100), over the mean of bins
  double most = 1;          // the same of the fullest
};
BinSpread bin_spread(const Hardware& hardware, const FrameWork& work);

// The counters of a frame's stages with what the hardware says that invocations of fragment shaders cost.
std::vector<StageCounters> with_shading(const Hardware& hardware, const std::vector<StageCounters>& stages);

struct StageTime {
  Stage stage;
  double ms = 0;
  std::string busiest;       // the name of the unit that takes so long
  std::string busiest_rate;  // and that of the rate at which most of it goes, by its name in the description
};

struct ModelledTime {
  double in_turn_ms = 0;  // one stage after the other: the sum of `stages`
  // After vertex_setup come the bins, in their order, each on the core that is free first. Its stages follow each
  // other; what overlaps are the bins that a core holds. A bin's share of what cores do (shaders, latency, textures)
  // is its share of the operations. Units that serve all bins are never idle while bins wait for them.
  double on_cores_ms = 0;
  double at_once_ms = 0;          // all stages at once, evenly on all cores: the time of the busiest unit
  std::string busiest;            // the unit of at_once_ms
  std::string busiest_rate;       // the rate at which most of it goes
  std::vector<StageTime> stages;  // in the order of the stages
};

// The three times, under the names that files and tables have for them.
struct TimeKind {
  const char *key, *title, *meaning;
  double ModelledTime::*ms;
};
inline constexpr TimeKind kTimes[] = {
    {"in_turn", "in turn", "One stage after the other: the sum over the stages.", &ModelledTime::in_turn_ms},
    {"on_cores", "on cores", "The geometry, and then bins in their order, each on the core that is free first.",
     &ModelledTime::on_cores_ms},
    {"at_once", "at once", "All units at once and evenly: the time of the busiest.", &ModelledTime::at_once_ms},
};

ModelledTime modelled_time(const Hardware& hardware, const Implementation& implementation, const FrameWork& work);

}  // namespace beampipe
