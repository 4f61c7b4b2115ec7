// accumulate: fragments with the samples that a depth-only pass left visible -> one colour accumulator per pixel (ACAA,
// Enderton et al. 2015). A fragment adds its colour times its share of the pixel's samples.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/raster/sample_raster.h"
#include "stages/samples/test_depth.h"

namespace beampipe {

enum class AccumulatorFormat { unorm8, fp16, fp32 };  // four channels; every sum is rounded to it

// Two fragments with the same depth at a sample both pass. What is done about the second:
enum class DoubleCounting {
  none,      // it is added as well
  stencil,   // a stencil value per sample lets only the first pass
  saturate,  // alpha sums up the shares, and a fragment adds no more than is missing to `limit` (saturated alpha
             // blending)
};

std::uint32_t accumulator_bytes(AccumulatorFormat format);

struct Accumulator {
  AccumulatorFormat format;
  DoubleCounting double_counting;
  float sample_share;                // of the pixel: 1 / samples of all passes
  float limit = 1;                   // what alpha may sum up to so far: the share of the samples that were looked at
  std::vector<glm::vec4> color;      // one per pixel of the tile; alpha: the shares so far
  std::vector<float> background;     // the share of accumulate_background: only to know the image's A, and not counted
  std::vector<std::uint32_t> taken;  // stencil: samples that were passed before, since it was cleared

  Accumulator(const Tile& tile, int samples, AccumulatorFormat accumulator_format, DoubleCounting counting);
};

// For DoubleCounting::saturate, before the fragments: adds the background for the samples that the depth-only pass left
// clear, so that alpha saturates at what geometry covers. It costs reading all depths once more.
void accumulate_background(const SampleTile& depth, const glm::vec3& background, StageCounters& counters,
                           Accumulator& accumulator);

// Of each fragment the samples that no earlier one passed at, fragments without any dropped.
void stencil_test(const Tile& tile, StageCounters& counters, Accumulator& accumulator,
                  std::vector<SampleFragment>& fragments);

// `colors`: one per triangle.
void accumulate(const std::vector<SampleFragment>& fragments, const std::vector<glm::vec3>& colors, const Tile& tile,
                StageCounters& counters, Accumulator& accumulator);

// Over the background, by what alpha leaves of it.
std::vector<glm::vec4> resolve(const Accumulator& accumulator, const glm::vec3& background, StageCounters& counters);

}  // namespace beampipe
