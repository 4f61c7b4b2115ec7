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

glm::dvec3 middle_of_bounds(const std::vector<glm::dvec3>& vertices) {
  glm::dvec3 low = vertices.front(), high = low;
  for (const glm::dvec3& vertex : vertices) {
    low = glm::min(low, vertex);
    high = glm::max(high, vertex);
  }
  require(low != high, "the model is a single point");
  return (low + high) * 0.5;
}

struct Basis {
  glm::dvec3 right, up, back;  // of unit length; `back` points from the target to the eye
};

Basis basis_of(const glm::dvec3& back, const glm::dvec3& up) {
  require(glm::length(back) > 0, "--eye and --target are the same point");
  const glm::dvec3 right = glm::cross(up, back);
  require(glm::length(right) > 1e-9 * glm::length(back) * glm::length(up), "--up is zero or along the line of sight");
  const glm::dvec3 unit_back = glm::normalize(back), unit_right = glm::normalize(right);
  return {unit_right, glm::cross(unit_back, unit_right), unit_back};
}

}  // namespace

Camera frame_model(const Trace& trace, std::uint32_t width, std::uint32_t height, const CameraWishes& wishes) {
  const std::vector<glm::dvec3> vertices = shown_vertices(trace);
  require(!vertices.empty(), "the model has no triangles");
  Camera camera;
  camera.up = wishes.up.value_or(glm::dvec3(0, 1, 0));
  camera.target = wishes.target.value_or(middle_of_bounds(vertices));
  camera.fovy_deg = wishes.fovy_deg.value_or(36.0);
  require(camera.fovy_deg > 0 && camera.fovy_deg < 180, "--fovy must lie between 0 and 180 degrees");

  const glm::dvec3 back = wishes.eye ? *wishes.eye - camera.target : glm::dvec3(0.5, 0.3, 1.0);
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
