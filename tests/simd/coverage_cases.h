// Triangles for the coverage tests, and their coverage by polygon clipping in double precision.
#pragma once

#include "simd/coverage.h"
#include "simd/depth_range.h"
#include "tests/simd/clipped_polygon.h"
#include "tests/simd/random.h"

namespace beampipe {

struct Corner {
  std::int64_t x, y;  // 1/256 px from the pixel's upper left corner
};

struct Triangle {
  Corner p[3];
  float z[3] = {-0.5f, -0.5f, -0.5f};

  std::int64_t area2() const {  // 2 x 65536 x the area in pixels; where positive, the inside is at E >= 0
    return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
  }
};

inline Triangle oriented(Triangle t) {
  if (t.area2() < 0) {
    std::swap(t.p[1], t.p[2]);
    std::swap(t.z[1], t.z[2]);
  }
  return t;
}

struct Slopes {
  double z, dzdu, dzdv;  // at the pixel's centre, per pixel
};

inline Slopes depth_slopes(const Triangle& t) {
  const double qx = double(t.p[1].x - t.p[0].x) / 256, qy = double(t.p[1].y - t.p[0].y) / 256;
  const double rx = double(t.p[2].x - t.p[0].x) / 256, ry = double(t.p[2].y - t.p[0].y) / 256;
  const double qz = double(t.z[1]) - t.z[0], rz = double(t.z[2]) - t.z[0], area = qx * ry - rx * qy;
  const double dzdu = (qz * ry - rz * qy) / area, dzdv = (rz * qx - qz * rx) / area;
  return {t.z[0] + dzdu * (0.5 - double(t.p[0].x) / 256) + dzdv * (0.5 - double(t.p[0].y) / 256), dzdu, dzdv};
}

// The triangle as seen from pixel (pixel_x, pixel_y). Its corners are given in 1/256 px from the corner of pixel (0,
// 0).
inline TriangleInPixelOf<std::int64_t> in_pixel(const Triangle& t, std::int64_t pixel_x = 0, std::int64_t pixel_y = 0) {
  TriangleInPixelOf<std::int64_t> seen;
  for (int k = 0; k < 3; ++k) seen.x[k] = t.p[k].x - 256 * pixel_x, seen.y[k] = t.p[k].y - 256 * pixel_y;
  return seen;
}

inline TriangleInPixel kernel_input(const Triangle& t) {
  TriangleInPixel seen;
  for (int k = 0; k < 3; ++k) {
    seen.x[k] = static_cast<std::int32_t>(t.p[k].x);
    seen.y[k] = static_cast<std::int32_t>(t.p[k].y);
  }
  return seen;
}

inline Coverage<float> coverage_on_float(const Triangle& t, std::int64_t pixel_x = 0, std::int64_t pixel_y = 0) {
  return coverage_formula<std::int64_t, float>(in_pixel(t, pixel_x, pixel_y));
}

inline DepthRangeInput<float> depth_range_input(const Triangle& t) {
  DepthRangeInput<float> in;
  for (int k = 0; k < 3; ++k) {
    const Corner from = t.p[k], to = t.p[(k + 1) % 3];
    const std::int64_t a = from.y - to.y, b = to.x - from.x;
    in.u[k] = static_cast<float>(from.x) / 256, in.v[k] = static_cast<float>(from.y) / 256;
    for (int i = 0; i < 4; ++i)
      in.corner[k][i] = static_cast<float>(a * (256 * (i & 1) - from.x) + b * (256 * (i >> 1) - from.y)) / 65536;
    in.vertex_z[k] = t.z[k];
  }
  const Slopes slopes = depth_slopes(t);
  in.z = static_cast<float>(slopes.z);
  in.dzdu = static_cast<float>(slopes.dzdu), in.dzdv = static_cast<float>(slopes.dzdv);
  return in;
}

// By polygon clipping, which has nothing in common with the formula's sums over edges.
struct Point {
  double u, v;
};

inline std::vector<Point> clipped_to_pixel(const Triangle& t) {
  std::vector<Point> polygon;
  for (const Corner& corner : t.p) polygon.push_back({double(corner.x) / 256, double(corner.y) / 256});
  for (int side = 0; side < 4; ++side)
    polygon = clipped_polygon(
        polygon, [&](const Point& p) { return side == 0   ? p.u
                                              : side == 1 ? 1 - p.u
                                              : side == 2 ? p.v
                                                          : 1 - p.v; },
        [](const Point& from, const Point& to, double part) {
          return Point{from.u + part * (to.u - from.u), from.v + part * (to.v - from.v)};
        });
  return polygon;
}

struct ExactCoverage {
  double area = 0, centroid_u = 0, centroid_v = 0;
  double z_min = 2, z_max = -2;
};

inline ExactCoverage exact_coverage(const Triangle& t) {
  const std::vector<Point> polygon = clipped_to_pixel(t);
  const Slopes slopes = depth_slopes(t);
  ExactCoverage exact;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const double cross = p.u * q.v - q.u * p.v;
    exact.area += cross / 2;
    exact.centroid_u += (p.u + q.u) * cross / 6;
    exact.centroid_v += (p.v + q.v) * cross / 6;
    const double z = slopes.z + slopes.dzdu * (p.u - 0.5) + slopes.dzdv * (p.v - 0.5);
    exact.z_min = std::min(exact.z_min, z);
    exact.z_max = std::max(exact.z_max, z);
  }
  exact.centroid_u /= exact.area;
  exact.centroid_v /= exact.area;
  return exact;
}

constexpr std::int64_t kLimit = 1 << 23;  // the guard band

// Every kind of triangle that reaches the kernel: small, large, giant, slivers, with vertices on pixel corners.
inline Triangle random_triangle(Random& random) {
  constexpr std::int64_t kSpecial[] = {-kLimit, -512, -257, -256, -1, 0, 1, 128, 255, 256, 257, 512, kLimit};
  const auto coordinate = [&](std::int64_t kind) {
    switch (kind) {
      case 0:
        return random.integer(0, 256);
      case 1:
        return random.integer(-300, 556);
      case 2:
        return random.integer(-5000, 5000);
      case 3:
        return random.integer(-kLimit, kLimit);
      default:
        return random.pick(kSpecial);
    }
  };
  Triangle t;
  do {
    const std::int64_t kind = random.integer(0, 4);
    const bool mixed = random.one_in(3), sliver = random.one_in(4);
    for (Corner& corner : t.p) {
      const std::int64_t own = mixed ? random.integer(0, 4) : kind;
      corner = {coordinate(own), coordinate(own)};
    }
    if (sliver) {  // the third vertex lies close to the line through the others
      const double s = random.real(-0.2, 1.2);
      const auto near_line = [&](std::int64_t from, std::int64_t to) {
        const auto at = from + static_cast<std::int64_t>(s * static_cast<double>(to - from)) + random.integer(-1, 1);
        return std::clamp(at, -kLimit, kLimit);
      };
      t.p[2] = {near_line(t.p[0].x, t.p[1].x), near_line(t.p[0].y, t.p[1].y)};
    }
  } while (t.area2() == 0);
  for (float& z : t.z) z = random.one_in(8) ? -0.25f : random.real32(-1, 0);
  return oriented(t);
}

}  // namespace beampipe
