#include "traces/files/vertex_frames.h"

#include "tests/test.h"

namespace beampipe::vertex_frames_test {

// Two triangles that make a square in the plane z = 0, facing +z.
Mesh square() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.normals.assign(4, {0, 0, 1});
  return mesh;
}

TEST(VertexFrames, TangentsPointTowardsU) {
  Mesh mesh = square();
  mesh.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};  // the image stands upright
  add_tangents(mesh, 0);
  EXPECT_EQ(mesh.tangents, std::vector<glm::vec4>(4, {1, 0, 0, 1}));
  mesh.uvs[0] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};  // mirrored
  add_tangents(mesh, 0);
  EXPECT_EQ(mesh.tangents, std::vector<glm::vec4>(4, {-1, 0, 0, -1}));
  mesh.uvs[1] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};  // turned: u is up
  add_tangents(mesh, 1);
  EXPECT_EQ(mesh.tangents, std::vector<glm::vec4>(4, {0, 1, 0, 1}));
}

TEST(VertexFrames, TangentsExistWithoutAreaInTheTexture) {
  Mesh mesh = square();
  mesh.uvs[0].assign(4, {0.5f, 0.5f});
  add_tangents(mesh, 0);
  for (const glm::vec4& tangent : mesh.tangents) {
    EXPECT_FLOAT_EQ(glm::length(glm::vec3(tangent)), 1);
    EXPECT_FLOAT_EQ(tangent.z, 0);
    EXPECT_EQ(std::abs(tangent.w), 1);
  }
}

TEST(VertexFrames, FlatNormalsBelongToOneTriangle) {
  Mesh mesh = square();
  mesh.positions[3] = {0, 0, 1};
  mesh.uvs[0] = {{0, 0}, {1, 0}, {2, 0}, {3, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 0, 1}};
  add_flat_normals(mesh);
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}));
  EXPECT_EQ(mesh.normals[2], glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh.normals[5], glm::vec3(0, -1, 0));
  EXPECT_EQ(mesh.normals[8], glm::vec3(0, 0, 1));  // it has no area
  EXPECT_EQ(mesh.positions[5], glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh.uvs[0][5], glm::vec2(3, 0));
}

}  // namespace beampipe::vertex_frames_test
