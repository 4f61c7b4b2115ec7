#include "stages/picture/resolve.h"

#include <gtest/gtest.h>

namespace beampipe {
namespace {

TEST(Resolve, AggregateOverTheBackground) {
  Aggregate quarter = kEmptyAggregate;
  quarter.alpha = 0.25f;
  quarter.color[0] = 0.25f;  // red times alpha
  StageCounters counters;
  const auto image = resolve(pixel_colors({quarter, kEmptyAggregate}), {0, 1, 0.5f}, 42, counters);
  ASSERT_EQ(image.size(), 2u);
  EXPECT_EQ(image[0], glm::vec4(0.25f, 0.75f, 0.375f, 0.25f));
  EXPECT_EQ(image[1], glm::vec4(0, 1, 0.5f, 0));
  EXPECT_EQ(counters.items_in, 2u);
  EXPECT_EQ(counters.bytes_read, 2u * 42);
  EXPECT_EQ(counters.bytes_written, 2u * 6);
}

TEST(Resolve, MeanOfTheSamples) {
  const Tile tile{0, 0, 2, 1};
  const Sampling sampling{CellGrid{}, standard_pattern(4)};
  SampleTile surface(tile, sampling);
  // Left: triangle 0 twice, 1 once, background once. Right: background.
  surface.triangle[0] = surface.triangle[2] = 0;
  surface.triangle[1] = 1;
  StageCounters counters;
  const auto image = resolve(surface, tile.pixels(), std::vector<glm::vec3>{{1, 0, 0}, {0, 4, 0}}, {0, 0, 0.5f}, counters);
  ASSERT_EQ(image.size(), 2u);
  EXPECT_EQ(image[0], glm::vec4(0.5f, 1.0f, 0.125f, 0.75f));
  EXPECT_EQ(image[1], glm::vec4(0, 0, 0.5f, 0));
  EXPECT_EQ(counters.items_in, 8u);
  EXPECT_EQ(counters.items_out, 2u);
}

}  // namespace
}  // namespace beampipe
