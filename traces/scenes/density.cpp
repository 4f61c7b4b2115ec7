#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

constexpr double kDistance = 6, kFovyDeg = 40;

// A wall that fills the picture exactly once, with triangles of about the same size: their number of pixels is the
// picture's, divided by the number of triangles. Its points are moved a little, so that the triangles lie on the pixel
// grid in all ways.
std::vector<Mesh> density_meshes(double budget, const SceneOptions& options, Random& random) {
  const double half_height = kDistance * std::tan(glm::radians(kFovyDeg / 2));
  const double half_width = half_height * options.width / options.height;
  const int rows = divisions(budget * half_height / half_width, 2, 1);
  const int columns = std::max(1, static_cast<int>(std::lround(budget / (2 * rows))));
  Mesh wall;
  wall.name = "wall";
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const bool border = i == 0 || j == 0 || i == columns || j == rows;
      const double move = border ? 0 : 0.25, size = 2 * half_width / columns;
      const double u = i + move * random.uniform(-1, 1), v = j + move * random.uniform(-1, 1);
      wall.positions.emplace_back(half_width * (2 * u / columns - 1), half_height * (2 * v / rows - 1),
                                  border ? 0.0 : 0.4 * size * random.uniform(-1, 1));
    }
  }
  const auto width = static_cast<std::uint32_t>(columns + 1);
  for (std::uint32_t a = 0; a + width + 1 < wall.positions.size(); ++a) {
    if (a % width + 1 == width) continue;
    wall.triangles.emplace_back(a, a + 1, a + width + 1);
    wall.triangles.emplace_back(a, a + width + 1, a + width);
  }
  wall.colors.assign(wall.triangles.size(), glm::vec3(0.75f, 0.70f, 0.62f));
  return {std::move(wall)};
}

}  // namespace

Trace make_density(const SceneOptions& options) {
  const Camera camera{
      .eye = {0, 0, kDistance}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = kFovyDeg, .near = 1, .far = 20};
  const auto build_wall = [&](double budget, Random& random) { return density_meshes(budget, options, random); };
  return one_frame(options, camera, build_to_budget(options, options.width * options.height / 10, build_wall));
}

}  // namespace beampipe
