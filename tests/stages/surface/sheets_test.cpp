// Which triangles share what they take of a pixel.
#include "stages/surface/sheets.h"

#include "tests/simd/random.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::sheets_test {

using Sheets = std::vector<std::uint32_t>;

// Sheets of a mesh of translucent triangles in one draw.
std::vector<std::uint32_t> sheets_of(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& corners,
                                     StageCounters* counters = nullptr) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(0, 0, 1, 1, 0.5, unlit_material({1, 1, 1, 0.5f}, AlphaMode::blend));
  Mesh& mesh = scene.mesh();
  mesh.positions = positions, mesh.triangles = corners;
  mesh.uvs[0].resize(positions.size());
  mesh.colors.resize(corners.size(), kDefaultColor);
  mesh.materials.resize(corners.size(), 0);
  StageCounters ignored;
  const SetupTriangles triangles = vertex_setup(scene.trace, scene.frame(), ignored);
  return number_sheets(triangles, scene.frame(), counters ? *counters : ignored);
}

TEST(Sheets, NeighborsThatFaceTheSameWayAreOne) {
  const struct {
    const char* what;
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> corners;
    Sheets expected;
  } cases[] = {{"a square", {{0, 0, 0.5f}, {5, 0, 0.25f}, {5, 5, 0.5f}, {0, 5, 0.75f}}, {{0, 1, 2}, {0, 2, 3}}, {0, 0}},
               {"a strip that is bent, whose triangles come in any order: the last one connects the others",
                {{0, 0, 0}, {0, 8, 0}, {4, 0, 0.5f}, {4, 8, 0.75f}, {8, 0, 0.25f}},
                {{0, 2, 1}, {3, 2, 4}, {2, 3, 1}},
                {0, 0, 0}},
               {"layers that meet in a vertex",
                {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {8, 0, 0.5f}, {0, 8, 0.5f}},
                {{0, 1, 2}, {0, 3, 4}},
                {0, 1}},
               // The second triangle lies on the same side of the common edge.
               {"a fold by winding", {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 8, 0.5f}}, {{0, 1, 2}, {0, 1, 3}}, {0, 1}},
               {"a fold whose other side faces the viewer",
                {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {8, 8, 0.5f}},
                {{0, 1, 2}, {1, 0, 3}},
                {0, 1}},
               {"pages of a book: two to the right of the spine, one to the left",
                {{4, 0, 0}, {4, 8, 0}, {8, 4, 0}, {8, 4, 0.5f}, {0, 4, 0}},
                {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}},
                {0, 1, 2}},
               {"the page on the left comes second",
                {{4, 0, 0}, {4, 8, 0}, {8, 4, 0}, {8, 4, 0.5f}, {0, 4, 0}},
                {{0, 1, 2}, {1, 0, 4}, {0, 1, 3}},
                {0, 1, 2}},
               {"parts of a triangle whose corner the near plane cuts off",
                {{0, 0, -0.5f}, {8, 0, 0.5f}, {0, 8, 0.5f}},
                {{0, 1, 2}},
                {0, 0}},
               // They look like two parts of one, but are two of the mesh.
               {"the same triangle twice", {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, {{0, 1, 2}, {0, 1, 2}}, {0, 1}}};
  for (const auto& each : cases) EXPECT_EQ(sheets_of(each.positions, each.corners), each.expected) << each.what;
}

// The first triangle points at the longest side of the last one. Nothing but that side lies between the two: each side
// of the first one, made longer, cuts the last one. The two between them connect all.
TEST(Sheets, OneSideIsEnoughToLieBeside) {
  const std::vector<glm::vec3> positions = {{3, 0, 0}, {5, 0, 0}, {4, 3.5f, 0}, {0, 2, 0}, {8, 6, 0}, {0, 8, 0}};
  const std::vector<glm::uvec3> corners = {{0, 1, 2}, {2, 1, 4}, {2, 4, 3}, {3, 4, 5}};
  EXPECT_EQ(sheets_of(positions, corners), (Sheets{0, 0, 0, 0}));
  EXPECT_EQ(sheets_of(positions, {corners.rbegin(), corners.rend()}), (Sheets{0, 0, 0, 0}));
}

