#include "traces/scenes/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace beampipe {
namespace {

using glm::dvec3;

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

}  // namespace

Path line(const dvec3& a, const dvec3& b, int segments, double sag) {
  Path path;
  for (int i = 0; i <= segments; ++i) {
    const double t = static_cast<double>(i) / segments;
    path.push_back(a + t * (b - a) - dvec3(0, 4 * sag * t * (1 - t), 0));
  }
  return path;
}

std::uint32_t MeshBuilder::vertex(const dvec3& position) {
  mesh_.positions.emplace_back(place ? place(position) : position);
  return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

void MeshBuilder::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh_.triangles.emplace_back(a, b, c);
  mesh_.colors.push_back(color);
}

void MeshBuilder::triangle(const dvec3& a, const dvec3& b, const dvec3& c) {
  const std::uint32_t first = vertex(a);
  vertex(b);
  vertex(c);
  triangle(first, first + 1, first + 2);
}

void MeshBuilder::quad(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
  const std::uint32_t first = vertex(a);
  vertex(b);
  vertex(c);
  vertex(d);
  triangle(first, first + 1, first + 2);
  triangle(first, first + 2, first + 3);
}

void MeshBuilder::surface(int nu, int nv, const std::function<dvec3(double, double)>& point, bool closed) {
  const int columns = closed ? nu : nu + 1;
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i < columns; ++i) vertex(point(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
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
}

void MeshBuilder::box(const dvec3& low, const dvec3& high, int divisions) {
  const dvec3 size = high - low;
  const double longest = std::max({size.x, size.y, size.z});
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const auto along = [&](int k) { return size[k] < 0.2 * longest ? 1 : divisions; };
    for (const bool far_side : {false, true}) {
      surface(along(far_side ? a : b), along(far_side ? b : a), [&](double u, double v) {
        dvec3 p;
        p[axis] = far_side ? high[axis] : low[axis];
        p[a] = low[a] + size[a] * (far_side ? u : v);
        p[b] = low[b] + size[b] * (far_side ? v : u);
        return p;
      });
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
  const std::vector<Across> axes = axes_along(path);
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(path.size() - 1);
    const double radius = start_radius + t * (end_radius - start_radius);
    for (int k = 0; k < sides; ++k) {
      const double angle = kTurn * k / sides;
      vertex(path[i] + radius * (std::cos(angle) * axes[i].u + std::sin(angle) * axes[i].v));
    }
  }
  const auto last = first + n * static_cast<std::uint32_t>(path.size() - 1);
  for (std::uint32_t ring = first; ring < last; ring += n) {
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t next = (k + 1) % n;
      triangle(ring + k, ring + next, ring + n + k);
      triangle(ring + next, ring + n + next, ring + n + k);
    }
  }
  for (std::uint32_t k = 2; k < n; ++k) {
    triangle(first, first + k, first + k - 1);
    triangle(last, last + k - 1, last + k);
  }
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
