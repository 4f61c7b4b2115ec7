#include "traces/files/vertex_frames.h"

#include <cmath>
#include <utility>
#include <vector>

namespace beampipe {
namespace {

// Twice the triangle's area long.
glm::dvec3 normal_of(const Mesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
  return glm::cross(b - a, c - a);
}

bool has_direction(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length);
}

glm::dvec3 perpendicular(const glm::dvec3& normal) {
  const glm::dvec3 axis = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(axis - normal * glm::dot(axis, normal));
}

template <class Vector>
void split(std::vector<Vector>& vertices, const std::vector<glm::uvec3>& triangles) {
  if (vertices.empty()) return;
  std::vector<Vector> all;
  all.reserve(3 * triangles.size());
  for (const glm::uvec3& t : triangles)
    for (int i = 0; i < 3; ++i) all.push_back(vertices[t[i]]);
  vertices = std::move(all);
}

}  // namespace

glm::vec3 unit_or_zero(const glm::dvec3& vector) {
  return has_direction(vector) ? glm::vec3(glm::normalize(vector)) : glm::vec3(0.0f);
}

void add_flat_normals(Mesh& mesh) {
  std::vector<glm::vec3> normals;
  normals.reserve(3 * mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 normal = normal_of(mesh, t);
    normals.insert(normals.end(), 3, has_direction(normal) ? glm::vec3(glm::normalize(normal)) : glm::vec3(0, 0, 1));
  }
  split(mesh.positions, mesh.triangles);
  split(mesh.tangents, mesh.triangles);
  for (auto& uvs : mesh.uvs) split(uvs, mesh.triangles);
  split(mesh.vertex_colors, mesh.triangles);
  mesh.normals = std::move(normals);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    mesh.triangles[i] = glm::uvec3(0, 1, 2) + static_cast<std::uint32_t>(3 * i);
}

std::size_t mend_normals(Mesh& mesh) {
  std::size_t broken = 0;
  for (const glm::vec3& normal : mesh.normals) broken += !has_direction(normal);
  if (broken == 0) return 0;
  std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
  for (const glm::uvec3& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) sums[t[i]] += normal_of(mesh, t);
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    if (has_direction(mesh.normals[i])) continue;
    mesh.normals[i] = has_direction(sums[i]) ? glm::vec3(glm::normalize(sums[i])) : glm::vec3(0, 0, 1);
  }
  return broken;
}

void add_tangents(Mesh& mesh, std::size_t uv_set) {
  const std::size_t count = mesh.positions.size();
  std::vector<glm::dvec3> along_u(count, glm::dvec3(0.0)), along_v(count, glm::dvec3(0.0));
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 origin = mesh.positions[t.x];
    const glm::dvec3 e1 = glm::dvec3(mesh.positions[t.y]) - origin, e2 = glm::dvec3(mesh.positions[t.z]) - origin;
    const std::vector<glm::vec2>& uvs = mesh.uvs[uv_set];
    const glm::dvec2 d1 = glm::dvec2(uvs[t.y]) - glm::dvec2(uvs[t.x]), d2 = glm::dvec2(uvs[t.z]) - glm::dvec2(uvs[t.x]);
    const double area = d1.x * d2.y - d2.x * d1.y;
    const glm::dvec3 u = (e1 * d2.y - e2 * d1.y) / area, v = (e2 * d1.x - e1 * d2.x) / area;
    if (!has_direction(u) || !has_direction(v)) continue;  // the triangle has no area in the texture
    for (int i = 0; i < 3; ++i) {
      along_u[t[i]] += u;
      along_v[t[i]] += v;
    }
  }
  mesh.tangents.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 normal = mesh.normals[i];
    glm::dvec3 tangent = along_u[i] - normal * glm::dot(normal, along_u[i]);
    tangent = has_direction(tangent) ? glm::normalize(tangent) : perpendicular(normal);
    const double up = -glm::dot(glm::cross(normal, tangent), along_v[i]);
    mesh.tangents[i] = glm::vec4(glm::vec3(tangent), up < 0 ? -1.0f : 1.0f);
  }
}

}  // namespace beampipe