// Eight sides around the tip. Some face the viewer; the others lie behind them.
TEST(Sheets, AConeHasAFrontAndABack) {
  std::vector<glm::vec3> positions = {{4, 1, 0.5f}};
  for (int i = 0; i < 8; ++i) {
    const double angle = (i + 0.5) * 0.7853981633974483;
    positions.emplace_back(4 + 3 * std::cos(angle), 6 + std::sin(angle), 0.5 + 0.25 * std::sin(angle));
  }
  std::vector<glm::uvec3> corners;
  for (std::uint32_t i = 0; i < 8; ++i) corners.emplace_back(0, 1 + i, 1 + (i + 1) % 8);
  const Sheets found = sheets_of(positions, corners);
  EXPECT_EQ(found.size(), 8u);
  EXPECT_EQ(std::set(found.begin(), found.end()), (std::set<std::uint32_t>{0, 1}));
  EXPECT_NE(found[1], found[5]);  // the nearest side and the farthest one
}

// A ramp that winds twice around the middle of the picture: without a fold, its second turn lies over the first.
TEST(Sheets, ASpiralDoesNotLieOverItself) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> corners;
  constexpr std::uint32_t kSteps = 16;  // in a turn
  for (std::uint32_t i = 0; i <= 2 * kSteps; ++i) {
    const double angle = i * 6.283185307179586 / kSteps;
    for (const double radius : {1.5, 3.5})
      positions.emplace_back(4 + radius * std::cos(angle), 4 + radius * std::sin(angle), 0.01 * i);
    if (i == 0) continue;
    corners.emplace_back(2 * i - 2, 2 * i - 1, 2 * i);
    corners.emplace_back(2 * i - 1, 2 * i + 1, 2 * i);
  }
  const Sheets found = sheets_of(positions, corners);
  ASSERT_EQ(found.size(), 4 * kSteps);
  for (std::uint32_t i = 0; i < 2 * kSteps; ++i) {
    EXPECT_EQ(found[i], 0u);
    EXPECT_EQ(found[i + 2 * kSteps], 1u);
  }
}

// Leaves all over the picture: numbers are reused where leaves are far from each other, and two that overlap differ.
TEST(Sheets, NumbersAreReusedAwayFromEachOther) {
  SurfaceTrace scene(64, 64);
  Random random(1);
  constexpr int kLeaves = 400;
  std::vector<glm::dvec2> corners;
  for (int i = 0; i < kLeaves; ++i) {
    corners.emplace_back(random.real32(0, 60), random.real32(0, 60));
    scene.add_rectangle(corners[i].x, corners[i].y, corners[i].x + 4, corners[i].y + 4, 0.5,
                        unlit_material({1, 1, 1, 0.5f}, AlphaMode::blend));
  }
  StageCounters counters, of_numbers;
  const SetupTriangles triangles = vertex_setup(scene.trace, scene.frame(), counters);
  const Sheets found = number_sheets(triangles, scene.frame(), of_numbers);
  ASSERT_EQ(found.size(), 2u * kLeaves);
  for (int i = 0; i < kLeaves; ++i) {
    EXPECT_EQ(found[2 * i], found[2 * i + 1]);
    EXPECT_LT(found[2 * i], 40u);
    for (int j = 0; j < i; ++j) {
      const glm::dvec2 apart = glm::abs(corners[i] - corners[j]);
      EXPECT_FALSE(apart.x < 4 && apart.y < 4 && found[2 * i] == found[2 * j]) << i << ", " << j;
    }
  }
}

