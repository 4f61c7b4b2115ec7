#include "tools/stress/exact.h"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <optional>

namespace beampipe {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Integer = boost::multiprecision::cpp_int;
using Vector4 = std::array<Rational, 4>;

constexpr std::int64_t kUnits = 256;          // steps of the snapping grid per pixel
constexpr std::int64_t kGuardPixels = 32768;  // the largest distance of a vertex from the viewport's origin

// ---- Vertices

using Matrix = std::array<std::array<Rational, 4>, 4>;  // [row][column]

Matrix rational(const glm::dmat4& m) {
  Matrix result;
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      result[row][column] = Rational(m[static_cast<int>(column)][static_cast<int>(row)]);
  return result;
}

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix result;
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      for (std::size_t k = 0; k < 4; ++k) result[row][column] += a[row][k] * b[k][column];
  return result;
}

Vector4 transformed(const Matrix& m, const glm::vec3& p) {
  Vector4 result;
  for (std::size_t row = 0; row < 4; ++row)
    result[row] = m[row][0] * Rational(p.x) + m[row][1] * Rational(p.y) + m[row][2] * Rational(p.z) + m[row][3];
  return result;
}

Rational dot(const Vector4& a, const Vector4& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

std::vector<Vector4> clipped(const std::vector<Vector4>& polygon, const Vector4& plane) {
  std::vector<Vector4> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector4 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const Rational d_from = dot(plane, from), d_to = dot(plane, to);
    if (d_from >= 0) kept.push_back(from);
    if ((d_from >= 0) == (d_to >= 0)) continue;
    const Rational s = d_from / (d_from - d_to);
    Vector4 at;
    for (std::size_t k = 0; k < 4; ++k) at[k] = from[k] + s * (to[k] - from[k]);
    kept.push_back(at);
  }
  return kept;
}

// ---- Triangles on the screen: x to the right, y down, in 1/256 px

struct Point {
  Rational x, y;
};

// The plane through a triangle's snapped vertices: z = zx x + zy y + z0.
struct Plane {
  Rational zx, zy, z0;
};

struct ScreenTriangle {
  std::array<std::int64_t, 3> x, y;  // in such an order that the inside is on the positive side of every edge
  Plane depth;
  glm::dvec3 color;
};

std::int64_t snapped(const Rational& pixels) {
  const Rational shifted = pixels * kUnits + Rational(1, 2);
  Integer quotient = numerator(shifted) / denominator(shifted);
  if (quotient * denominator(shifted) > numerator(shifted)) --quotient;  // towards minus infinity
  return static_cast<std::int64_t>(quotient);
}

std::optional<ScreenTriangle> on_screen(const Vector4& a, const Vector4& b, const Vector4& c, const Frame& frame,
                                        const glm::vec3& color) {
  ScreenTriangle t;
  std::array<Rational, 3> z;
  std::size_t k = 0;
  for (const Vector4* v : {&a, &b, &c}) {
    if ((*v)[3] <= 0) return std::nullopt;
    t.x[k] = snapped(((*v)[0] / (*v)[3] + 1) / 2 * frame.width);
    t.y[k] = snapped((1 - (*v)[1] / (*v)[3]) / 2 * frame.height);
    z[k] = (*v)[2] / (*v)[3];
    ++k;
  }
  std::int64_t area2 = (t.x[1] - t.x[0]) * (t.y[2] - t.y[0]) - (t.x[2] - t.x[0]) * (t.y[1] - t.y[0]);
  if (area2 == 0) return std::nullopt;
  if (area2 < 0) {
    std::swap(t.x[1], t.x[2]);
    std::swap(t.y[1], t.y[2]);
    std::swap(z[1], z[2]);
    area2 = -area2;
  }
  const Rational qx = t.x[1] - t.x[0], qy = t.y[1] - t.y[0], qz = z[1] - z[0];
  const Rational rx = t.x[2] - t.x[0], ry = t.y[2] - t.y[0], rz = z[2] - z[0];
  t.depth.zx = (qz * ry - rz * qy) / area2;
  t.depth.zy = (rz * qx - qz * rx) / area2;
  t.depth.z0 = z[0] - t.depth.zx * t.x[0] - t.depth.zy * t.y[0];
  t.color = color;
  return t;
}

