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

// What a shape is made of. A shape with a material has smooth normals, its colour at the vertices, and texture
// coordinates: textures stand upright where the shape is seen from outside, and their u runs along tubes and along the
// longer sides of boxes.
struct Finish {
  std::uint32_t material = kNoMaterial;  // index into Trace::materials
  double texture_size = 0;  // width of one copy, in scene units; 0: one copy covers the shape, or each face of a box
};

class MeshBuilder {
 public:
  explicit MeshBuilder(std::string name) { mesh_.name = std::move(name); }

  // Of the shapes that follow.
  glm::vec3 color{0.8f};
  std::function<glm::dvec3(const glm::dvec3&)> place;  // moves or bends them; may be empty

  Finish finish;  // either all shapes of a mesh have a material or none has
  std::function<glm::dvec2(const glm::dvec3&)>
      texture_place;  // gives the texture coordinates of positions; may be empty

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
  bool has_material() const { return finish.material != kNoMaterial; }
  double copies(double length) const;  // of the texture
  std::uint32_t vertex(const glm::dvec3& position, const glm::dvec2& uv);
  std::uint32_t copy_vertices(std::uint32_t first, std::uint32_t count);
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void patch(int nu, int nv, const std::function<glm::dvec3(double u, double v)>& point, bool closed, bool turned);
  void start_shape();
  void end_shape();

  Mesh mesh_;
  std::size_t first_vertex_ = 0, first_triangle_ = 0;  // of the shape that is being made
  glm::dvec2 shift_{0.0};                              // of its texture
  int shapes_ = 0;
};

}  // namespace beampipe
