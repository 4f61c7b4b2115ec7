// Pictures whose pixels are known from closed forms, from a brute-force renderer, or from another technique.

#include "tests/pipeline/test_pictures.h"
#include "traces/scenes.h"

namespace beampipe::pictures_test {

const glm::vec3 kRed(1, 0, 0), kGreen(0, 1, 0), kBlue(0, 0, 1);

// Bins of four sizes, one of which has triangles; and a frame without any. Row 0 is on top.
TEST(Pictures, BinsWithoutTrianglesAreTheBackground) {
  const glm::vec3 background(0.25f, 0.5f, 0.75f);
  for (const bool is_empty : {false, true}) {
    const auto triangles = is_empty ? std::vector<PixelSpaceTriangle>{} : quad(40, 4, 42, 7, 0.5, kRed);
    const Trace trace = pixel_trace(70, 38, triangles, background);
    for (const char* spec : {"beam", "beam:order=sorted", "beam:order=stream", "casav:mask=exact", "alpha", "msaa:1",
                             "msaa:4", "msaa:64", "taa:4", "reference"}) {
      if (!is_empty && spec == std::string("alpha")) continue;  // the background leaks through the diagonal
      const Image image = picture(spec, trace);
      for (std::uint32_t y = 0; y < 38; ++y)
        for (std::uint32_t x = 0; x < 70; ++x)
          ASSERT_EQ(pixel(image, x, y), !is_empty && x >= 40 && x < 42 && y >= 4 && y < 7 ? kRed : background)
              << spec << ", pixel " << x << ", " << y;
    }
  }
}

TEST(Pictures, AnEdgeThroughAPixelCoversItsExactArea) {
  // A quad that covers the left 5/16 of pixel (1, 1).
  const Trace trace = pixel_trace(4, 4, quad(0, 0, 1.3125, 4, 0.5, kRed), kBlue);
  const glm::vec3 expected = 0.3125f * kRed + 0.6875f * kBlue;
  // The coverage of beam is exact up to rounding: to fp16, or of the mask's error to 1/64 of a position. The reference
  // is exact for vertical edges.
  for (const char* spec : {"beam", "beam:order=sorted", "beam:order=stream", "casav:mask=exact", "reference"}) {
    const glm::vec3 found = pixel(picture(spec, trace), 1, 1);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 2e-4) << spec;
  }
}

TEST(Pictures, OfTwoEqualTrianglesTheEarlierIsSeen) {
  // The triangle is steep, and its copy starts with another vertex and has the opposite orientation, so that rounding
  // could make their depths differ.
  const glm::dvec3 a(-1, -1, 0.1), b(13, -2, 0.6), c(-2, 12, 0.9);
  const Trace trace = pixel_trace(4, 4, {{{a, b, c}, kRed}, {{c, b, a}, kGreen}});
  for (const char* spec : {"beam", "beam:order=sorted", "beam:order=stream", "casav:mask=exact", "msaa:1", "msaa:8",
                           "msaa:256", "reference"}) {
    const Image image = picture(spec, trace);
    for (std::uint32_t y = 0; y < 4; ++y)
      for (std::uint32_t x = 0; x < 4; ++x) EXPECT_EQ(pixel(image, x, y), kRed) << spec << ' ' << x << ' ' << y;
  }
}

// What shows where a closed mesh is, is one of its fronts. (On pickets, which are much thinner than a pixel in depth,
// a few back faces come out in front, because vertices are snapped to 1/256 pixel.)
TEST(Pictures, BackFacesOfClosedMeshesDoNotShow) {
  for (const char* scene : {"hairball", "classroom", "boat", "pickets", "sphere", "fence", "foliage", "bars"}) {
    const Trace culled = make_scene(scene, {.triangles = 8000, .width = 96, .height = 54});
    Trace whole = culled;
    for (Draw& draw : whole.frames[0].draws) draw.cull = Cull::none;
    const FrameResult without = render("msaa:16", culled), with = render("msaa:16", whole);
    EXPECT_LT(without.stages[0].items_out, with.stages[0].items_out) << scene;
    EXPECT_LT(rmse(without.image, with.image), std::string(scene) == "pickets" ? 6e-3 : 3e-4) << scene;
  }
}

}  // namespace beampipe::pictures_test
