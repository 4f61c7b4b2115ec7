// Compares beampipe's raster with Mesa's llvmpipe, sample by sample.
//
// Both snap vertices to 1/256 px. If the vertices lie on that grid and inside the frame, both see the same triangle,
// and every sample must agree. Otherwise they may see different triangles, for two reasons. llvmpipe clips to the sides
// of the frame and snaps the new vertices, which bends edges; beampipe has a guard band instead. And llvmpipe computes
// in float, beampipe in double, so a vertex very near the middle between two grid points can be snapped to either of
// them. A difference counts as explained if beampipe's raster covers exactly the samples that llvmpipe covers once it
// is given one of the triangles that llvmpipe may have seen (snapped.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <iostream>
#include <map>
#include <random>

#include "stages/geometry/vertex_setup.h"
#include "stages/raster/sample_raster.h"
#include "tests/llvmpipe/llvmpipe.h"
#include "tests/llvmpipe/snapped.h"

namespace beampipe::llvmpipe_coverage_test {

constexpr int kSize = 64;    // pixels on each side
constexpr int kUnits = 256;  // per pixel
constexpr Tile kFrame{0, 0, kSize, kSize};

using Triangle = ClipTriangle;

// The projection turns a position into the clip coordinates x, y, -z - 2, -z, with the near plane at 1 and no far
// plane. That is exact in float if the coordinates have few enough bits.
SetupTriangles set_up(const Triangle& clip) {
  Trace trace;
  Mesh mesh;
  Frame frame;
  frame.width = frame.height = kSize;
  frame.projection = glm::dmat4(0.0);
  frame.projection[0][0] = frame.projection[1][1] = 1;
  frame.projection[2][2] = frame.projection[2][3] = -1;
  frame.projection[3][2] = -2;
  for (const glm::vec4& p : clip) mesh.positions.emplace_back(p.x, p.y, -p.w);
  mesh.triangles.emplace_back(0, 1, 2);
  mesh.colors.emplace_back(1.0f);
  trace.meshes.push_back(mesh);
  frame.draws.emplace_back();
  StageCounters counters;
  return vertex_setup(trace, frame, counters);
}

glm::vec4 clip_point(float x, float y, float w) { return {x, y, w - 2, w}; }

// A point given in pixels (y down), on the plane w = 2, where the clip depth is 0.
glm::vec4 at_pixel(double x, double y) {
  return clip_point(static_cast<float>(2 * (x / (kSize / 2) - 1)), static_cast<float>(2 * (1 - y / (kSize / 2))), 2);
}
glm::vec4 at_unit(std::int64_t x, std::int64_t y) {
  return at_pixel(static_cast<double>(x) / kUnits, static_cast<double>(y) / kUnits);
}

std::vector<std::uint32_t> coverage(const SetupTriangles& triangles, int samples) {
  TriangleList all;
  for (std::uint32_t i = 0; i < triangles.triangles.size(); ++i) all.push_back(i);
  std::vector<SampleFragment> fragments;
  StageCounters counters;
  sample_raster({triangles, kFrame, {CellGrid{}, standard_pattern(samples)}}, all, counters, fragments);
  std::vector<std::uint32_t> masks(kSize * kSize);
  for (const SampleFragment& f : fragments) masks[static_cast<std::size_t>(f.y * kSize + f.x)] |= f.mask;
  return masks;
}

// The distance from a sample to the nearest edge line of the triangles, in 1/256 px.
double distance_to_edge(const SetupTriangles& triangles, const SamplePattern& pattern, std::size_t pixel, int sample) {
  const auto s = static_cast<std::size_t>(sample);
  const auto x = static_cast<std::int64_t>(pixel % kSize) * kUnits + pattern.x[s];
  const auto y = static_cast<std::int64_t>(pixel / kSize) * kUnits + pattern.y[s];
  double nearest = INFINITY;
  for (const SetupTriangle& triangle : triangles.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Edge edge = edge_of(triangle, k);
      nearest = std::min(nearest, std::abs(static_cast<double>(edge.at(x, y))) / std::hypot(edge.a, edge.b));
    }
  }
  return nearest;
}

struct Tally {
  std::uint64_t triangles = 0, samples = 0, covered = 0, differences = 0;
  std::uint64_t clipped = 0, snapped = 0, unexplained = 0;  // triangles with differences, by reason
  double farthest = 0;  // the largest distance of a differing sample from an edge, in 1/256 px
};

