// Pictures whose pixels are known from closed forms, from a brute-force renderer, or from another technique.
#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/technique.h"
#include "tests/pipeline/test_traces.h"

namespace beampipe {
namespace {

Image render(const std::string& spec, const Trace& trace) { return parse_technique(spec).render(trace, 0, {1}).image; }

glm::vec3 pixel(const Image& image, std::uint32_t x, std::uint32_t y) {
  const float* rgba = image.rgba.data() + 4 * (std::size_t{y} * image.width + x);
  return {rgba[0], rgba[1], rgba[2]};
}

double rmse(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    if (i % 4 != 3) sum += (double(a.rgba[i]) - b.rgba[i]) * (double(a.rgba[i]) - b.rgba[i]);
  return std::sqrt(sum / (0.75 * static_cast<double>(a.rgba.size())));
}

// Two triangles that fill [x0, x1] x [y0, y1].
std::vector<PixelSpaceTriangle> quad(double x0, double y0, double x1, double y1, double z, const glm::vec3& color) {
  return {{{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}}, color}, {{{x0, y0, z}, {x1, y1, z}, {x0, y1, z}}, color}};
}

void append(std::vector<PixelSpaceTriangle>& to, const std::vector<PixelSpaceTriangle>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

const glm::vec3 kRed(1, 0, 0), kGreen(0, 1, 0), kBlue(0, 0, 1);

TEST(Pictures, AnEmptyFrameIsTheBackground) {
  const Trace trace = pixel_trace(5, 3, {}, glm::vec3(0.25f, 0.5f, 0.75f));
  for (const char* spec : {"beam", "alpha", "msaa:1", "msaa:64", "reference"}) {
    const Image image = render(spec, trace);
    ASSERT_EQ(image.width, 5u);
    ASSERT_EQ(image.height, 3u);
    for (std::uint32_t y = 0; y < 3; ++y)
      for (std::uint32_t x = 0; x < 5; ++x) EXPECT_EQ(pixel(image, x, y), glm::vec3(0.25f, 0.5f, 0.75f)) << spec;
  }
}

TEST(Pictures, RowZeroIsOnTop) {
  const Trace trace = pixel_trace(4, 4, quad(0, 0, 4, 1, 0.5, kRed), kBlue);
  for (const char* spec : {"beam:rules=paper,mask=exact", "msaa:4", "reference"}) {
    const Image image = render(spec, trace);
    EXPECT_EQ(pixel(image, 2, 0), kRed) << spec;
    EXPECT_EQ(pixel(image, 2, 1), kBlue) << spec;
  }
}

TEST(Pictures, AnEdgeThroughAPixelCoversItsExactArea) {
  // A quad that covers the left 5/16 of pixel (1, 1).
  const Trace trace = pixel_trace(4, 4, quad(0, 0, 1.3125, 4, 0.5, kRed), kBlue);
  const glm::vec3 expected = 0.3125f * kRed + 0.6875f * kBlue;
  // The coverage of beam is exact up to rounding to fp16. The reference is exact for vertical edges.
  for (const char* spec : {"beam", "beam:rules=paper,mask=exact", "reference"}) {
    const glm::vec3 found = pixel(render(spec, trace), 1, 1);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 2e-4) << spec;
  }
}

TEST(Pictures, AlphaAloneLeaksBetweenTheTrianglesOfAQuad) {
  // Two triangles of area 1/2 tile the pixel. OVER treats them as independent and finds 1 - (1/2)^2. Masks show that
  // they do not overlap.
  const Trace trace = pixel_trace(2, 2, quad(0, 0, 1, 1, 0.5, kRed), kBlue);
  EXPECT_NEAR(pixel(render("alpha", trace), 0, 0).r, 0.75f, 1e-3);
  EXPECT_NEAR(pixel(render("beam:rules=paper,mask=exact", trace), 0, 0).r, 1.0f, 1e-3);
}

TEST(Pictures, FrontHidesBackInAnyOrder) {
  for (const bool back_first : {false, true}) {
    std::vector<PixelSpaceTriangle> triangles =
        back_first ? quad(0, 0, 4, 4, 0.7, kGreen) : quad(0, 0, 4, 4, 0.3, kRed);
    append(triangles, back_first ? quad(0, 0, 4, 4, 0.3, kRed) : quad(0, 0, 4, 4, 0.7, kGreen));
    const Trace trace = pixel_trace(4, 4, triangles, kBlue);
    for (const char* spec : {"beam", "msaa:8", "reference"})
      EXPECT_EQ(pixel(render(spec, trace), 1, 2), kRed) << spec << " " << back_first;
  }
}

TEST(Pictures, OfTwoEqualTrianglesTheEarlierIsSeen) {
  // The triangle is steep, and its copy starts with another vertex and has the opposite orientation, so that rounding
  // could make their depths differ.
  const glm::dvec3 a(-1, -1, 0.1), b(13, -2, 0.6), c(-2, 12, 0.9);
  const Trace trace = pixel_trace(4, 4, {{{a, b, c}, kRed}, {{c, b, a}, kGreen}});
  for (const char* spec : {"beam", "beam:rules=paper,mask=exact", "msaa:1", "msaa:8", "msaa:256", "reference"}) {
    const Image image = render(spec, trace);
    for (std::uint32_t y = 0; y < 4; ++y)
      for (std::uint32_t x = 0; x < 4; ++x) EXPECT_EQ(pixel(image, x, y), kRed) << spec << ' ' << x << ' ' << y;
  }
}

// Tests every sample of every pixel against every triangle with barycentric coordinates in double, without raster,
// spans or tiles. The sample positions are those of the reference (stages/raster/reference_raster.h): 256 rows of 16,
// each shifted by the bit-reversed number of the row.
Image brute_force(const Trace& trace) {
  const Frame& frame = trace.frames[0];
  const Mesh& mesh = trace.meshes[0];
  Image image{frame.width, frame.height, std::vector<float>(4 * std::size_t{frame.width} * frame.height)};
  const auto snapped = [&](std::uint32_t i) {
    const glm::dvec4 clip = frame.projection * glm::dvec4(mesh.positions[i], 1.0);
    return glm::dvec3(std::floor((clip.x + 1) / 2 * frame.width * 256 + 0.5) / 256,
                      std::floor((1 - clip.y) / 2 * frame.height * 256 + 0.5) / 256, clip.z);
  };
  const auto cross = [](const glm::dvec3& o, const glm::dvec3& p, double x, double y) {
    return (p.x - o.x) * (y - o.y) - (x - o.x) * (p.y - o.y);
  };
  std::size_t at = 0;
  for (std::uint32_t py = 0; py < frame.height; ++py) {
    for (std::uint32_t px = 0; px < frame.width; ++px, at += 4) {
      glm::dvec3 sum(0.0);
      for (int s = 0; s < 4096; ++s) {
        const int row = s / 16;
        double shift = 0.5 / 4096;
        for (int bit = 0; bit < 8; ++bit) shift += (row >> bit & 1) / 16.0 / (2 << bit);
        const double x = px + s % 16 / 16.0 + shift, y = py + (row + 0.5) / 256;
        double nearest = 1e9;
        glm::dvec3 color = frame.background;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
          const glm::dvec3 a = snapped(mesh.triangles[t].x), b = snapped(mesh.triangles[t].y),
                           c = snapped(mesh.triangles[t].z);
          const double area = cross(a, b, c.x, c.y);
          if (area == 0) continue;
          const double u = cross(b, c, x, y) / area, v = cross(c, a, x, y) / area, w = cross(a, b, x, y) / area;
          if (u < 0 || v < 0 || w < 0) continue;
          const double z = u * a.z + v * b.z + w * c.z;
          if (z < nearest) nearest = z, color = mesh.colors[t];
        }
        sum += color;
      }
      for (int c = 0; c < 3; ++c) image.rgba[at + static_cast<std::size_t>(c)] = static_cast<float>(sum[c] / 4096);
    }
  }
  return image;
}

