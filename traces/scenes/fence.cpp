#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

struct Fence {
  double z, yaw, width, height;
  glm::vec3 color;
};

// Each as wide as the picture where it stands.
constexpr Fence kFences[] = {{0.0, 0.10, 6.2, 2.5, {0.75f, 0.77f, 0.80f}},
                             {-1.6, -0.15, 8.0, 2.6, {0.10f, 0.50f, 0.20f}},
                             {-3.6, 0.20, 10.5, 2.8, {0.60f, 0.28f, 0.10f}},
                             {-6.0, -0.10, 13.5, 3.0, {0.85f, 0.80f, 0.15f}}};

// Wires are flattened helices that run upwards. Each hooks into the bends of its neighbours.
void add_fence(MeshBuilder& mesh, const Fence& fence, double cell) {
  mesh.place = [=](const dvec3& p) {
    return dvec3(std::cos(fence.yaw) * p.x + std::sin(fence.yaw) * p.z, p.y,
                 fence.z - std::sin(fence.yaw) * p.x + std::cos(fence.yaw) * p.z);
  };
  const double radius = 0.02 * cell, left = -fence.width / 2;
  const int wires = static_cast<int>(fence.width / cell), bends = static_cast<int>(2 * fence.height / cell);
  for (int wire = 0; wire < wires; ++wire) {
    const double x = left + (wire + 0.5) * cell, reach = 0.5 * cell + radius;
    Path path;
    for (int i = 0; i <= 2 * bends; ++i) {
      const int quarter = (i + 2 * (wire % 2)) % 4;  // of a turn: middle, right bend, middle, left bend
      const double side = quarter == 1 ? reach : quarter == 3 ? -reach : 0;
      const double depth = quarter == 0 ? 1.5 * radius : quarter == 2 ? -1.5 * radius : 0;
      path.push_back({x + side, 0.25 * cell * i, depth});
    }
    mesh.tube(path, radius, 3);
  }
  const int posts = 4;
  for (int i = 0; i <= posts; ++i) {
    const double x = left + fence.width * i / posts;
    mesh.tube(line({x, 0, -0.05}, {x, fence.height + 0.05, -0.05}), 0.03, 4);
  }
  mesh.tube(line({left, fence.height, 0}, {-left, fence.height, 0}), 0.02, 4);
  mesh.place = nullptr;
}

std::vector<Mesh> fence_meshes(double budget, Random& random) {
  MeshBuilder ground("ground"), backdrop("backdrop"), fences("fences");
  ground.color = {0.30f, 0.28f, 0.25f};
  ground.quad({-20, 0, 5}, {20, 0, 5}, {20, 0, -20}, {-20, 0, -20});
  const int rings = divisions(0.005 * budget, 4, 3);
  for (int i = 0; i < 7; ++i) {
    const double x = -5.4 + 1.8 * i, size = random.uniform(0.4, 0.9), z = random.uniform(-9, -7);
    backdrop.color = random.uniform({0.2, 0.05, 0.05}, {0.9, 0.7, 0.6});
    if (i % 2 == 0) backdrop.sphere({x, size, z}, size, 2 * rings, rings);
    if (i % 2 == 1) backdrop.box({x - size, 0, z - size}, {x + size, 3 * size, z + size});
  }

  double area = 0;
  for (const Fence& fence : kFences) area += fence.width * fence.height;
  // Each cell has 24 triangles: one turn of a wire, which is as high as the cell, has four segments of six triangles.
  const double left =
      std::max(0.3 * budget, budget - 900.0 - static_cast<double>(ground.triangle_count() + backdrop.triangle_count()));
  const double cell = std::min(2.0, std::sqrt(24 * area / left));
  for (const Fence& fence : kFences) {
    fences.color = fence.color;
    add_fence(fences, fence, cell);
  }
  return {ground.take(), backdrop.take(), fences.take()};
}

}  // namespace

Trace make_fence(const SceneOptions& options) {
  const Camera camera{
      .eye = {0.3, 1.35, 4.6}, .target = {0, 1.2, 0}, .up = {0, 1, 0}, .fovy_deg = 36, .near = 0.5, .far = 40};
  return one_frame(options, camera, build_to_budget(options, 60000, fence_meshes));
}

}  // namespace beampipe
