// Properties that an area-conserving aggregate has, whatever is composed into it, window by window. BEAMPIPE_THOROUGH=N
// tries N times as many cases.
#include <cstdio>

#include "tests/stages/beam_pixels.h"
#include "tests/stages/search.h"

namespace beampipe::compose_beam_properties_test {

constexpr Tile kTile{0, 0, 12, 10};
constexpr float kRounding = 1e-5f;         // of a sum in float32 over the fragments of a pixel
constexpr float kColorRounding = 0x1p-12;  // of a colour up to 1, by each window that stores it

template <std::size_t Words>
using Pixels = std::vector<StoredAggregate<Words>>;

// Compares each pixel after its windows with what it was earlier. The area is the sum of the old and the added area, at
// most 1, and exactly 1 if the mask has no gap. The mask is the union of the old mask and the added ones. The added
// colour lies between the smallest and the largest of the fragments; it is scaled as the area is.
template <std::size_t Words>
void expect_kept(const Pixels<Words>& before, const Pixels<Words>& after, const std::vector<Fragment>& fragments,
                 const std::vector<float>& areas, float least, float greatest) {
  std::vector<WideMask> masks(before.size());
  std::vector<float> added(before.size());
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    ASSERT_LE(fragments[i].z_min, fragments[i].z_max);
    ASSERT_GE(areas[i], 0.0f);
    added[fragments[i].pixel] += areas[i];
    for (std::size_t w = 0; w < Words; ++w) masks[fragments[i].pixel].words[w] |= fragments[i].mask.words[w];
  }
  for (std::size_t p = 0; p < before.size(); ++p) {
    const float area = after[p].area;  // fields of a pixel need not be aligned
    ASSERT_LE(before[p].area + added[p], 1.0f + kRounding);
    ASSERT_NEAR(area, is_closed(after[p]) ? 1.0f : before[p].area + added[p], kRounding);
    ASSERT_LE(area, 1.0f);
    for (std::size_t w = 0; w < Words; ++w)
      ASSERT_EQ(+after[p].mask[w], before[p].mask[w] | masks[p].words[w]) << "word " << w;
    const float scale = is_closed(after[p]) && added[p] > 0 ? 1.0f / (before[p].area + added[p]) : 1.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      const float old = before[p].color[c], found = after[p].color[c];
      ASSERT_GE(found, scale * (old + least * added[p]) - kColorRounding - kRounding);
      ASSERT_LE(found, scale * (old + greatest * added[p]) + kColorRounding + kRounding);
    }
  }
}

// Composes random triangles. Returns the number of fragments.
template <std::size_t Words>
std::uint64_t compose_random(Random& random) {
  const SetupTriangles triangles = random_triangles(random, random.int32(1, 80));
  constexpr float kLeast = 0.125f, kGreatest = 0.75f;
  std::vector<glm::vec3> colors;
  for (std::size_t i = 0; i < triangles.triangles.size(); ++i)
    colors.emplace_back(random.real32(kLeast, kGreatest), random.real32(kLeast, kGreatest),
                        random.real32(kLeast, kGreatest));
  std::uint64_t merged = 0;
  compose_windows<Words>(triangles, colors, kTile,
                         [&](const std::vector<Fragment>& fragments, const std::vector<float>& areas,
                             const Pixels<Words>& before, const Pixels<Words>& after) {
                           expect_kept<Words>(before, after, fragments, areas, kLeast, kGreatest);
                           merged += fragments.size();
                         });
  return merged;
}

TEST(Properties, WindowsKeepAreaMaskAndColour) {
  std::uint64_t merged = 0;
  search(6'000'000, 50, [&](Random& random) {
    for (int i = 0; i < 4; ++i) merged += compose_random<8>(random);
  });
  std::printf("fragments composed: %llu\n", static_cast<unsigned long long>(merged));
}

}  // namespace beampipe::compose_beam_properties_test