TEST(Pictures, TheReferenceAgreesWithBruteForce) {
  const Trace trace = random_trace(6, 5, 60, 7);
  const Image reference = render("reference", trace), brute = brute_force(trace);
  // Only samples exactly on an edge may differ, because brute_force() has no top-left rule.
  double largest = 0;
  for (std::size_t i = 0; i < brute.rgba.size(); ++i)
    if (i % 4 != 3) largest = std::max(largest, std::abs(double(brute.rgba[i]) - reference.rgba[i]));
  EXPECT_LT(largest, 2.0 / 4096);
  EXPECT_LT(rmse(reference, brute), 1e-4);
}

TEST(Pictures, MoreSamplesComeNearerToTheReference) {
  const Trace trace = random_trace(48, 32, 400, 11);
  const Image reference = render("reference", trace);
  double previous = rmse(render("msaa:1", trace), reference);
  for (const char* spec : {"msaa:4", "msaa:16", "msaa:64", "msaa:256", "msaa:1024"}) {
    const double error = rmse(render(spec, trace), reference);
    EXPECT_LT(error, 0.75 * previous) << spec;
    previous = error;
  }
  EXPECT_LT(previous, 1.5e-3);
}

TEST(Pictures, BeamIsNearerToTheReferenceThanAlphaAndOneSample) {
  const Trace trace = random_trace(48, 32, 150, 5);
  const Image reference = render("reference", trace);
  const double beam = rmse(render("beam", trace), reference);
  EXPECT_LT(beam, 0.5 * rmse(render("msaa:1", trace), reference));
  EXPECT_LT(beam, rmse(render("alpha", trace), reference));
}

}  // namespace
}  // namespace beampipe
