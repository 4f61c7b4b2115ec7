#include "traces/scenes/boat.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace beampipe {
namespace {

using glm::dvec3;

// Metres; the bow points to +x, the water is at y = 0.
struct Mast {
  double x, height;
};
constexpr Mast kMasts[] = {{3.2, 11.4}, {-2.2, 12.8}};
constexpr glm::vec3 kSpar(0.62f, 0.42f, 0.18f), kRope(0.75f, 0.66f, 0.45f), kTar(0.10f, 0.08f, 0.07f);

double half_beam(double u) { return 2.0 * std::pow(std::max(0.0, 4 * u * (1 - u)), u > 0.5 ? 0.75 : 0.35); }
double rail_height(double u) { return 1.2 + 1.0 * (u - 0.4) * (u - 0.4) * 4; }

// u goes from stern to bow, v from the port rail (-1) under the keel to the starboard rail (1).
dvec3 hull_point(double u, double v) {
  const double rail = rail_height(u), side = std::pow(std::abs(v), 0.55), y = -0.9 + (rail + 0.9) * v * v;
  return {-8 + 16 * u + 0.8 * (y - 0.5) * (u > 0.5 ? u - 0.5 : 0), y, half_beam(u) * std::copysign(side, v)};
}

dvec3 at_rail(double x, double side) {
  const double u = (x + 8) / 16;
  return {x, rail_height(u) + 0.05, side * half_beam(u)};
}

void add_hull(MeshBuilder& hull, const BoatLook& look, double budget) {
  hull.finish = look.hull;
  const auto band = [&](double v0, double v1, const glm::vec3& color, double share) {
    hull.color = color;
    const int n = divisions(share * budget, 8, 2);
    hull.surface(4 * n, n, [&](double u, double v) { return hull_point(u, v0 + v * (v1 - v0)); });
  };
  const glm::vec3 paint(0.06f, 0.12f, 0.30f), stripe(0.90f, 0.85f, 0.70f);
  band(-1.0, -0.9, stripe, 0.1);
  band(-0.9, 0.0, paint, 0.25);
  band(0.0, 0.9, paint, 0.25);
  band(0.9, 1.0, stripe, 0.1);
  hull.finish = look.deck;
  hull.color = {0.50f, 0.34f, 0.18f};
  const int n = divisions(0.2 * budget, 4, 2);
  hull.surface(2 * n, n, [&](double u, double v) {
    return dvec3(hull_point(u, 1).x, rail_height(u) - 0.25, half_beam(u) * (2 * v - 1) * -0.97);
  });
}

void add_houses(MeshBuilder& houses, const BoatLook& look) {
  houses.finish = look.house;
  houses.color = {0.80f, 0.78f, 0.72f};
  houses.box({-6.0, 1.0, -0.9}, {-3.4, 2.1, 0.9});
  houses.box({-0.6, 1.0, -0.8}, {1.4, 1.8, 0.8});
}

void add_spar(MeshBuilder& spars, const dvec3& a, const dvec3& b, double radius, double budget) {
  const int sides = budget < 20 ? 3 : budget < 60 ? 4 : 8;
  spars.tube(line(a, b, std::max(1, static_cast<int>(budget / (2 * sides)))), radius, 0.6 * radius, sides);
}

void add_spars(MeshBuilder& spars, const BoatLook& look, double budget) {
  spars.finish = look.spar;
  spars.color = kSpar;
  for (const Mast& mast : kMasts) add_spar(spars, {mast.x, 0.8, 0}, {mast.x, mast.height, 0}, 0.17, 0.2 * budget);
  add_spar(spars, {7.2, 2.3, 0}, {11.2, 3.4, 0}, 0.14, 0.1 * budget);
  for (double y : {5.2, 7.6, 9.6}) {  // yards across the foremast
    const double half = 3.4 - 0.22 * y;
    for (double side : {-1.0, 1.0}) add_spar(spars, {3.35, y, 0}, {3.7, y, half * side}, 0.08, 0.05 * budget);
  }
  add_spar(spars, {-2.4, 2.7, 0}, {-9.0, 3.1, 0}, 0.11, 0.1 * budget);
  add_spar(spars, {-2.4, 8.2, 0}, {-7.0, 10.2, 0}, 0.09, 0.1 * budget);
}

void add_sail(MeshBuilder& sail, const BoatLook& look, double budget) {
  sail.finish = look.sail;
  sail.color = {0.80f, 0.62f, 0.42f};
  const int n = divisions(budget, 2, 2);
  sail.surface(n, n, [](double u, double v) {  // between boom and gaff, filled by the wind
    const dvec3 low = dvec3(-2.6, 2.9, 0) + u * dvec3(-6.1, 0.35, 0),
                high = dvec3(-2.6, 8.0, 0) + u * dvec3(-4.2, 1.8, 0);
    return low + v * (high - low) - dvec3(0, 0, 2.4 * u * (1 - u) * 4 * v * (1 - v));
  });
}

void add_shrouds(MeshBuilder& rig, const BoatLook& look, double budget) {
  rig.finish = look.line;
  constexpr int kShrouds = 5;
  const int ratlines = std::clamp(static_cast<int>(0.6 * budget / (4 * 26)), 1, 60);
  const int segments = std::max(1, static_cast<int>(0.4 * budget / (4 * kShrouds * 6)));
  for (const Mast& mast : kMasts) {
    for (double side : {-1.0, 1.0}) {
      const dvec3 top(mast.x, 0.8 * mast.height, 0.12 * side);
      const auto foot = [&](int i) { return at_rail(mast.x - 1.5 + 0.55 * i, side); };
      rig.color = kTar;
      for (int i = 0; i < kShrouds; ++i) rig.tube(line(foot(i), top, segments), 0.018, 3);
      rig.color = kRope;
      for (int k = 1; k <= ratlines; ++k) {
        const double t = 0.95 * k / (ratlines + 1);
        Path path;
        for (int i = 0; i < kShrouds; ++i) path.push_back(foot(i) + t * (top - foot(i)));
        rig.tube(path, 0.009, 3);
      }
    }
  }
}

// Single lines: stays, lifts, braces, and the lifelines along the rails.
void add_lines(MeshBuilder& rig, const BoatLook& look, double budget) {
  rig.finish = look.line;
  struct Line {
    dvec3 a, b;
    double sag;
  };
  std::vector<Line> lines = {{{3.2, 11.2, 0}, {11, 3.3, 0}, 0.1},    {{3.2, 9.2, 0}, {9.4, 2.9, 0}, 0.1},
                             {{3.2, 7.4, 0}, {8.0, 2.6, 0}, 0.1},    {{-2.2, 12.6, 0}, {3.2, 11.2, 0}, 0.3},
                             {{-2.2, 9.5, 0}, {3.2, 3.0, 0}, 0.05},  {{-2.2, 12.6, 0}, {-7.0, 10.2, 0}, 0.1},
                             {{-2.2, 12.6, 0}, {-9.0, 3.1, 0}, 0.1}, {{-7.0, 10.2, 0}, {-7.8, 2.2, 0.6}, 0.1}};
  const double step = budget < 800 ? 4.0 : 1.0;  // between the lifelines' posts
  for (double side : {-1.0, 1.0}) {
    for (double y : {5.2, 7.6, 9.6}) {
      const dvec3 end(3.7, y, (3.4 - 0.22 * y) * side);
      lines.push_back({end, {3.2, y + 1.7, 0}, 0.03});
      lines.push_back({end, {-2.2, y - 1.0, 0}, 0.15});
    }
    for (double x = -7; x < 6; x += step) {
      lines.push_back({at_rail(x, side), at_rail(x, side) + dvec3(0, 0.7, 0), 0});
      for (double y : {0.35, 0.7})
        lines.push_back({at_rail(x, side) + dvec3(0, y, 0), at_rail(x + step, side) + dvec3(0, y, 0), 0.03});
    }
  }
  rig.color = kTar;
  const int segments = std::max(1, static_cast<int>(budget / static_cast<double>(lines.size()) / 6));
  for (const Line& l : lines) rig.tube(line(l.a, l.b, segments, l.sag), 0.014, 3);
}

void add_braids(MeshBuilder& ropes, const BoatLook& look, double budget) {
  ropes.finish = look.rope;
  const Path ends[] = {{{3.05, 10.8, 0.2}, {2.7, 1.6, 0.5}},  {{3.05, 9.0, -0.2}, {2.8, 1.6, -0.6}},
                       {{-2.4, 12.0, 0.2}, {-2.9, 1.6, 0.6}}, {{-2.4, 8.0, 0.25}, {-1.2, 1.7, 0.9}},
                       {{-8.6, 3.0, 0.0}, {-7.4, 1.9, 0.8}},  {{7.9, 2.4, 0.3}, {14.5, 0.6, 6.0}},
                       {{-7.6, 2.0, 1.0}, {-13.5, 0.6, 5.5}}, {{11.1, 3.4, 0}, {8.1, 0.9, 0}}};
  const std::size_t count = budget < 1000 ? std::size(ends) / 2 : std::size(ends);
  const int segments = std::max(2, static_cast<int>(budget / static_cast<double>(count) / 18));
  for (const Path& path : std::span(ends).last(count)) {
    ropes.color = std::abs(path[0].x) > 7 ? glm::vec3(0.80f, 0.45f, 0.12f) : kRope;
    ropes.braid(line(path[0], path[1], segments, path[0].y < 3 ? 0.5 : 0.0), 0.022, segments / 7.0, 3);
  }
}

std::vector<Mesh> build(const BoatLook& look, double budget, Random& random) {
  MeshBuilder sea("sea"), hull("hull"), houses("deckhouses"), spars("spars"), sail("sail"), rig("rigging"),
      ropes("ropes");
  sea.finish = look.sea;
  sea.texture_place = [&](const dvec3& p) { return glm::dvec2(p.x, p.z) / std::max(look.sea.texture_size, 1.0); };
  sea.color = {0.05f, 0.25f, 0.32f};
  const double phase = random.uniform(0, 6.28);
  const int n = divisions(0.12 * budget, 2, 3);
  sea.surface(n, n, [&](double u, double v) {  // rows closer together near the viewer
    const double z = 16 - 116 * v * v, x = (2 * u - 1) * (45 - 1.1 * z);
    return dvec3(x, 0.10 * std::sin(1.1 * x + 0.4 * z + phase) + 0.07 * std::sin(0.6 * x - 1.7 * z), z);
  });
  add_hull(hull, look, 0.16 * budget);
  add_houses(houses, look);
  add_spars(spars, look, 0.08 * budget);
  add_sail(sail, look, 0.06 * budget);
  add_shrouds(rig, look, 0.22 * budget);
  add_lines(rig, look, 0.12 * budget);
  add_braids(ropes, look, 0.24 * budget);
  return {sea.take(), hull.take(), houses.take(), spars.take(), sail.take(), rig.take(), ropes.take()};
}

}  // namespace

Trace boat_trace(const SceneOptions& options, std::uint32_t default_triangles, const BoatLook& look) {
  const Camera camera{
      .eye = {9, 4.2, 19.5}, .target = {0.6, 5.6, 0}, .up = {0, 1, 0}, .fovy_deg = 36, .near = 1, .far = 200};
  const auto build_look = [&](double budget, Random& random) { return build(look, budget, random); };
  return one_frame(options, camera, build_to_budget(options, default_triangles, build_look));
}

Trace make_boat(const SceneOptions& options) { return boat_trace(options, 60000, {}); }

}  // namespace beampipe
