// Pictures whose pixels are known from closed forms, from a brute-force renderer, or from another technique.

#include "pipeline/technique.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/pipeline/test_traces.h"
#include "tests/test.h"
#include "traces/scenes.h"

namespace beampipe::pictures_test {

const glm::vec3 kRed(1, 0, 0), kGreen(0, 1, 0), kBlue(0, 0, 1);

TEST(Pictures, AnEmptyFrameIsTheBackground) {
  const Trace trace = pixel_trace(5, 3, {}, glm::vec3(0.25f, 0.5f, 0.75f));
  for (const char* spec :
       {"beam", "beam:order=sorted", "beam:order=stream", "alpha", "msaa:1", "msaa:64", "reference"}) {
    const Image image = picture(spec, trace);
    ASSERT_EQ(image.width, 5u);
    ASSERT_EQ(image.height, 3u);
    for (std::uint32_t y = 0; y < 3; ++y)
      for (std::uint32_t x = 0; x < 5; ++x) EXPECT_EQ(pixel(image, x, y), glm::vec3(0.25f, 0.5f, 0.75f)) << spec;
  }
}

// Bins of four sizes, one of which has triangles.
TEST(Pictures, BinsWithoutTrianglesAreTheBackground) {
  const glm::vec3 background(0.25f, 0.5f, 0.75f);
  const Trace trace = pixel_trace(70, 38, quad(40, 4, 42, 7, 0.5, kRed), background);
  for (const char* spec : {"beam", "beam:order=sorted", "msaa:4", "taa:4", "reference"}) {
    const Image image = picture(spec, trace);
    for (std::uint32_t y = 0; y < 38; ++y)
      for (std::uint32_t x = 0; x < 70; ++x)
        ASSERT_EQ(pixel(image, x, y), x >= 40 && x < 42 && y >= 4 && y < 7 ? kRed : background)
            << spec << ", pixel " << x << ", " << y;
  }
}

TEST(Pictures, RowZeroIsOnTop) {
  const Trace trace = pixel_trace(4, 4, quad(0, 0, 4, 1, 0.5, kRed), kBlue);
  for (const char* spec :
       {"beam", "beam:order=sorted", "beam:order=stream", "casav:mask=exact", "msaa:4", "reference"}) {
    const Image image = picture(spec, trace);
    EXPECT_EQ(pixel(image, 2, 0), kRed) << spec;
    EXPECT_EQ(pixel(image, 2, 1), kBlue) << spec;
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

TEST(Pictures, FrontHidesBackInAnyOrder) {
  for (const bool back_first : {false, true}) {
    std::vector<PixelSpaceTriangle> triangles =
        back_first ? quad(0, 0, 4, 4, 0.7, kGreen) : quad(0, 0, 4, 4, 0.3, kRed);
    append(triangles, back_first ? quad(0, 0, 4, 4, 0.3, kRed) : quad(0, 0, 4, 4, 0.7, kGreen));
    const Trace trace = pixel_trace(4, 4, triangles, kBlue);
    for (const char* spec : {"beam", "beam:order=sorted", "beam:order=stream", "msaa:8", "reference"})
      EXPECT_EQ(pixel(picture(spec, trace), 1, 2), kRed) << spec << " " << back_first;
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
