#include <algorithm>
#include <cmath>
#include <numbers>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

constexpr double kStackDistance = 10, kStackFovyDeg = 40, kStackDepth = 4;

// Triangles at random depths, each of which covers the whole picture, so that every pixel has as many fragments as
// there are triangles.
std::vector<Mesh> stack_meshes(double budget, const SceneOptions& options, Random& random) {
  const double half_height = std::tan(glm::radians(kStackFovyDeg / 2));  // at distance 1
  const double half_width = half_height * options.width / options.height;
  Mesh stack;
  stack.name = "stack";
  const int triangles = std::max(1, static_cast<int>(std::lround(budget)));
  for (int i = 0; i < triangles; ++i) {
    const double z = random.uniform(-kStackDepth / 2, kStackDepth / 2), distance = kStackDistance - z;
    const double x = random.uniform(-0.9, 0.9) * half_width, y = random.uniform(-0.9, 0.9) * half_height;
    // The triangle's inscribed circle, which is around (x, y), contains the picture.
    const double circle = 2 * std::hypot(half_width, half_height), turn = random.uniform(0, 2 * std::numbers::pi);
    const auto first = static_cast<std::uint32_t>(stack.positions.size());
    for (int corner = 0; corner < 3; ++corner) {
      const double angle = turn + corner * 2 * std::numbers::pi / 3;
      stack.positions.emplace_back(distance * (x + 2 * circle * std::cos(angle)),
                                   distance * (y + 2 * circle * std::sin(angle)), z);
    }
    stack.triangles.emplace_back(first, first + 1, first + 2);
    stack.colors.emplace_back(random.uniform(glm::dvec3(0.2), glm::dvec3(0.9)));
  }
  return {std::move(stack)};
}

}  // namespace

Trace make_stack(const SceneOptions& options) {
  const Camera camera{.eye = {0, 0, kStackDistance},
                      .target = {0, 0, 0},
                      .up = {0, 1, 0},
                      .fovy_deg = kStackFovyDeg,
                      .near = 1,
                      .far = 40};
  const auto build_stack = [&](double budget, Random& random) { return stack_meshes(budget, options, random); };
  return one_frame(options, camera, build_to_budget(options, 64, build_stack));
}

}  // namespace beampipe