class Coverage : public testing::Test {
 protected:
  void SetUp() override {
    std::string missing;
    mesa_ = Llvmpipe::start(kSize, missing);
    if (!mesa_) GTEST_SKIP() << "not compared with llvmpipe: " << missing;
  }

  void compare(const Triangle& triangle, Tally& tally) {
    const SetupTriangles ours = set_up(triangle);
    std::map<int, std::vector<std::uint32_t>> expected;
    bool differs = false;
    for (const int samples : {1, 4}) {
      expected[samples] = mesa_->coverage(triangle.data(), samples);
      const SamplePattern pattern = standard_pattern(samples);
      const std::vector<std::uint32_t> found = coverage(ours, samples);
      for (std::size_t pixel = 0; pixel < found.size(); ++pixel) {
        tally.covered += static_cast<std::uint64_t>(std::popcount(found[pixel]));
        for (std::uint32_t bits = expected[samples][pixel] ^ found[pixel]; bits != 0; bits &= bits - 1) {
          differs = true;
          ++tally.differences;
          tally.farthest = std::max(tally.farthest, distance_to_edge(ours, pattern, pixel, std::countr_zero(bits)));
        }
      }
      tally.samples += found.size() * static_cast<std::size_t>(samples);
    }
    ++tally.triangles;
    if (differs)
      ++(!explained(triangle, expected) ? tally.unexplained : needs_clipping(triangle) ? tally.clipped : tally.snapped);
  }

  // Is there one way to clip and snap the triangle that gives the expected coverage at every number of samples?
  static bool explained(const Triangle& triangle, const std::map<int, std::vector<std::uint32_t>>& expected) {
    const std::vector<SetupTriangles> alternatives = snapped_alternatives(triangle, kSize);
    return std::any_of(alternatives.begin(), alternatives.end(), [&](const SetupTriangles& seen) {
      return std::all_of(expected.begin(), expected.end(),
                         [&](const auto& masks) { return coverage(seen, masks.first) == masks.second; });
    });
  }

  Tally compare_many(const char* what, int count, const std::function<Triangle()>& make) {
    Tally tally;
    for (int i = 0; i < count; ++i) compare(make(), tally);
    std::cout << what << ": " << tally.triangles << " triangles, " << tally.samples << " samples, " << tally.covered
              << " covered, " << tally.differences << " differences";
    if (tally.differences > 0)
      std::cout << " at most " << tally.farthest << "/256 px from an edge; triangles that differ: " << tally.clipped
                << " clipped and snapped anew, " << tally.snapped << " snapped otherwise, " << tally.unexplained
                << " unexplained";
    std::cout << "\n";
    EXPECT_EQ(tally.unexplained, 0u);
    EXPECT_LE(tally.farthest, 1);
    return tally;
  }

  std::int64_t integer(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(bits_() % static_cast<std::uint64_t>(high - low + 1));
  }
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  glm::vec4 grid_point(std::int64_t low, std::int64_t high, std::int64_t step) {
    return at_unit(integer(low / step, high / step) * step, integer(low / step, high / step) * step);
  }

  std::unique_ptr<Llvmpipe> mesa_;
  std::mt19937_64 bits_{20150809};
};

TEST_F(Coverage, SamplePositionsAreTheStandardOnes) {
  std::cout << mesa_->name() << "\n";
  for (const int samples : {1, 4}) {
    const SamplePattern pattern = standard_pattern(samples, 16, 16);
    const std::vector<glm::ivec2> found = mesa_->positions(samples);
    for (std::size_t s = 0; s < found.size(); ++s) EXPECT_EQ(found[s], glm::ivec2(pattern.x[s], pattern.y[s])) << s;
  }
}

// On multiples of 32/256 px, vertices and edges lie exactly on samples: centres and the sample positions of 4x.
TEST_F(Coverage, TrianglesOnTheGridAndEdgesThroughSamples) {
  for (const auto& [name, step] : {std::pair("on the 1/256 px grid", 1), {"edges through samples", 32}}) {
    const auto point = [&, step = step] { return grid_point(0, kSize * kUnits, step); };
    const Tally tally = compare_many(name, 1500, [&] { return Triangle{point(), point(), point()}; });
    EXPECT_EQ(tally.differences, 0u);
  }
}

