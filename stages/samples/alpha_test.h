// alpha_test: sample fragments -> sample fragments without what their shaders take from them.
//
// These are cutouts and, in the API's order, all that shaders say of samples and depth (FragmentVerdict). Shaders that
// ask for early tests come after those of depth and stencil.
//
// Sources: OpenGL 4.6 core specification, section 17.3.1 (alpha to coverage); stages/surface/hashed_alpha.h.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/sample_fragment.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

enum class AlphaCoverage {
  test,         // once per fragment, where it is shaded, for all of its samples
  by_sample,    // at each sample
  hashed,       // as to_coverage, with thresholds of samples from a hash of the place on the surface
  to_coverage,  // alpha is the part of the samples that is taken: the same samples for all surfaces
};

struct AlphaTest {
  const Tile& tile;
  const Sampling& sampling;
  AlphaCoverage coverage;
  const std::vector<glm::vec2>& places;  // where each fragment is shaded, in its pixel
  bool is_after_tests = false;           // of those whose shaders ask for early tests; else of all others
};

// Drops fragments of which nothing is left. Adds the texels that are read to `texels`, unless it is null: a request for
// each 2x2 quad.
void alpha_test(const TileShader& shader, const AlphaTest& test, StageCounters& counters,
                std::vector<SampleFragment>& fragments, TexelRequests* texels = nullptr);

}  // namespace beampipe
