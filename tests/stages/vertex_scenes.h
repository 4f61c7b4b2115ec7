// Traces of one mesh and one draw for the tests of vertex_setup.
#pragma once

#include <vector>

#include "stages/geometry/vertex_setup.h"

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

}  // namespace beampipe
