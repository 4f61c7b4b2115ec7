// Z3: the state of a pixel is read and written for each fragment, and merging loses little where it has to happen.
#include <gtest/gtest.h>

#include "pipeline/technique.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/pipeline/test_traces.h"

namespace beampipe {
namespace {

TEST(Z3, ReadsAndWritesAPixelForEachFragment) {
  const StageCounters merging = stage_of(parse_technique("z3").render(half_square(), 0, {1}), "compose");
  const std::uint64_t fragments = 1 + 2 + 3 + 4;
  EXPECT_EQ(merging.items_in, fragments);
  EXPECT_EQ(merging.items_out, fragments);
  EXPECT_EQ(merging.bytes_read, fragments * (26 + 50)) << "pixel, mask, plane, colour; three layers and their owners";
  EXPECT_EQ(merging.bytes_written, fragments * 50);
  EXPECT_EQ(merging.lanes_used, fragments);
  EXPECT_EQ(merging.lanes_issued, fragments);
}

// Where no pixel shows more surfaces than there are layers, nothing is merged, and each position has its own surface.
TEST(Z3, WithoutMergesThePictureIsThatOfTheMaskPositions) {
  std::vector<PixelSpaceTriangle> triangles = quad(0.3, 0.3, 3.6, 3.7, 0.6, glm::vec3(1, 0, 0));
  append(triangles, quad(1.2, 1.1, 2.7, 5.0, 0.3, glm::vec3(0, 1, 0)));
  const FrameResult found = render("z3", pixel_trace(6, 6, triangles));
  EXPECT_EQ(sum_of(found, "merges"), 0);
  const Image settled = picture("beam:order=stream,bits=32", pixel_trace(6, 6, triangles));
  EXPECT_LT(worst_difference(found.image, settled), 0.2) << "areas are counted by 32 positions";
  EXPECT_EQ(pixel(found.image, 2, 2), glm::vec3(0, 1, 0)) << "a pixel that one surface covers";
}

}  // namespace
}  // namespace beampipe
