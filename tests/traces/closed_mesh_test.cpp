#include "traces/closed_mesh.h"

#include <gtest/gtest.h>

namespace beampipe::closed_mesh_test {

// Its faces are counter-clockwise from outside.
Mesh tetrahedron() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

TEST(ClosedMesh, HasATriangleOnBothSidesOfEachEdge) {
  Mesh mesh = tetrahedron();
  EXPECT_TRUE(is_closed(mesh));
  mesh.triangles.pop_back();
  EXPECT_FALSE(is_closed(mesh));
  EXPECT_TRUE(is_closed(Mesh{}));
}

TEST(ClosedMesh, RunsInOppositeDirectionsAlongAnEdge) {
  Mesh mesh = tetrahedron();
  std::swap(mesh.triangles[2].x, mesh.triangles[2].y);
  EXPECT_FALSE(is_closed(mesh));
  for (const std::size_t i : {0u, 1u, 3u}) std::swap(mesh.triangles[i].x, mesh.triangles[i].y);  // inside out
  EXPECT_TRUE(is_closed(mesh));
}

TEST(ClosedMesh, OfABodyTheOutsideIsInFront) {
  Mesh mesh = tetrahedron();
  EXPECT_TRUE(is_closed_body(mesh));
  for (glm::vec3& p : mesh.positions) p -= 5.0f;  // wherever it is
  EXPECT_TRUE(is_closed_body(mesh));
  for (glm::uvec3& t : mesh.triangles) std::swap(t.x, t.y);
  EXPECT_FALSE(is_closed_body(mesh));
  EXPECT_FALSE(is_closed_body(Mesh{}));
}

TEST(ClosedMesh, LooksAtPositionsAndNotAtVertices) {
  Mesh mesh = tetrahedron();
  const std::vector<glm::vec3> shared = mesh.positions;
  for (glm::uvec3& t : mesh.triangles) {  // each triangle has its own vertices
    for (int k = 0; k < 3; ++k) {
      mesh.positions.push_back(shared[t[k]]);
      t[k] = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }
  }
  EXPECT_TRUE(is_closed(mesh));
  mesh.positions.back().x += 1e-6f;
  EXPECT_FALSE(is_closed(mesh));
}

TEST(ClosedMesh, IgnoresTrianglesThatAreLines) {
  Mesh mesh = tetrahedron();
  mesh.positions.push_back(glm::vec3(mesh.positions[1]));
  mesh.triangles.emplace_back(1, 4, 2);  // two of its corners are at the same place
  EXPECT_TRUE(is_closed(mesh));
}

// Two tetrahedra on either side of a face that both have.
TEST(ClosedMesh, MayHaveEdgesOfFourTriangles) {
  Mesh mesh = tetrahedron();
  mesh.positions.emplace_back(1, 1, 1);
  for (const glm::uvec3& t : {glm::uvec3(3, 2, 1), {1, 2, 4}, {2, 3, 4}, {3, 1, 4}}) mesh.triangles.push_back(t);
  EXPECT_TRUE(is_closed(mesh));
}

}  // namespace beampipe::closed_mesh_test
