#include "simd/tested_cells.h"

#include "tests/simd/every_target.h"

namespace beampipe::tested_cells_test {

// A plane whose depths are exact in single precision.
TEST(TestedCells, HaveTheirNumberInTheTileAndTheDepthOfTheirCorner) {
  const AnchoredPlane<double> depth{.z = -0.5, .dzdx = 0.0625, .dzdy = -0.125, .anchor_x = 9, .anchor_y = 5};
  const std::int32_t x[] = {32, 35, 39, 44}, y[] = {8, 9, 11, 10};
  const std::uint32_t masks[] = {1, 0xff, 0x80, 6};
  on_every_target([&] {
    std::vector<std::int32_t> xs(std::begin(x), std::end(x)), ys(std::begin(y), std::end(y));
    std::vector<std::uint32_t> samples(std::begin(masks), std::end(masks));
    xs.resize(4 + kTestedSlack), ys.resize(4 + kTestedSlack), samples.resize(4 + kTestedSlack);
    std::vector<SampleAccess> items(4 + kTestedSlack);
    std::vector<CellPlane<float>> planes(4 + kTestedSlack);
    // 4 x 2 cells per pixel, and a tile that is 5 pixels wide and begins at pixel (8, 4): cell (32, 8).
    set_tested_cells({8, 4, 5, 2, 1}, depth, {77, xs.data(), ys.data(), samples.data()}, 4, items.data(),
                     planes.data());
    const std::uint32_t cells[] = {0, 7, 8 + 5 * 8 + 7, 5 * 8 + 3 * 8};
    const float corners[] = {-0.5f - 0.0625f + 0.125f, -0.5f - 0.25f * 0.0625f + 0.0625f,
                             -0.5f + 0.75f * 0.0625f - 0.0625f, -0.5f + 2 * 0.0625f};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(items[i].cell, cells[i]) << i;
      EXPECT_EQ(items[i].triangle, 77u);
      EXPECT_EQ(items[i].tested, masks[i]);
      EXPECT_EQ(items[i].passed, 0u);
      EXPECT_EQ(planes[i].z, corners[i]) << i;
      EXPECT_EQ(planes[i].dzdx, 0.0625f / 256);
      EXPECT_EQ(planes[i].dzdy, -0.125f / 256);
    }
  });
}

}  // namespace beampipe::tested_cells_test
