#include "tools/cli/framing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace beampipe {
namespace {

// How much of the picture's half width and half height the model may fill.
constexpr double kFill = 0.95;

void require(bool condition, const char* message) {
  if (!condition) throw std::invalid_argument(message);
}

// The vertices of all triangles that some frame shows, in world space. What stays as it was in the last frame counts
// once.
std::vector<glm::dvec3> shown_vertices(const Trace& trace) {
  std::vector<glm::dvec3> vertices;
  std::vector<bool> is_used;
  for (std::size_t i = 0; i < trace.frames.size(); ++i) {
    const std::vector<Draw>& draws = trace.frames[i].draws;
    for (std::size_t d = 0; d < draws.size(); ++d) {
      const Draw* last = i > 0 && d < trace.frames[i - 1].draws.size() ? &trace.frames[i - 1].draws[d] : nullptr;
      if (last && last->mesh == draws[d].mesh && last->transform == draws[d].transform) continue;
      const Mesh& mesh = trace.meshes[draws[d].mesh];
      is_used.assign(mesh.positions.size(), false);
      for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner) is_used[triangle[corner]] = true;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        if (is_used[v]) vertices.emplace_back(draws[d].transform * glm::dvec4(mesh.positions[v], 1.0));
    }
  }
  return vertices;
}

Bounds bounds_of(const std::vector<glm::dvec3>& vertices) {
  require(!vertices.empty(), "the model has no triangles");
  Bounds bounds{vertices.front(), vertices.front()};
  for (const glm::dvec3& vertex : vertices) {
    bounds.low = glm::min(bounds.low, vertex);
    bounds.high = glm::max(bounds.high, vertex);
  }
  require(bounds.low != bounds.high, "the model is a single point");
  return bounds;
}

Basis basis_of(const glm::dvec3& back, const glm::dvec3& up) {
  require(glm::length(back) > 0, "--eye and --target are the same point");
  const glm::dvec3 right = glm::cross(up, back);
  require(glm::length(right) > 1e-9 * glm::length(back) * glm::length(up), "--up is zero or along the line of sight");
  const glm::dvec3 unit_back = glm::normalize(back), unit_right = glm::normalize(right);
  return {unit_right, glm::cross(unit_back, unit_right), unit_back};
}

}  // namespace

Bounds shown_bounds(const Trace& trace) { return bounds_of(shown_vertices(trace)); }

Basis upright_basis(const glm::dvec3& up) {
  require(glm::length(up) > 0, "--up is zero");
  const glm::dvec3 z(0, 0, 1), across = glm::cross(up, z);
  const bool is_along_z = glm::length(across) <= 1e-9 * glm::length(up);
  const glm::dvec3 right = is_along_z ? glm::dvec3(1, 0, 0) : glm::normalize(across), unit_up = glm::normalize(up);
  return {right, unit_up, glm::cross(right, unit_up)};
}

Camera frame_model(const Trace& trace, std::uint32_t width, std::uint32_t height, const CameraWishes& wishes) {
  const std::vector<glm::dvec3> vertices = shown_vertices(trace);
  const Bounds bounds = bounds_of(vertices);
  Camera camera;
  camera.up = wishes.up.value_or(glm::dvec3(0, 1, 0));
  camera.target = wishes.target.value_or(bounds.middle());
  camera.fovy_deg = wishes.fovy_deg.value_or(36.0);
  require(camera.fovy_deg > 0 && camera.fovy_deg < 180, "--fovy must lie between 0 and 180 degrees");

  const glm::dvec3 back = wishes.eye ? *wishes.eye - camera.target : upright_basis(camera.up) * wishes.from;
  const Basis basis = basis_of(back, camera.up);
  const double slope_y = kFill * std::tan(glm::radians(camera.fovy_deg) / 2);
  const double slope_x = slope_y * width / height;
  double distance = 0;
  for (const glm::dvec3& vertex : vertices) {
    const glm::dvec3 offset = vertex - camera.target;
    const double right = std::abs(glm::dot(offset, basis.right)), up = std::abs(glm::dot(offset, basis.up));
    distance = std::max(distance, glm::dot(offset, basis.back) + std::max(right / slope_x, up / slope_y));
  }
  camera.eye = wishes.eye.value_or(camera.target + distance * basis.back);
  require(camera.eye != camera.target, "no view from --target shows the model; give --eye too");

  double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
  for (const glm::dvec3& vertex : vertices) {
    const double depth = glm::dot(camera.eye - vertex, basis.back);
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  camera.far = wishes.far.value_or(1.01 * farthest);
  require(camera.far > 0, "the whole model is behind the eye");
  camera.near = wishes.near.value_or(std::max(0.99 * nearest, 1e-3 * camera.far));
  require(camera.near > 0 && camera.near < camera.far, "0 < near < far does not hold for --near and --far");
  return camera;
}

glm::vec3 shoulder_light(const Camera& camera) {
  const Basis basis = basis_of(camera.eye - camera.target, camera.up);
  return glm::vec3(glm::normalize(-basis.back - 0.7 * basis.up + 0.4 * basis.right));
}

}  // namespace beampipe
