// The causes of errors: pixels whose error has one known cause, and sums over all causes.
#include "pipeline/error_causes.h"

#include "pipeline/technique_table.h"
#include "tests/pipeline/test_traces.h"
#include "tests/test.h"

namespace beampipe::error_causes_test {

using Layers = std::map<std::string, std::vector<float>>;

struct Explained {
  std::vector<double> error;  // per pixel, the root of the mean square over R, G, B
  Layers layers;
};

Explained explain(const std::string& spec, const Trace& trace) {
  const Technique technique = parse_technique(spec);
  std::vector<PixelWeights> weights;
  const FrameInput run{2};
  const Image image = technique.render(trace, 0, run, {.weights = &weights}).image;
  const Image reference = parse_technique("reference").render(trace, 0, run).image;
  Explained found;
  found.layers = error_causes({trace, trace.frames[0], run, {}}, weights, image, reference);
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    double squares = 0;
    for (std::size_t c = 0; c < 3; ++c) squares += std::pow(double(image.rgba[i + c]) - reference.rgba[i + c], 2);
    found.error.push_back(std::sqrt(squares / 3));
  }
  return found;
}

// The part of the first pixel's error that is due to a cause.
double part(const Explained& found, const std::string& cause) {
  return double(found.layers.at(cause).at(0)) / found.error.at(0);
}

const glm::vec3 kRed(1, 0, 0), kGreen(0, 1, 0), kBlue(0, 0, 1);
constexpr double kMostly = 0.98;  // the rest comes from rounding to fp16

// A triangle that fills the pixel [0, 1] x [0, 1], at depth z + slope x.
PixelSpaceTriangle filling(double z, double slope, const glm::vec3& color) {
  return {{{-1, -1, z - slope}, {3, -1, z + 3 * slope}, {-1, 3, z - slope}}, color};
}

// Two triangles that fill [x0, x1] x [0, 1], at depth z + slope x.
void add_column(std::vector<PixelSpaceTriangle>& triangles, double x0, double x1, double z, double slope,
                const glm::vec3& color) {
  const double z0 = z + slope * x0, z1 = z + slope * x1;
  triangles.push_back({{{x0, 0, z0}, {x1, 0, z1}, {x1, 1, z1}}, color});
  triangles.push_back({{{x0, 0, z0}, {x1, 1, z1}, {x0, 1, z0}}, color});
}

// The weights reproduce the picture except for `rounding`, the most that `most_rounding` allows.
TEST(ErrorCauses, PartsAddUpToEachPixelsError) {
  const Trace trace = random_trace(40, 24, 150, 7);
  for (const std::string& spec : example_specs()) {
    const Technique technique = parse_technique(spec);
    if (!technique.has_weights) continue;
    // Mantissas of 9 bits round the mean colours of merged owners, and fp16 rounds colours up to 1.
    const double most_rounding = technique.counted_positions > 0 ? 1.0 / 512 : 0.6e-3;
    const Explained found = explain(spec, trace);
    ASSERT_EQ(found.layers.size(), kErrorCauses.size());
    double largest = 0;
    for (std::size_t i = 0; i < found.error.size(); ++i) {
      double sum = 0;
      for (const auto& [cause, layer] : found.layers) sum += layer.at(i);
      ASSERT_NEAR(sum, found.error[i], 1e-6) << spec << ", pixel " << i;
      ASSERT_LE(std::abs(found.layers.at("rounding").at(i)), most_rounding) << spec << ", pixel " << i;
      largest = std::max(largest, found.error[i]);
    }
    EXPECT_GT(largest, 0.005) << spec;
  }
}

