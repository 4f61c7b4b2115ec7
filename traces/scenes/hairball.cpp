#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

constexpr glm::vec3 kShades[] = {
    {0.55f, 0.25f, 0.08f}, {0.80f, 0.55f, 0.20f}, {0.25f, 0.12f, 0.06f}, {0.90f, 0.75f, 0.45f}, {0.60f, 0.12f, 0.05f}};

// A strand that leaves the ball and winds around a direction, which bends as well.
Path curl(Random& random, int segments) {
  const dvec3 outward = random.direction();
  const dvec3 side = glm::normalize(glm::cross(outward, random.direction()));
  const dvec3 bend = random.direction();
  const double length = random.uniform(0.7, 1.2), width = random.uniform(0.02, 0.08);
  const double turns = random.uniform(1, 3), phase = random.uniform(0, 6.28);
  Path path;
  for (int i = 0; i <= segments; ++i) {
    const double t = static_cast<double>(i) / segments, angle = phase + 6.283185307179586 * turns * t;
    const dvec3 across = std::cos(angle) * side + std::sin(angle) * glm::cross(outward, side);
    path.push_back((0.48 + length * t) * outward + 0.5 * t * t * bend + width * std::min(1.0, 4 * t) * across);
  }
  return path;
}

std::vector<Mesh> hairball_meshes(double budget, Random& random) {
  MeshBuilder ball("ball"), hair("hair");
  ball.color = {0.35f, 0.18f, 0.10f};
  const int rings = divisions(0.03 * budget, 4, 6);
  ball.sphere(dvec3(0.0), 0.5, 2 * rings, rings);

  const int segments = budget < 20000 ? 12 : 24;
  const double left = budget - static_cast<double>(ball.triangle_count());
  const int strands = std::max(1, static_cast<int>(left / (6 * segments + 2)));
  // The more strands there are, the thinner they get, so that about the same part of the ball stays visible.
  const double radius = 0.005 * std::pow(1000.0 / strands, 0.7);
  for (int i = 0; i < strands; ++i) {
    hair.color = random.vary(kShades[random.bits() % std::size(kShades)], 0.25);
    hair.tube(curl(random, segments), radius, 0.4 * radius, 3);
  }
  return {ball.take(), hair.take()};
}

}  // namespace

Trace make_hairball(const SceneOptions& options) {
  const Camera camera{.eye = {0, 0.4, 5.2}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 36, .near = 1, .far = 20};
  return one_frame(options, camera, build_to_budget(options, 150000, hairball_meshes));
}

}  // namespace beampipe
