// Which triangles share what they take of a pixel.
#include "stages/surface/sheets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/stages/surface_scene.h"

namespace beampipe {
namespace {

using Sheets = std::vector<std::uint32_t>;

// Sheets of a mesh of translucent triangles in one draw.
std::vector<std::uint32_t> sheets_of(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& corners) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(0, 0, 1, 1, 0.5, unlit_material({1, 1, 1, 0.5f}, AlphaMode::blend));
  Mesh& mesh = scene.mesh();
  mesh.positions = positions, mesh.triangles = corners;
  mesh.uvs[0].resize(positions.size());
  mesh.colors.resize(corners.size(), kDefaultColor);
  mesh.materials.resize(corners.size(), 0);
  StageCounters ignored;
  return number_sheets(vertex_setup(scene.trace, scene.frame(), ignored));
}

TEST(Sheets, NeighborsThatFaceTheSameWayAreOne) {
  EXPECT_EQ(sheets_of({{0, 0, 0.5f}, {5, 0, 0.25f}, {5, 5, 0.5f}, {0, 5, 0.75f}}, {{0, 1, 2}, {0, 2, 3}}),
            (Sheets{0, 0}));
  // A strip that is bent, whose triangles come in any order: the last one connects the others.
  EXPECT_EQ(
      sheets_of({{0, 0, 0}, {0, 8, 0}, {4, 0, 0.5f}, {4, 8, 0.75f}, {8, 0, 0.25f}}, {{0, 2, 1}, {3, 2, 4}, {2, 3, 1}}),
      (Sheets{0, 0, 0}));
}

TEST(Sheets, LayersThatMeetInAVertexAreTwo) {
  EXPECT_EQ(sheets_of({{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {8, 0, 0.5f}, {0, 8, 0.5f}}, {{0, 1, 2}, {0, 3, 4}}),
            (Sheets{0, 1}));
}

// The second triangle lies on the same side of the common edge, by its winding or by its other side facing the viewer.
TEST(Sheets, AFoldSeparates) {
  EXPECT_EQ(sheets_of({{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 8, 0.5f}}, {{0, 1, 2}, {0, 1, 3}}), (Sheets{0, 1}));
  EXPECT_EQ(sheets_of({{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {8, 8, 0.5f}}, {{0, 1, 2}, {1, 0, 3}}), (Sheets{0, 1}));
}

// Pages of a book: two to the right of the spine, one to the left.
TEST(Sheets, ThreeTrianglesAtAnEdgeAreThree) {
  EXPECT_EQ(sheets_of({{4, 0, 0}, {4, 8, 0}, {8, 4, 0}, {8, 4, 0.5f}, {0, 4, 0}}, {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}),
            (Sheets{0, 1, 2}));
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

TEST(Sheets, PartsOfAClippedTriangleAreOne) {
  // The near plane cuts off a corner.
  EXPECT_EQ(sheets_of({{0, 0, -0.5f}, {8, 0, 0.5f}, {0, 8, 0.5f}}, {{0, 1, 2}}), (Sheets{0, 0}));
}

TEST(Sheets, DrawsAreSheetsOfTheirOwn) {
  SurfaceTrace scene(8, 8);
  for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask, AlphaMode::opaque, AlphaMode::blend})
    scene.add_rectangle(0, 0, 8, 8, 0.5, unlit_material({1, 1, 1, 0.5f}, mode));
  StageCounters ignored;
  const Sheets found = number_sheets(vertex_setup(scene.trace, scene.frame(), ignored));
  ASSERT_EQ(found.size(), 8u);
  EXPECT_EQ(Sheets(found.begin(), found.begin() + 4), (Sheets{0, 0, 1, 1}));
  EXPECT_EQ(Sheets(found.begin() + 6, found.end()), (Sheets{2, 2}));
}

}  // namespace
}  // namespace beampipe