// What it costs grows with the number of triangles, however they lie: a fan and a strip of slivers.
TEST(Sheets, WorkGrowsWithTheNumberOfTriangles) {
  for (const bool is_fan : {true, false}) {
    double of_triangle[2];
    for (const int many : {0, 1}) {
      const std::uint32_t count = many ? 1'400 : 140;
      std::vector<glm::vec3> positions = {{1, 1, 0.5f}};
      std::vector<glm::uvec3> corners;
      for (std::uint32_t i = 0; i <= count; ++i) {
        const float along = 6 * static_cast<float>(i) / static_cast<float>(count);
        positions.emplace_back(is_fan ? glm::vec3(7, 1 + along, 0.5f) : glm::vec3(1 + along, i % 2 ? 1 : 7, 0.5f));
        if (is_fan && i > 0) corners.emplace_back(0, i, i + 1);
        if (!is_fan && i > 1) corners.emplace_back(i - 1, i % 2 ? i : i + 1, i % 2 ? i + 1 : i);
      }
      StageCounters counters;
      ASSERT_GT(sheets_of(positions, corners, &counters).size(), count - 2);
      of_triangle[many] = static_cast<double>(counters.ops.total()) / count;
    }
    EXPECT_LT(of_triangle[1], 2 * of_triangle[0]) << (is_fan ? "fan" : "strip");
  }
}

// Two triangles with a common side, of which the second is tried once. The grid has one cell,
// as large as the picture and the triangles.
TEST(Sheets, CountsItsWork) {
  StageCounters counters;
  sheets_of({{0, 0, 0.5f}, {8, 0, 0.5f}, {8, 8, 0.5f}, {0, 8, 0.5f}}, {{0, 1, 2}, {0, 2, 3}}, &counters);
  // Six sides are sorted. The second triangle is tested against the first: their boxes, and sides of both up to the
  // common one.
  EXPECT_EQ(counters.bytes_written, 6u * 12 + 2 * (8 + 32) + 2 * 4);
  EXPECT_EQ(counters.bytes_read, 6u * 12 + 2 * (8 + 32) + 1 * 24);
  EXPECT_EQ(counters.ops.bit, 2u * 16);
  EXPECT_EQ(counters.ops.convert, 2u * 4);
  EXPECT_EQ((counters.ops.mul_add - 2 * 4) % 8, 0u);
  EXPECT_GT(counters.ops.mul_add, 2u * 4);
  EXPECT_LE(counters.ops.mul_add, 2u * 4 + 6 * 8);
}

// Two triangles on either side of a vertical line: their boxes only touch, so no sides are compared. The grid has four
// cells of six pixels. The left triangle lies in two of them and the right one in all four, so two hold both. Six sides
// are sorted in three steps.
TEST(Sheets, TouchingBoxesTakeNoEdgeTests) {
  StageCounters counters;
  EXPECT_EQ(sheets_of({{4, 0, 0}, {4, 8, 0}, {8, 4, 0}, {0, 4, 0}}, {{0, 1, 2}, {1, 0, 3}}, &counters), (Sheets{0, 0}));
  EXPECT_EQ(counters.ops,
            (OperationCounts{.mul_add = 2 * 4, .add = 2 * 12 + 2 * 4 + 6 * 3 * 2, .bit = 6 * 16, .convert = 2 * 4}));
}

TEST(Sheets, DrawsAreSheetsOfTheirOwn) {
  SurfaceTrace scene(8, 8);
  for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask, AlphaMode::opaque, AlphaMode::blend})
    scene.add_rectangle(0, 0, 8, 8, 0.5, unlit_material({1, 1, 1, 0.5f}, mode));
  StageCounters ignored;
  const Sheets found = number_sheets(vertex_setup(scene.trace, scene.frame(), ignored), scene.frame(), ignored);
  ASSERT_EQ(found.size(), 8u);
  EXPECT_EQ(Sheets(found.begin(), found.begin() + 4), (Sheets{0, 0, 1, 1}));
  EXPECT_EQ(Sheets(found.begin() + 6, found.end()), (Sheets{2, 2}));
}

}  // namespace beampipe::sheets_test
