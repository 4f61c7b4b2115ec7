// Makes setup triangles from screen positions, without vertex_setup.
#pragma once

#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"
#include "tests/simd/random.h"

namespace beampipe {

struct ScreenPoint {
  std::int32_t x, y;  // 1/256 px
  float z = -0.5f;
};

inline std::int64_t twice_area(const ScreenPoint& p, const ScreenPoint& q, const ScreenPoint& r) {
  return std::int64_t{q.x - p.x} * (r.y - p.y) - std::int64_t{r.x - p.x} * (q.y - p.y);
}

// The vertices may be in either order. Like vertex_setup, adds nothing for a triangle of zero area.
inline void add_triangle(SetupTriangles& triangles, const ScreenPoint& p, ScreenPoint q, ScreenPoint r) {
  const std::int64_t area2 = twice_area(p, q, r);
  if (area2 == 0) return;
  if (area2 < 0) std::swap(q, r);
  const double qx = (q.x - p.x) / 256.0, qy = (q.y - p.y) / 256.0, qz = double(q.z) - p.z;
  const double rx = (r.x - p.x) / 256.0, ry = (r.y - p.y) / 256.0, rz = double(r.z) - p.z;
  const double area = qx * ry - rx * qy;
  triangles.triangles.push_back(
      {{p.x, q.x, r.x},
       {p.y, q.y, r.y},
       {p.z, q.z, r.z},
       {p.z, (qz * ry - rz * qy) / area, (rz * qx - qz * rx) / area, p.x / 256.0, p.y / 256.0},
       area2 < 0});
  triangles.attributes.push_back({glm::vec3(1.0f), glm::vec3(0.0f), false});
}

// Is the sample at (x, y), in 1 / (256 units) px, in the triangle? One on an edge counts as if it lay a little further
// to the right, and even less further down. Then no sample lies on any edge.
inline bool covers(const SetupTriangle& t, std::int64_t x, std::int64_t y, std::int64_t units = 1) {
  for (int k = 0; k < 3; ++k) {
    const std::int64_t px = t.x[k], py = t.y[k], qx = t.x[(k + 1) % 3], qy = t.y[(k + 1) % 3];
    const std::int64_t value = (qx - px) * (y - units * py) - (x - units * px) * (qy - py);
    if (std::tuple(value, py - qy, qx - px) < std::tuple(0, 0, 0)) return false;
  }
  return true;
}

struct ScreenTriangle {
  ScreenPoint p, q, r;
};

// Upright edges through the pixels of rows -30 to 30, which contain the tiles of all tests.
inline ScreenTriangle left_of(std::int32_t x, float z) { return {{x, -9'000, z}, {x, 9'000, z}, {-9'000, 0, z}}; }
inline ScreenTriangle right_of(std::int32_t x, float z) { return {{x, -9'000, z}, {x, 9'000, z}, {9'000, 0, z}}; }
inline ScreenTriangle everywhere(float z) { return {{-9'000, -9'000, z}, {20'000, -9'000, z}, {-9'000, 20'000, z}}; }

inline void add_triangle(SetupTriangles& triangles, const ScreenTriangle& t) { add_triangle(triangles, t.p, t.q, t.r); }

inline SetupTriangles triangles_of(std::initializer_list<ScreenTriangle> list) {
  SetupTriangles triangles;
  for (const ScreenTriangle& each : list) add_triangle(triangles, each);
  return triangles;
}

inline TriangleList all_of(const SetupTriangles& triangles) {
  TriangleList list;
  for (std::uint32_t i = 0; i < triangles.triangles.size(); ++i) list.push_back(i);
  return list;
}

// Points on the border of a square around the hub are connected to it, at 4 x `per_side` regular or random angles.
inline SetupTriangles fan_around(const ScreenPoint& hub, std::int32_t reach, std::int32_t per_side,
                                 Random* random = nullptr) {
  std::vector<ScreenPoint> rim;
  const auto at = [&](std::int64_t side, std::int64_t t) {  // t: 0 .. 2 reach along the side
    const auto s = static_cast<std::int32_t>(t);
    switch (side) {
      case 0:
        return ScreenPoint{hub.x - reach + s, hub.y - reach, hub.z};
      case 1:
        return ScreenPoint{hub.x + reach, hub.y - reach + s, hub.z};
      case 2:
        return ScreenPoint{hub.x + reach - s, hub.y + reach, hub.z};
      default:
        return ScreenPoint{hub.x - reach, hub.y + reach - s, hub.z};
    }
  };
  for (std::int64_t side = 0; side < 4; ++side)
    for (std::int64_t i = 0; i < per_side; ++i) {
      const std::int64_t from = 2 * std::int64_t{reach} * i / per_side,
                         to = 2 * std::int64_t{reach} * (i + 1) / per_side;
      rim.push_back(at(side, i > 0 && random ? random->integer(from, to - 1) : from));
    }
  SetupTriangles fan;
  for (std::size_t i = 0; i < rim.size(); ++i) add_triangle(fan, hub, rim[i], rim[(i + 1) % rim.size()]);
  return fan;
}

// Triangles of all sizes around a tile of up to 12 pixels. Many vertices lie on pixel borders or on sample positions.
inline SetupTriangles random_triangles(Random& random, int count) {
  const auto coordinate = [&](std::int64_t kind) {
    switch (kind) {
      case 0:
        return random.int32(0, 12) * 256 + random.int32(-1, 1);
      case 1:
        return random.int32(-16, 13 * 16) * 16;
      case 2:
        return random.int32(-800, 13 * 256);
      default:
        return random.int32(-(1 << 23), 1 << 23);
    }
  };
  SetupTriangles triangles;
  while (triangles.triangles.size() < static_cast<std::size_t>(count)) {
    ScreenPoint p[3];
    const std::int64_t kind = random.integer(0, 3);
    const bool mixed = random.one_in(3), small = random.one_in(3);
    for (ScreenPoint& point : p) {
      const std::int64_t own = mixed ? random.integer(0, 3) : kind;
      point = {coordinate(own), coordinate(own), random.real32(-1, 0)};
    }
    if (small)
      for (int k = 1; k < 3; ++k) p[k].x = p[0].x + random.int32(-200, 200), p[k].y = p[0].y + random.int32(-200, 200);
    for (ScreenPoint& point : p)
      point.x = std::clamp(point.x, -(1 << 23), 1 << 23), point.y = std::clamp(point.y, -(1 << 23), 1 << 23);
    add_triangle(triangles, p[0], p[1], p[2]);
  }
  return triangles;
}

}  // namespace beampipe
