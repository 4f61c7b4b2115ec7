#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

constexpr dvec3 kEye(0, 1.5, 6);
constexpr int kRows = 8;

// A thin board with a pointed top, whose back is at z. It has 16 triangles.
void add_picket(MeshBuilder& mesh, double x, double z, double width, double height) {
  const double left = x - width / 2, right = x + width / 2, shoulder = height - width;
  const dvec3 outline[] = {
      {left, -0.1, 0}, {right, -0.1, 0}, {right, shoulder, 0}, {x, height, 0}, {left, shoulder, 0}};
  const dvec3 back(0, 0, z), front(0, 0, z + 0.4 * width);
  const auto& o = outline;
  mesh.quad(o[0] + front, o[1] + front, o[2] + front, o[4] + front);
  mesh.triangle(o[4] + front, o[2] + front, o[3] + front);
  mesh.quad(o[1] + back, o[0] + back, o[4] + back, o[2] + back);
  mesh.triangle(o[2] + back, o[4] + back, o[3] + back);
  for (int i = 0; i < 5; ++i) {
    const dvec3 &a = o[i], &b = o[(i + 1) % 5];
    mesh.quad(a + back, b + back, b + front, a + front);
  }
}

std::vector<Mesh> pickets_meshes(double budget, Random& random) {
  MeshBuilder ground("ground"), pickets("pickets");
  ground.color = {0.20f, 0.35f, 0.10f};
  ground.quad({-40, 0, 5}, {40, 0, 5}, {40, 0, -40}, {-40, 0, -40});

  // A picket of the first row hides those of all other rows from the eye, but for slivers of a few percent of their
  // width.
  const int count = std::max(3, static_cast<int>(budget / (16 * kRows)));
  const double spacing = 7.2 / count;
  for (int row = 0; row < kRows; ++row) {
    const double z = -1.2 * row, farther = (kEye.z - z) / kEye.z;
    const glm::vec3 paint = row % 2 == 0 ? glm::vec3(0.92f, 0.88f, 0.78f) : glm::vec3(0.70f, 0.12f, 0.08f);
    for (int i = 0; i < count; ++i) {
      const double shift = random.uniform(-0.03, 0.03), width = 0.17 * spacing * random.uniform(0.94, 1.06);
      const double x = spacing * (i - 0.5 * (count - 1) + shift);
      pickets.color = random.vary(paint * (1.0f - 0.06f * static_cast<float>(row)), 0.1);
      add_picket(pickets, x * farther, z, width * farther, kEye.y + farther * (1.4 + random.uniform(-0.04, 0.04)));
    }
  }
  return {ground.take(), pickets.take()};
}

}  // namespace

Trace make_pickets(const SceneOptions& options) {
  const Camera camera{.eye = kEye, .target = {0, 1.5, 0}, .up = {0, 1, 0}, .fovy_deg = 34, .near = 0.5, .far = 60};
  return one_frame(options, camera, build_to_budget(options, 5000, pickets_meshes));
}

}  // namespace beampipe
