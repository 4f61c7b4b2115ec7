#include "traces/scenes/mesh_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "traces/unit_vector.h"

namespace beampipe {
namespace {

using glm::dvec2, glm::dvec3;

constexpr double kTurn = 2 * std::numbers::pi;

// Axes across a path.
struct Across {
  dvec3 u, v;
};

dvec3 tangent(const Path& path, std::size_t i) {
  const dvec3 difference = path[std::min(i + 1, path.size() - 1)] - path[i > 0 ? i - 1 : 0];
  const double length = glm::length(difference);
  return length > 0 ? difference / length : dvec3(0, 1, 0);
}

// The axes at each point of a path, carried along it without twisting.
std::vector<Across> axes_along(const Path& path) {
  std::vector<Across> axes(path.size());
  const dvec3 first = tangent(path, 0);
  dvec3 u = std::abs(first.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const dvec3 t = tangent(path, i);
    const dvec3 v = glm::cross(t, u);
    const double length = glm::length(v);
    if (length > 1e-9) axes[i].v = v / length;
    if (length <= 1e-9) axes[i].v = i > 0 ? axes[i - 1].v : dvec3(0, 0, 1);  // a sharp bend: keep the last axis
    axes[i].u = u = glm::cross(axes[i].v, t);
  }
  return axes;
}

double length_of(const Path& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length += glm::distance(path[i - 1], path[i]);
  return length;
}

}  // namespace

Path line(const dvec3& a, const dvec3& b, int segments, double sag) {
  Path path;
  for (int i = 0; i <= segments; ++i) {
    const double t = static_cast<double>(i) / segments;
    path.push_back(a + t * (b - a) - dvec3(0, 4 * sag * t * (1 - t), 0));
  }
  return path;
}

// Each shape begins at another place of a texture with many copies, so that like shapes do not look the same.
void MeshBuilder::start_shape() {
  first_vertex_ = mesh_.positions.size();
  first_triangle_ = mesh_.triangles.size();
  if (finish.texture_size > 0) shift_ = glm::fract(static_cast<double>(++shapes_) * dvec2(0.618034, 0.754878));
  if (finish.texture_size == 0) shift_ = {0, 0};
}

// Smooth normals: vertices of a shape at the same place share the mean of their triangles' normals. The weights make it
// independent of the diagonal that halves a quad. Source: N. Max, Weights for Computing Vertex Normals from Facet
// Normals, Journal of Graphics Tools 4(2), 1999.
void MeshBuilder::end_shape() {
  if (!has_material()) return;
  const auto key = [&](std::uint32_t i) {
    const glm::vec3& p = mesh_.positions[i];
    return std::array<float, 3>{p.x, p.y, p.z};
  };
  std::map<std::array<float, 3>, dvec3> sums;
  for (std::size_t i = first_triangle_; i < mesh_.triangles.size(); ++i) {
    const glm::uvec3& t = mesh_.triangles[i];
    for (int corner = 0; corner < 3; ++corner) {
      const dvec3 at = mesh_.positions[t[corner]];
      const dvec3 next = dvec3(mesh_.positions[t[(corner + 1) % 3]]) - at,
                  last = dvec3(mesh_.positions[t[(corner + 2) % 3]]) - at;
      const double squares = glm::dot(next, next) * glm::dot(last, last);
      if (squares > 0) sums[key(t[corner])] += glm::cross(next, last) / squares;
    }
  }
  for (auto i = static_cast<std::uint32_t>(first_vertex_); i < mesh_.positions.size(); ++i)
    mesh_.normals.push_back(unit_vector(sums[key(i)]).value_or(glm::vec3(0, 1, 0)));
}

double MeshBuilder::copies(double length) const { return finish.texture_size > 0 ? length / finish.texture_size : 1; }

// Colours and texture coordinates are rounded, so that they are short in a trace's text.
std::uint32_t MeshBuilder::vertex(const dvec3& position, const dvec2& uv) {
  mesh_.positions.emplace_back(place ? place(position) : position);
  if (has_material()) {
    const dvec2 at = texture_place ? texture_place(position) : uv + shift_;
    mesh_.uvs[0].emplace_back(glm::round(at * 1e5) / 1e5);
    mesh_.vertex_colors.emplace_back(glm::vec3(glm::round(dvec3(color) * 1e3) / 1e3), 1.0f);
  }
  return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

// For triangles with other normals.
std::uint32_t MeshBuilder::copy_vertices(std::uint32_t first, std::uint32_t count) {
  const auto copy = static_cast<std::uint32_t>(mesh_.positions.size());
  for (std::uint32_t i = first; i < first + count; ++i) {
    mesh_.positions.push_back(glm::vec3(mesh_.positions[i]));
    mesh_.uvs[0].push_back(glm::vec2(mesh_.uvs[0][i]));
    mesh_.vertex_colors.push_back(glm::vec4(mesh_.vertex_colors[i]));
  }
  return copy;
}

void MeshBuilder::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh_.triangles.emplace_back(a, b, c);
  mesh_.colors.push_back(has_material() ? kDefaultColor : color);
  if (has_material()) mesh_.materials.push_back(finish.material);
}

void MeshBuilder::triangle(const dvec3& a, const dvec3& b, const dvec3& c) {
  start_shape();
  const std::uint32_t first = vertex(a, {0, 1});
  vertex(b, {1, 1});
  vertex(c, {1, 0});
  triangle(first, first + 1, first + 2);
  end_shape();
}

void MeshBuilder::quad(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
  start_shape();
  const double right = copies(glm::distance(a, b)), down = copies(glm::distance(a, d));
  const std::uint32_t first = vertex(a, {0, down});
  vertex(b, {right, down});
  vertex(c, {right, 0});
  vertex(d, {0, 0});
  triangle(first, first + 1, first + 2);
  triangle(first, first + 2, first + 3);
  end_shape();
}

void MeshBuilder::surface(int nu, int nv, const std::function<dvec3(double, double)>& point, bool closed) {
  patch(nu, nv, point, closed, false);
}

// turned: the texture's u runs along v.
void MeshBuilder::patch(int nu, int nv, const std::function<dvec3(double, double)>& point, bool closed, bool turned) {
  start_shape();
  double along_u = 1, along_v = 1;  // copies of the texture
  if (has_material() && finish.texture_size > 0) {
    Path row, column;  // through the middle
    for (int i = 0; i <= nu; ++i) row.push_back(point(static_cast<double>(i) / nu, 0.5));
    for (int j = 0; j <= nv; ++j) column.push_back(point(0.5, static_cast<double>(j) / nv));
    along_u = closed ? std::max(1.0, std::round(copies(length_of(row)))) : copies(length_of(row));
    along_v = copies(length_of(column));
  }
  // Where a closed surface meets itself, its texture starts and ends: with a texture there are vertices for both.
  const bool joined = closed && !has_material();
  const int columns = joined ? nu : nu + 1;
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double u = static_cast<double>(i) / nu, v = static_cast<double>(j) / nv;
      const dvec2 right_up(along_u * u, along_v * v);
      vertex(point(closed && i == nu ? 0 : u, v),
             turned ? dvec2(right_up.y, right_up.x) : dvec2(right_up.x, along_v - right_up.y));
    }
  }
  const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(j * columns + i % columns); };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto& p = mesh_.positions;
    if (p[a] != p[b] && p[b] != p[c] && p[c] != p[a]) triangle(a, b, c);
  };
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  end_shape();
}

