#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

constexpr double kNear = 1.2, kFar = 60.0;

double smooth(double t) { return t * t * (3 - 2 * t); }

// Random values at integer points, joined smoothly; 0..1.
double noise(double x, double z, std::uint64_t seed) {
  const double fx = std::floor(x), fz = std::floor(z);
  const auto value = [&](int dx, int dz) {
    const auto ix = static_cast<std::int64_t>(fx) + dx, iz = static_cast<std::int64_t>(fz) + dz;
    const std::uint64_t key = static_cast<std::uint64_t>(ix) * 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(iz);
    return static_cast<double>(mix_bits(mix_bits(key) ^ seed) >> 11) * 0x1p-53;
  };
  const double u = smooth(x - fx), v = smooth(z - fz);
  return (value(0, 0) * (1 - u) + value(1, 0) * u) * (1 - v) + (value(0, 1) * (1 - u) + value(1, 1) * u) * v;
}

double height(double x, double z, std::uint64_t seed) {
  double sum = 0, size = 1;
  for (int octave = 0; octave < 7; ++octave, size *= 0.5) {
    sum += size * (noise(0.22 * x / size, 0.22 * z / size, seed + static_cast<std::uint64_t>(octave)) - 0.5);
  }
  return sum * 0.24 * std::sqrt(x * x + z * z);  // flat where the viewer stands, mountains far away
}

glm::vec3 ground_color(const dvec3& at, double steepness, std::uint64_t seed, Random& random) {
  const glm::vec3 grass(0.16f, 0.40f, 0.07f), straw(0.58f, 0.48f, 0.18f), rock(0.42f, 0.34f, 0.28f),
      snow(0.92f, 0.94f, 0.98f);
  if (at.y > 2.2) return random.vary(snow, 0.1);
  if (steepness > 0.3 || at.y > 1.4) return random.vary(rock, 0.25);
  return random.vary(noise(0.9 * at.x, 0.9 * at.z, seed + 99) > 0.55 ? straw : grass, 0.25);
}

// A fan of rows in front of the viewer. Each row is farther away than the last by the same factor, so that triangles
// keep their width on the screen and get flatter and denser towards the horizon.
std::vector<Mesh> terrain_meshes(double budget, Random& random) {
  Mesh ground;
  ground.name = "ground";
  const std::uint64_t seed = random.bits();
  const int n = divisions(budget, 2, 2), columns = n * 7 / 6, rows = n * 6 / 7;
  for (int j = 0; j <= rows; ++j) {
    const double z = kNear * std::pow(kFar / kNear, static_cast<double>(j) / rows);
    for (int i = 0; i <= columns; ++i) {
      const double x = 0.85 * z * (2.0 * i / columns - 1);
      ground.positions.emplace_back(x, height(x, -z, seed), -z);
    }
  }
  const auto add = [&](const glm::uvec3& t) {
    const dvec3 a = ground.positions[t.x], b = ground.positions[t.y], c = ground.positions[t.z];
    const dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    ground.triangles.push_back(t);
    ground.colors.push_back(ground_color(a, 1 - normal.y, seed, random));
  };
  const auto width = static_cast<std::uint32_t>(columns + 1);
  for (std::uint32_t a = 0; a + width < ground.positions.size(); ++a) {
    if (a % width + 1 == width) continue;
    add({a, a + 1, a + width + 1});
    add({a, a + width + 1, a + width});
  }
  return {std::move(ground)};
}

}  // namespace

Trace make_terrain(const SceneOptions& options) {
  const Camera camera{
      .eye = {0, 1.0, 0}, .target = {0, 0.35, -4}, .up = {0, 1, 0}, .fovy_deg = 42, .near = 0.2, .far = 120};
  return one_frame(options, camera, build_to_budget(options, 150000, terrain_meshes));
}

}  // namespace beampipe
