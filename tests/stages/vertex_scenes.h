// Traces of one mesh and one draw for the tests of vertex_setup.
#pragma once

#include "stages/geometry/vertex_setup.h"
#include "tests/test.h"

namespace beampipe {

struct Scene {
  Trace trace;
  Frame frame;

  SetupTriangles setup() const {
    StageCounters counters;
    return vertex_setup(trace, frame, counters);
  }
};

// Positions are clip coordinates (identity view and projection), three per triangle.
inline Scene clip_space_scene(const std::vector<glm::vec3>& positions, std::uint32_t width = 64,
                              std::uint32_t height = 32) {
  Scene scene;
  Mesh mesh;
  mesh.positions = positions;
  for (std::uint32_t i = 0; i + 2 < positions.size(); i += 3) mesh.triangles.emplace_back(i, i + 1, i + 2);
  mesh.colors.resize(mesh.triangles.size(), glm::vec3(1.0f));
  scene.trace.meshes.push_back(std::move(mesh));
  scene.frame.width = width;
  scene.frame.height = height;
  scene.frame.draws.emplace_back();
  return scene;
}

inline SetupTriangles vertex_setup_of(const Scene& scene, StageCounters& counters) {
  return vertex_setup(scene.trace, scene.frame, counters);
}

inline void expect_same(const SetupTriangles& a, const SetupTriangles& b) {
  const auto numbers = [](const SetupTriangles& triangles, std::size_t i) {
    const SetupTriangle& t = triangles.triangles[i];
    return std::tuple(std::array{t.x[0], t.x[1], t.x[2]}, std::array{t.y[0], t.y[1], t.y[2]},
                      std::array{t.vertex_z[0], t.vertex_z[1], t.vertex_z[2]}, t.front, t.depth.z, t.depth.dzdx,
                      t.depth.dzdy, triangles.attributes[i].normal, triangles.attributes[i].kd);
  };
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (std::size_t i = 0; i < a.triangles.size(); ++i) ASSERT_TRUE(numbers(a, i) == numbers(b, i)) << i;
}

}  // namespace beampipe