TEST_F(Coverage, SmallTriangles) {
  const Tally tally = compare_many("of about a pixel", 1000, [&] {
    const std::int64_t x = integer(0, kSize * kUnits), y = integer(0, kSize * kUnits);
    const auto near = [&] { return at_unit(x + integer(-300, 300), y + integer(-300, 300)); };
    return Triangle{near(), near(), near()};
  });
  EXPECT_EQ(tally.differences, 0u);
}

// From triangles without any area to ones that are a third of a pixel wide.
TEST_F(Coverage, Slivers) {
  const Tally tally = compare_many("slivers", 1500, [&] {
    const std::int64_t wide = integer(0, 2) == 0 ? 2 : 80;
    const std::int64_t x = integer(0, kSize * kUnits), y = integer(0, kSize * kUnits);
    const std::int64_t to_x = integer(100, kSize * kUnits - 100), to_y = integer(100, kSize * kUnits - 100);
    return Triangle{at_unit(x, y), at_unit(to_x, to_y),
                    at_unit(to_x + integer(-wide, wide), to_y + integer(-wide, wide))};
  });
  EXPECT_EQ(tally.differences, 0u);
}

TEST_F(Coverage, AlongTheFramesSides) {
  const Tally tally = compare_many("along the frame's sides", 500, [&] {
    const auto side = [&] { return integer(0, 1) * kSize * kUnits; };
    const auto inside = [&] { return integer(0, kSize * kUnits); };
    return Triangle{at_unit(side(), inside()), at_unit(inside(), side()), at_unit(side(), side())};
  });
  EXPECT_EQ(tally.differences, 0u);
}

// Triangles around a common vertex, at many angles. If each agrees, their shared edges do too.
TEST_F(Coverage, SharedEdges) {
  const auto hub_x = integer(28, 36) * kUnits + 128, hub_y = integer(28, 36) * kUnits + 96;
  int i = 0;
  const auto rim = [&](int k) {
    const double angle = 2 * 3.141592653589793 * (k % 600) / 600;
    return at_unit(hub_x + std::lround(7000 * std::cos(angle)), hub_y + std::lround(7000 * std::sin(angle)));
  };
  const Tally tally = compare_many("around a shared vertex", 600, [&] {
    ++i;
    return Triangle{at_unit(hub_x, hub_y), rim(i), rim(i + 1)};
  });
  EXPECT_EQ(tally.differences, 0u);
}

TEST_F(Coverage, PartlyOffScreen) {
  compare_many("partly off screen", 1000, [&] {
    const auto point = [&] { return grid_point(-kSize * kUnits, 2 * kSize * kUnits, 1); };
    return Triangle{point(), point(), point()};
  });
}

TEST_F(Coverage, FarOffScreen) {
  compare_many("far off screen", 500, [&] {
    const auto point = [&] { return grid_point(-2000 * kUnits, 2000 * kUnits, 1); };
    return Triangle{grid_point(0, kSize * kUnits, 1), point(), point()};
  });
}

TEST_F(Coverage, AnyPositions) {
  compare_many("any positions", 1000, [&] {
    const auto point = [&] { return at_pixel(uniform(0, kSize), uniform(0, kSize)); };
    return Triangle{point(), point(), point()};
  });
}

TEST_F(Coverage, Perspective) {
  compare_many("perspective", 1000, [&] {
    const auto point = [&] {
      const double w = uniform(1, 20);
      return clip_point(static_cast<float>(w * uniform(-1, 1)), static_cast<float>(w * uniform(-1, 1)),
                        static_cast<float>(w));
    };
    return Triangle{point(), point(), point()};
  });
}

// One or two vertices lie behind the near plane or the eye.
TEST_F(Coverage, BehindTheEye) {
  compare_many("behind the eye", 1000, [&] {
    const auto point = [&](double low, double high) {
      return clip_point(static_cast<float>(uniform(-4, 4)), static_cast<float>(uniform(-4, 4)),
                        static_cast<float>(uniform(low, high)));
    };
    return Triangle{point(1, 10), point(-10, 10), point(-10, 1)};
  });
}

}  // namespace beampipe::llvmpipe_coverage_test