// In a frame whose target stores sRGB, codes add up, and not the linear colours of pictures.
TEST(ErrorCauses, StoredColoursAreWhatWeightsAddUpTo) {
  Trace trace = random_trace(40, 24, 150, 7);
  trace.frames[0].target = ColorTarget::unorm;
  for (const char* spec : {"beam", "msaa:8", "casav"}) {
    const Explained found = explain(spec, trace);
    double all = 0, rounding = 0;
    for (std::size_t i = 0; i < found.error.size(); ++i) {
      double sum = 0;
      for (const auto& [cause, layer] : found.layers) sum += layer.at(i);
      ASSERT_NEAR(sum, found.error[i], 1e-6) << spec << ", pixel " << i;
      all += found.error[i] * found.error[i];
      rounding += found.error[i] * found.layers.at("rounding").at(i);
    }
    EXPECT_LT(std::abs(rounding), 0.02 * all) << spec;
  }
}

// Half of the pixel is white, and half black; the middle code is not the middle light.
TEST(ErrorCauses, AHalfThatIsMissingIsTheErrorOfItsLight) {
  std::vector<PixelSpaceTriangle> triangles;
  add_column(triangles, 0, 0.5, 0.5, 0, glm::vec3(1));
  Trace trace = pixel_trace(1, 1, triangles, glm::vec3(0));
  trace.frames[0].target = ColorTarget::unorm;
  const Explained found = explain("msaa:1", trace);  // the sample at the centre has the half or not
  const double half = std::pow((0.5 + 0.055) / 1.055, 2.4);
  EXPECT_TRUE(std::abs(found.error[0] - half) < 1e-3 || std::abs(found.error[0] - (1 - half)) < 1e-3) << found.error[0];
  EXPECT_NEAR(part(found, "mask") + part(found, "leak"), 1, 1e-2);
}

TEST(ErrorCauses, TheBackgroundLeaksThroughTwoTrianglesThatOverTakesForIndependent) {
  std::vector<PixelSpaceTriangle> triangles;
  add_column(triangles, 0, 1, 0.5, 0, kRed);
  const Explained found = explain("alpha", pixel_trace(1, 1, triangles, kBlue));
  EXPECT_NEAR(found.error[0], 0.25 * std::sqrt(2.0 / 3), 1e-3);
  EXPECT_GT(part(found, "leak"), kMostly);
}

TEST(ErrorCauses, CrossingTrianglesInterpenetrate) {
  const Explained found = explain("alpha", pixel_trace(1, 1, {filling(0.5, 0, kRed), filling(0.45, 0.1, kBlue)}));
  EXPECT_NEAR(found.error[0], 0.5 * std::sqrt(2.0 / 3), 1e-2);
  EXPECT_GT(part(found, "interpenetration"), kMostly);
}

// The slanted triangle is nearer wherever both are, but its centroid is farther away.
TEST(ErrorCauses, WhatIsNearerButSortedBehindIsOutOfOrder) {
  const PixelSpaceTriangle patch{{{0, 0, 0.45}, {0.2, 0.5, 0.45}, {0, 1, 0.45}}, kBlue};
  const Explained found = explain("alpha", pixel_trace(1, 1, {filling(0.4, 0.15, kRed), patch}));
  EXPECT_NEAR(found.error[0], 0.1 * std::sqrt(2.0 / 3), 1e-3);
  EXPECT_GT(part(found, "order"), kMostly);
}

// A red triangle covers the pixel left of x = 48, in units of 1/256 px, which is six columns of positions. In front of
// it, a sliver reaches from x = 41 to 200, 159/8 positions; its mask has 20, and hides the red one's sixth column with
// 159/160 of it. So red shows 5 1/160 positions in place of 41/8. What is missing goes to the background, which is
// visible on the right.
TEST(ErrorCauses, AnOutlineBetweenPositionsIsTheMasks) {
  const double left = 41 / 256.0, width = 159 / 256.0 * 120 / 79.5;  // at y = -40; it is 0 at y = 80
  const std::vector<PixelSpaceTriangle> triangles = {
      {{{48 / 256.0, -2, 0.8}, {48 / 256.0, 3, 0.8}, {-3, 0.5, 0.8}}, kRed},
      {{{left, -40, 0.2}, {left, 80, 0.2}, {left + width, -40, 0.2}}, kBlue}};
  const Explained found = explain("casav:mask=exact", pixel_trace(1, 1, triangles));
  EXPECT_NEAR(found.error[0], (41 / 8.0 - 5 - 1 / 160.0) / 32 * std::sqrt(1.0 / 3), 0.3e-3);
  EXPECT_GT(part(found, "mask"), 0.9);
}

