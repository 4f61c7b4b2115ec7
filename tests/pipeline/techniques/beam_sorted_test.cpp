// The beam in sorted order: counters that can be worked out by hand, and pictures.

#include "pipeline/technique.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/pipeline/test_traces.h"
#include "tests/test.h"

namespace beampipe::beam_sorted_test {

TEST(BeamSorted, CountsEveryTouchedPixel) {
  const FrameResult result = parse_technique("beam:order=sorted").render(half_square(), 0, {1});
  // Rows 1 to 4 touch 1 + 1, 1 + 2, 1 + 3 and 4 pixels. The diagonal runs through corners of pixels, and a corner
  // belongs to the closed square of a pixel. Pairs without area are dropped after conservative_raster.
  const std::uint64_t touched = 1 + 2 + 3 + 4 + 3, with_area = 1 + 2 + 3 + 4;
  EXPECT_EQ(stage_of(result, "vertex_setup").items_in, 1u);
  EXPECT_EQ(stage_of(result, "vertex_setup").items_out, 1u);
  EXPECT_EQ(stage_of(result, "conservative_raster").items_in, 1u);
  EXPECT_EQ(stage_of(result, "conservative_raster").items_out, touched);
  // The triangle covers the whole of pixel (2, 3), so no fragment is made there.
  EXPECT_EQ(stage_of(result, "beam_fragment").items_in, touched - 1);
  EXPECT_EQ(stage_of(result, "beam_fragment").items_out, with_area - 1);
  EXPECT_EQ(stage_of(result, "shade").items_in, with_area);
  EXPECT_EQ(stage_of(result, "a_buffer").items_in, touched);
  EXPECT_EQ(stage_of(result, "compose").items_in, with_area);
  EXPECT_EQ(stage_of(result, "resolve").items_out, 64u);
  EXPECT_EQ(stage_of(result, "shade").lanes_issued, with_area);  // after visibility, without quads and helpers
  // The A-buffer has a triangle's number, a depth range and a 4-byte link for each pair, and a 4-byte head per pixel. A
  // fragment has 62 bytes: an aggregate of 42 bytes, the pixel, a plane and a centroid. Aggregates are read and written
  // once per window.
  EXPECT_EQ(result.a_buffer_peak_bytes, touched * 16 + 64 * 4);
  EXPECT_EQ(stage_of(result, "compose").bytes_read, (with_area - 1) * (62 + 42) + 16);
  EXPECT_EQ(stage_of(result, "compose").bytes_written, with_area * 42);
}

TEST(BeamSorted, IsNearerToTheReferenceThanAlphaAndOneSample) {
  const Trace trace = random_trace(48, 32, 150, 5);
  const Image reference = picture("reference", trace);
  const double beam = rmse(picture("beam:order=sorted", trace), reference);
  EXPECT_LT(beam, 0.5 * rmse(picture("msaa:1", trace), reference));
  EXPECT_LT(beam, rmse(picture("alpha", trace), reference));
}

}  // namespace beampipe::beam_sorted_test
