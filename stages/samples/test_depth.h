// depth_test: sample fragments -> the multisampled surface of the tile.
//
// The file is not called depth_test because files whose names end in _test are tests.
// The test is LESS, so at equal depth the earlier triangle stays.
#pragma once

#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/sample_tile.h"

namespace beampipe {

// Replaces `accesses` by one access per fragment.
void depth_test(const SampledTriangles& in, const std::vector<SampleFragment>& fragments, StageCounters& counters,
                SampleTile& surface, std::vector<SampleAccess>& accesses);

// The pass after a depth-only pass. Keeps of each fragment the samples that have the stored depth, and drops fragments
// without such samples. Charges writing the colours of the samples that are kept. If two triangles have the same depth
// at a sample, both keep it.
void depth_test_equal(const SampledTriangles& in, StageCounters& counters, const SampleTile& surface,
                      std::vector<SampleFragment>& fragments, std::vector<SampleAccess>& accesses);

// The same in the fragment shader, in 2x2 quads: it reads the depths of covered samples as a texture. All invocations
// of a quad compare all samples, because they run in step. Quads without a visible sample end here, so their lanes are
// charged; those of the others are charged where they are shaded.
void depth_test_in_shader(const SampledTriangles& in, StageCounters& counters, const SampleTile& surface,
                          std::vector<SampleFragment>& fragments, std::vector<SampleAccess>& accesses);

}  // namespace beampipe
