#include "stages/samples/materials.h"

#include "tests/test.h"

namespace beampipe::materials_test {

SetupTriangles triangles_of(const std::vector<std::uint32_t>& draws, const std::vector<glm::vec3>& colors) {
  SetupTriangles triangles;
  triangles.draws = draws;
  for (const glm::vec3& kd : colors) triangles.attributes.emplace_back().kd = kd;
  return triangles;
}

// The last channel counts like the others, and so does the draw.
TEST(Materials, AreTheDrawAndTheColor) {
  const glm::vec3 red(1, 0, 0), purple(1, 0, 1);
  const SetupTriangles triangles = triangles_of({0, 0, 1, 0, 1}, {red, purple, red, red, red});
  EXPECT_EQ(material_ids(triangles, MaterialBy::color), (std::vector<std::uint32_t>{0, 1, 2, 0, 2}));
  EXPECT_EQ(material_ids(triangles, MaterialBy::draw), triangles.draws);
}

}  // namespace beampipe::materials_test