// A fan of 64 triangles: those that cover no position lose their area, mostly to the background.
TEST(ErrorCauses, FansOfTinyTrianglesLeak) {
  std::vector<PixelSpaceTriangle> fan;
  const auto rim = [](int i) {
    return glm::dvec3(0.37 + 2 * std::cos(i * 0.09817477), 0.61 + 2 * std::sin(i * 0.09817477), 0.5);
  };
  for (int i = 0; i < 64; ++i) fan.push_back({{{0.37, 0.61, 0.5}, rim(i), rim(i + 1)}, kRed});
  const Explained found = explain("casav:mask=exact", pixel_trace(1, 1, fan, kBlue));
  EXPECT_GT(found.error[0], 0.02);
  EXPECT_GT(part(found, "tiny"), 0.1);
  EXPECT_GT(part(found, "tiny") + part(found, "leak"), kMostly);
}

// Red lies beside green. Blue lies behind the right end of green, but is merged with the mean of red and green.
TEST(ErrorCauses, RedGivesWayWhereGreenIsHidden) {
  std::vector<PixelSpaceTriangle> triangles;
  add_column(triangles, 0, 0.5, 0.2, 0, kRed);
  add_column(triangles, 0.5, 1, -0.1, 0.8, kGreen);
  add_column(triangles, 0.9, 1, 0.6, 0, kBlue);
  const Explained found = explain("casav:mask=exact", pixel_trace(1, 1, triangles));
  EXPECT_GT(part(found, "mixed"), 0.05);
}

// Everything right of x, or left of it.
PixelSpaceTriangle side_of(double x, bool right, double z, const glm::vec3& color) {
  return {{{x, -20, z}, {x, 21, z}, {right ? 30.0 : -30.0, 0.5, z}}, color};
}

// Of thirteen owners, red and green become one, because they are at one depth: five sixteenths of the pixel each,
// beside six blue strips on the left and five on the right. White hides those on the right and three sixteenths of
// green, but takes away as much of red.
TEST(ErrorCauses, AMergedOwnerGivesWayWhereOneOfItsSurfacesIsHidden) {
  std::vector<PixelSpaceTriangle> triangles{side_of(0.5, false, 0.5, kRed), side_of(0.5, true, 0.5, kGreen)};
  for (int i = 0; i < 6; ++i) triangles.push_back(side_of((6 - i) / 32.0, false, 0.45 - 0.06 * i, kBlue));
  for (int i = 0; i < 5; ++i) triangles.push_back(side_of(13 / 16.0 + 3 / 80.0 * i, true, 0.42 - 0.06 * i, kBlue));
  triangles.push_back(side_of(10 / 16.0, true, 0.1, glm::vec3(1)));
  const Explained found = explain("beam:order=stream", pixel_trace(8, 1, triangles));  // whose pool has room for it
  EXPECT_NEAR(found.error[0], 1.5 / 16 * std::sqrt(2.0 / 3), 5e-3);
  EXPECT_GT(part(found, "mixed"), 0.95);
}

TEST(ErrorCauses, OnlyTechniquesThatTellTheirWeightsAreExplained) {
  EXPECT_TRUE(parse_technique("beam").has_weights);
  EXPECT_TRUE(parse_technique("beam:order=stream").has_weights);
  EXPECT_FALSE(parse_technique("casav:order=stream").has_weights);
  EXPECT_TRUE(parse_technique("beam:order=sorted,bits=32").has_weights);
  EXPECT_FALSE(parse_technique("msaa:8").has_weights);
}

}  // namespace beampipe::error_causes_test