void MeshBuilder::box(const dvec3& low, const dvec3& high, int divisions) {
  const dvec3 size = high - low;
  const double longest = std::max({size.x, size.y, size.z});
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const auto along = [&](int k) { return size[k] < 0.2 * longest ? 1 : divisions; };
    for (const bool far_side : {false, true}) {
      const int across = far_side ? a : b, up = far_side ? b : a;
      const bool turned = finish.texture_size > 0 && size[up] > size[across];
      const auto between = [&](int k, double t) { return t == 1 ? high[k] : low[k] + size[k] * t; };
      const auto point = [&](double u, double v) {
        dvec3 p;
        p[axis] = far_side ? high[axis] : low[axis];
        p[a] = between(a, far_side ? u : v);
        p[b] = between(b, far_side ? v : u);
        return p;
      };
      patch(along(across), along(up), point, false, turned);
    }
  }
}

void MeshBuilder::sphere(const dvec3& center, double radius, int sectors, int rings) {
  surface(
      sectors, rings,
      [&](double u, double v) {
        const double r = v == 0 || v == 1 ? 0 : std::sin(kTurn / 2 * v);
        return center + radius * dvec3(r * std::sin(kTurn * u), -std::cos(kTurn / 2 * v), r * std::cos(kTurn * u));
      },
      true);
}

void MeshBuilder::tube(const Path& path, double start_radius, double end_radius, int sides) {
  start_shape();
  const std::vector<Across> axes = axes_along(path);
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  const auto n = static_cast<std::uint32_t>(sides);
  const std::uint32_t columns = has_material() ? n + 1 : n;  // with a texture, its start and end have own vertices
  const double length = length_of(path), round = std::max(1.0, std::round(copies(kTurn * start_radius)));
  double along = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(path.size() - 1);
    const double radius = start_radius + t * (end_radius - start_radius);
    if (i > 0) along += glm::distance(path[i - 1], path[i]);
    for (std::uint32_t k = 0; k < columns; ++k) {
      const double angle = kTurn * (k % n) / sides;
      vertex(path[i] + radius * (std::cos(angle) * axes[i].u + std::sin(angle) * axes[i].v),
             {copies(length) * along / length, round * k / sides});
    }
  }
  const auto last = first + columns * static_cast<std::uint32_t>(path.size() - 1);
  for (std::uint32_t ring = first; ring < last; ring += columns) {
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t next = (k + 1) % columns;
      triangle(ring + k, ring + next, ring + columns + k);
      triangle(ring + next, ring + columns + next, ring + columns + k);
    }
  }
  end_shape();
  start_shape();  // the ends
  const std::uint32_t start = has_material() ? copy_vertices(first, n) : first;
  const std::uint32_t end = has_material() ? copy_vertices(last, n) : last;
  for (std::uint32_t k = 2; k < n; ++k) {
    triangle(start, start + k, start + k - 1);
    triangle(end, end + k - 1, end + k);
  }
  end_shape();
}

void MeshBuilder::braid(const Path& path, double thread_radius, double turns, int sides) {
  const std::vector<Across> axes = axes_along(path);
  for (int thread = 0; thread < 3; ++thread) {
    Path plaited;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(path.size() - 1);
      const double phase = kTurn * (turns * t + thread / 3.0);
      const double x = 2 * thread_radius * std::sin(phase), z = thread_radius * std::sin(2 * phase);
      plaited.push_back(path[i] + x * axes[i].u + z * axes[i].v);
    }
    tube(plaited, thread_radius, sides);
  }
}

}  // namespace beampipe