bool finite(const glm::vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

std::vector<ScreenTriangle> screen_triangles(const Trace& trace, const Frame& frame) {
  const Rational right = Rational(2 * kGuardPixels, frame.width) - 1, left = right + 2;
  const Rational low = Rational(2 * kGuardPixels, frame.height) - 1, high = low + 2;
  const Vector4 planes[] = {{0, 0, 1, 1},      {0, 0, -1, 1},  {1, 0, 0, left},
                            {-1, 0, 0, right}, {0, 1, 0, low}, {0, -1, 0, high}};
  const Matrix camera = product(rational(frame.projection), rational(frame.view));
  std::vector<ScreenTriangle> result;
  for (const Draw& draw : frame.draws) {
    const Mesh& mesh = trace.meshes[draw.mesh];
    const Matrix matrix = product(camera, rational(draw.transform));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const glm::uvec3& corner = mesh.triangles[i];
      const glm::vec3 p[3] = {mesh.positions[corner.x], mesh.positions[corner.y], mesh.positions[corner.z]};
      if (!finite(p[0]) || !finite(p[1]) || !finite(p[2])) continue;
      std::vector<Vector4> polygon = {transformed(matrix, p[0]), transformed(matrix, p[1]), transformed(matrix, p[2])};
      for (const Vector4& plane : planes) polygon = clipped(polygon, plane);
      for (std::size_t k = 2; k < polygon.size(); ++k)
        if (auto t = on_screen(polygon[0], polygon[k - 1], polygon[k], frame, draw.kd.value_or(mesh.colors[i])))
          result.push_back(std::move(*t));
    }
  }
  return result;
}

// ---- Areas

using Polygon = std::vector<Point>;

// The half plane a x + b y + c >= 0.
struct HalfPlane {
  Rational a, b, c;
  Rational at(const Point& p) const { return a * p.x + b * p.y + c; }
  HalfPlane reversed() const { return {-a, -b, -c}; }
};

Polygon cut(const Polygon& polygon, const HalfPlane& half) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const Rational d_from = half.at(from), d_to = half.at(to);
    if (d_from >= 0) kept.push_back(from);
    if ((d_from > 0 && d_to < 0) || (d_from < 0 && d_to > 0)) {
      const Rational s = d_from / (d_from - d_to);
      kept.push_back({from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)});
    }
  }
  return kept.size() < 3 ? Polygon{} : kept;
}

Rational area(const Polygon& polygon) {
  Rational twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    twice += p.x * q.y - q.x * p.y;
  }
  return abs(twice) / 2;
}

std::array<HalfPlane, 3> edges_of(const ScreenTriangle& t) {
  std::array<HalfPlane, 3> edges;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const std::int64_t a = t.y[k] - t.y[next], b = t.x[next] - t.x[k];
    edges[k] = {a, b, -(a * t.x[k] + b * t.y[k])};
  }
  return edges;
}

// The intersection of half planes: the convex set that one triangle hides of another.
using HalfPlanes = std::vector<HalfPlane>;

// The parts of the pieces that lie outside the set.
std::vector<Polygon> without(const std::vector<Polygon>& pieces, const HalfPlanes& set) {
  std::vector<Polygon> outside;
  for (Polygon rest : pieces) {
    std::vector<Polygon> parts;
    for (const HalfPlane& half : set) {
      Polygon part = cut(rest, half.reversed());
      if (!part.empty() && area(part) > 0) parts.push_back(std::move(part));
      rest = cut(rest, half);
      if (rest.empty()) break;
    }
    outside.insert(outside.end(), parts.begin(), parts.end());
  }
  return outside;
}

// Whether a whole pixel lies strictly inside all edges, outside one of them, or neither.
enum class Side { inside, outside, crossing };

Side side_of(const ScreenTriangle& t, std::int64_t left, std::int64_t top) {
  bool inside = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const std::int64_t a = t.y[k] - t.y[next], b = t.x[next] - t.x[k];
    const auto at = [&](std::int64_t x, std::int64_t y) { return a * (x - t.x[k]) + b * (y - t.y[k]); };
    const auto [least, most] =
        std::minmax({at(left, top), at(left + kUnits, top), at(left, top + kUnits), at(left + kUnits, top + kUnits)});
    if (most <= 0) return Side::outside;
    inside &= least > 0;
  }
  return inside ? Side::inside : Side::crossing;
}

glm::dvec4 blended(const std::vector<std::pair<const ScreenTriangle*, Rational>>& shares, const glm::vec3& background) {
  Rational covered = 0, color[3];
  for (const auto& [triangle, share] : shares) {
    covered += share;
    for (int c = 0; c < 3; ++c) color[c] += share * Rational(triangle->color[c]);
  }
  glm::dvec4 result(0, 0, 0, static_cast<double>(covered));
  for (int c = 0; c < 3; ++c)
    result[c] = static_cast<double>(Rational(color[c] + (1 - covered) * Rational(background[c])));
  return result;
}

