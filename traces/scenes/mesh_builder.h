// Solid shapes from triangles. Triangles are counter-clockwise when seen from outside; a shape shares its vertices.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

using Path = std::vector<glm::dvec3>;

// `segments` + 1 points from `a` to `b`, hanging down by `sag` in the middle.
Path line(const glm::dvec3& a, const glm::dvec3& b, int segments = 1, double sag = 0);

class MeshBuilder {
 public:
  explicit MeshBuilder(std::string name) { mesh_.name = std::move(name); }

  glm::vec3 color{0.8f};                               // of the shapes that follow
  std::function<glm::dvec3(const glm::dvec3&)> place;  // moves or bends the shapes that follow; may be empty

  void triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
  void quad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

  // nu x nv quads with vertices at point(u, v), where u and v go from 0 to 1; `closed` joins u = 1 to u = 0. Triangles
  // that are only a line or a point, as at a sphere's poles, are left out.
  void surface(int nu, int nv, const std::function<glm::dvec3(double u, double v)>& point, bool closed = false);

  // Each face has divisions x divisions quads. The narrow sides of a plate are not divided across.
  void box(const glm::dvec3& low, const glm::dvec3& high, int divisions = 1);
  void sphere(const glm::dvec3& center, double radius, int sectors, int rings);  // 2 * sectors * (rings - 1) triangles

  // A round bar along the path with closed ends. The radius changes evenly from one end to the other.
  void tube(const Path& path, double start_radius, double end_radius, int sides);
  void tube(const Path& path, double radius, int sides) { tube(path, radius, radius, sides); }

  // Three threads plaited around the path. Each swings to and fro `turns` times.
  void braid(const Path& path, double thread_radius, double turns, int sides);

  std::size_t triangle_count() const { return mesh_.triangles.size(); }
  Mesh take() { return std::move(mesh_); }

 private:
  std::uint32_t vertex(const glm::dvec3& position);
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  Mesh mesh_;
};

}  // namespace beampipe