glm::dvec4 pixel_areas(const std::vector<const ScreenTriangle*>& touching, std::int64_t left, std::int64_t top,
                       const glm::vec3& background) {
  const Polygon box = {{left, top}, {left + kUnits, top}, {left + kUnits, top + kUnits}, {left, top + kUnits}};
  std::vector<std::pair<const ScreenTriangle*, Rational>> shares;
  for (std::size_t i = 0; i < touching.size(); ++i) {
    Polygon own = box;
    for (const HalfPlane& edge : edges_of(*touching[i])) own = cut(own, edge);
    std::vector<Polygon> visible;
    if (!own.empty()) visible.push_back(std::move(own));
    for (std::size_t j = 0; j < touching.size() && !visible.empty(); ++j) {
      if (j == i) continue;
      const Plane &mine = touching[i]->depth, &other = touching[j]->depth;
      const HalfPlane nearer{mine.zx - other.zx, mine.zy - other.zy,
                             mine.z0 - other.z0};  // the other triangle is nearer where this is >= 0
      const auto edges = edges_of(*touching[j]);
      HalfPlanes hides(edges.begin(), edges.end());
      if (nearer.a == 0 && nearer.b == 0) {
        if (nearer.c < 0 || (nearer.c == 0 && j > i)) continue;
      } else {
        hides.push_back(nearer);  // they intersect in a line, which has no area
      }
      visible = without(visible, hides);
    }
    Rational share = 0;
    for (const Polygon& piece : visible) share += area(piece);
    if (share > 0) shares.emplace_back(touching[i], share / (kUnits * kUnits));
  }
  return blended(shares, background);
}

// ---- Samples

bool covers(const ScreenTriangle& t, std::int64_t x, std::int64_t y) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const std::int64_t a = t.y[k] - t.y[next], b = t.x[next] - t.x[k];
    const std::int64_t value = a * (x - t.x[k]) + b * (y - t.y[k]);
    const bool top_left = a > 0 || (a == 0 && b > 0);
    if (value < 0 || (value == 0 && !top_left)) return false;
  }
  return true;
}

glm::dvec4 pixel_samples(const std::vector<const ScreenTriangle*>& touching, std::int64_t left, std::int64_t top,
                         const SamplePlaces& places, const glm::vec3& background) {
  std::vector<std::pair<const ScreenTriangle*, Rational>> shares;
  for (const glm::ivec2& place : places) {
    const std::int64_t x = left + place.x, y = top + place.y;
    const ScreenTriangle* nearest = nullptr;
    Rational depth;
    for (const ScreenTriangle* t : touching) {
      if (!covers(*t, x, y)) continue;
      Rational z = t->depth.zx * x + t->depth.zy * y + t->depth.z0;
      if (nearest && !(z < depth)) continue;
      nearest = t;
      depth = std::move(z);
    }
    if (nearest) shares.emplace_back(nearest, Rational(1, places.size()));
  }
  return blended(shares, background);
}

// Sets the rectangle of pixels that the triangles' bounds touch.
void bound(const std::vector<ScreenTriangle>& triangles, const Frame& frame, ExactPicture& picture) {
  const auto within = [](std::int64_t pixel, std::uint32_t side) {
    return static_cast<int>(std::clamp<std::int64_t>(pixel, 0, side));
  };
  const glm::ivec2 end(frame.width, frame.height);
  picture.low = end;
  for (const ScreenTriangle& t : triangles) {
    const auto [left, right] = std::minmax({t.x[0], t.x[1], t.x[2]});
    const auto [top, bottom] = std::minmax({t.y[0], t.y[1], t.y[2]});
    picture.low = glm::min(picture.low,
                           glm::ivec2(within(left / kUnits - 1, frame.width), within(top / kUnits - 1, frame.height)));
    picture.high = glm::max(
        picture.high, glm::ivec2(within(right / kUnits + 1, frame.width), within(bottom / kUnits + 1, frame.height)));
  }
}

template <class Pixel>
ExactPicture every_pixel(const Trace& trace, const Frame& frame, Pixel pixel) {
  const std::vector<ScreenTriangle> triangles = screen_triangles(trace, frame);
  ExactPicture picture;
  picture.elsewhere = glm::dvec4(glm::dvec3(frame.background), 0.0);
  bound(triangles, frame, picture);
  std::vector<const ScreenTriangle*> touching;
  for (std::int64_t y = picture.low.y; y < picture.high.y; ++y) {
    for (std::int64_t x = picture.low.x; x < picture.high.x; ++x) {
      touching.clear();
      for (const ScreenTriangle& t : triangles)
        if (side_of(t, x * kUnits, y * kUnits) != Side::outside) touching.push_back(&t);
      const bool one_covers = touching.size() == 1 && side_of(*touching[0], x * kUnits, y * kUnits) == Side::inside;
      if (touching.empty()) {
        picture.rgba.push_back(picture.elsewhere);
      } else if (one_covers) {
        picture.rgba.emplace_back(touching[0]->color, 1.0);
      } else {
        picture.rgba.push_back(pixel(touching, x * kUnits, y * kUnits));
      }
    }
  }
  return picture;
}

}  // namespace

ExactPicture exact_areas(const Trace& trace, const Frame& frame) {
  return every_pixel(trace, frame, [&](const auto& touching, std::int64_t left, std::int64_t top) {
    return pixel_areas(touching, left, top, frame.background);
  });
}

ExactPicture exact_samples(const Trace& trace, const Frame& frame, const SamplePlaces& places) {
  return every_pixel(trace, frame, [&](const auto& touching, std::int64_t left, std::int64_t top) {
    return pixel_samples(touching, left, top, places, frame.background);
  });
}

}  // namespace beampipe
