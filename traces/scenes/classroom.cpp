#include "traces/scenes/classroom.h"

#include <algorithm>
#include <cmath>

namespace beampipe {
namespace {

using glm::dvec3;

// Metres. The left wall, x = 0, has the windows, and the front wall, z = 0, has the blackboard.
constexpr dvec3 kRoom(8, 3, 9);
constexpr double kSill = 0.95, kLintel = 2.6;
constexpr double kWindows[][2] = {{1.0, 3.4}, {4.2, 6.6}};  // z from, to
constexpr glm::vec3 kWood(0.55f, 0.33f, 0.14f), kSteel(0.45f, 0.48f, 0.52f), kWall(0.80f, 0.76f, 0.62f);

void add_bar(MeshBuilder& mesh, const dvec3& a, const dvec3& b, double radius, double budget) {
  const int sides = std::clamp(divisions(budget, 4, 3), 3, 12);
  mesh.tube(line(a, b, std::max(1, static_cast<int>(budget / (2 * sides)))), radius, sides);
}

void add_legs(MeshBuilder& mesh, double x, double z, double top, double radius, double budget) {
  for (double sx : {-x, x}) {
    for (double sz : {-z, z}) add_bar(mesh, {sx, 0, sz}, {sx, top, sz}, radius, budget / 4);
  }
}

// A desk and the chair behind it. The middle of the desk is above `at` on the floor.
void add_desk(MeshBuilder& mesh, const ClassroomLook& look, const dvec3& at, double turn, double budget,
              Random& random) {
  const auto put = [=](const dvec3& p) {
    return at + dvec3(std::cos(turn) * p.x + std::sin(turn) * p.z, p.y, std::cos(turn) * p.z - std::sin(turn) * p.x);
  };
  mesh.place = put;
  mesh.finish = look.wood;
  mesh.color = random.vary(kWood, 0.25);
  mesh.box({-0.6, 0.70, -0.3}, {0.6, 0.74, 0.3}, divisions(0.25 * budget, 4, 1));
  mesh.finish = look.paper;
  mesh.color = random.uniform(dvec3(0.1), {0.8, 0.5, 0.5});
  mesh.box({-0.15, 0.74, -0.1}, {0.08, 0.79, 0.2});  // a book
  mesh.finish = look.steel;
  mesh.color = kSteel;
  add_legs(mesh, 0.55, 0.25, 0.70, 0.018, 0.18 * budget);

  mesh.finish = look.plastic;
  mesh.color = random.vary({0.15f, 0.35f, 0.60f}, 0.3);
  const int n = divisions(0.2 * budget, 4, 1);
  mesh.place = [=](const dvec3& p) { return put(p + dvec3(0, 0.4 * p.x * p.x, 0.65)); };  // hollow
  mesh.box({-0.2, 0.42, -0.2}, {0.2, 0.45, 0.2}, n);
  mesh.place = [=](const dvec3& p) { return put(p + dvec3(0, 0, 0.65 - 0.8 * p.x * p.x + 0.12 * (p.y - 0.4))); };
  mesh.box({-0.2, 0.62, 0.19}, {0.2, 0.90, 0.21}, n);
  mesh.place = [=](const dvec3& p) { return put(p + dvec3(0, 0, 0.65)); };
  mesh.finish = look.steel;
  mesh.color = kSteel;
  add_legs(mesh, 0.18, 0.18, 0.43, 0.013, 0.17 * budget);
  for (double x : {-0.15, 0.15}) add_bar(mesh, {x, 0.43, 0.18}, {x, 0.65, 0.21}, 0.012, 0.02 * budget);
  mesh.place = nullptr;
}

void add_blinds(MeshBuilder& blinds, const ClassroomLook& look, const double (&window)[2], double budget,
                Random& random) {
  blinds.finish = look.slats;
  const int slats = std::clamp(static_cast<int>(budget / 60), 6, 33);
  const double pitch = (kLintel - kSill) / slats;
  const int length = std::max(1, static_cast<int>(budget / (slats * 8)));
  for (int i = 0; i < slats; ++i) {
    blinds.color = random.vary({0.88f, 0.84f, 0.72f}, 0.08);
    const double y = kSill + (i + 0.5) * pitch;
    blinds.surface(length, 4, [&](double u, double v) {  // tilted, and bulging across
      const double across = v - 0.5, z = window[0] + 0.04 + u * (window[1] - window[0] - 0.08);
      return dvec3(0.06 + 0.8 * pitch * across, y - 0.55 * pitch * across + 0.3 * pitch * (0.25 - across * across), z);
    });
  }
}

void add_strings(MeshBuilder& strings, const ClassroomLook& look, const double (&window)[2], double budget) {
  strings.finish = look.cord;
  constexpr double kThread = 0.004;  // radius
  const double width = window[1] - window[0];
  const int count = budget < 300 ? 2 : 4;
  const int segments = std::max(4, static_cast<int>(budget / count / (3 * 6)));
  for (int i = 0; i < count; ++i) {  // the first is the one to pull, which hangs below the sill; others end at the sill
    const double z = window[0] + width * (i == 0 ? 0.92 : 0.3 * i - 0.1), end = i == 0 ? 0.35 : kSill;
    strings.color = i == 0 ? glm::vec3(0.85f, 0.20f, 0.10f) : glm::vec3(0.95f, 0.93f, 0.85f);
    strings.braid(line({0.11, kLintel, z}, {0.11, end, z}, segments), kThread, segments / 8.0, 3);
  }
}

// Floor and walls, which show their fronts inside.
void add_room(MeshBuilder& room, const ClassroomLook& look, double budget, Random& random) {
  room.finish = look.floor;
  const auto [w, h, d] = std::tuple(kRoom.x, kRoom.y, kRoom.z);
  const int tiles = divisions(0.8 * budget, 2, 3);
  for (int i = 0; i < tiles; ++i) {
    for (int k = 0; k < tiles; ++k) {
      room.color = random.vary((i + k) % 2 == 0 ? glm::vec3(0.50f, 0.42f, 0.33f) : glm::vec3(0.36f, 0.29f, 0.22f), 0.1);
      const double x0 = w * i / tiles, x1 = w * (i + 1) / tiles, z0 = d * k / tiles, z1 = d * (k + 1) / tiles;
      const dvec3 corners[] = {{x0, 0, z1}, {x1, 0, z1}, {x1, 0, z0}, {x0, 0, z0}};
      const int first = look.is_plain() ? 0 : (i + k) % 2;  // parquet: the grain of neighbours runs across
      room.quad(corners[first], corners[first + 1], corners[(first + 2) % 4], corners[(first + 3) % 4]);
    }
  }
  room.finish = look.plaster;
  room.color = kWall;
  room.quad({0, 0, 0}, {w, 0, 0}, {w, h, 0}, {0, h, 0});
  const auto wall = [&](double y0, double y1, double z0, double z1) {
    room.quad({0, y0, z1}, {0, y0, z0}, {0, y1, z0}, {0, y1, z1});
  };
  wall(0, kSill, 0, d);
  wall(kLintel, h, 0, d);
  double z = 0;
  for (const auto& window : kWindows) {
    wall(kSill, kLintel, z, window[0]);
    z = window[1];
  }
  wall(kSill, kLintel, z, d);
}

// Window frames and the blackboard.
void add_fittings(MeshBuilder& fittings, const ClassroomLook& look) {
  fittings.finish = look.paint;
  fittings.color = {0.90f, 0.88f, 0.84f};
  for (const auto& window : kWindows) {
    const double middle = (window[0] + window[1]) / 2;
    for (double at : {window[0], middle, window[1]}) fittings.box({-0.08, kSill, at - 0.03}, {0.0, kLintel, at + 0.03});
    for (double y : {kSill, kLintel}) fittings.box({-0.08, y - 0.04, window[0]}, {0.03, y + 0.04, window[1]});
  }
  fittings.finish = look.wood;
  fittings.color = kWood;
  fittings.box({2.0, 0.85, 0}, {6.4, 2.25, 0.04});
  fittings.finish = look.board;
  fittings.color = look.is_plain() ? glm::vec3(0.04f, 0.16f, 0.09f) : glm::vec3(1.0f);  // the texture has the colour
  fittings.box({2.1, 0.95, 0.04}, {6.3, 2.15, 0.05});
}

void add_teacher_corner(MeshBuilder& mesh, const ClassroomLook& look, double budget, Random& random) {
  mesh.finish = look.wood;
  mesh.color = random.vary(kWood, 0.1);
  mesh.box({1.2, 0.0, 1.0}, {2.9, 0.78, 1.7}, divisions(0.2 * budget, 12, 1));
  mesh.finish = look.globe;
  mesh.color = look.is_plain() ? glm::vec3(0.10f, 0.35f, 0.70f) : glm::vec3(1.0f);
  const int rings = divisions(0.5 * budget, 4, 4);
  mesh.sphere({1.6, 1.06, 1.35}, 0.22, 2 * rings, rings);
  mesh.finish = look.steel;
  mesh.color = kSteel;
  add_bar(mesh, {1.6, 0.78, 1.35}, {1.6, 0.86, 1.35}, 0.05, 0.05 * budget);
}

// The view outside and the ceiling, which the light inside does not reach: they are unlit in the classroom.
std::vector<Mesh> unlit_parts(const ClassroomLook& look) {
  MeshBuilder parts("outside and ceiling");
  parts.finish = look.outside;
  parts.color = {1.0f, 1.0f, 0.95f};
  parts.quad({-3, 0.9, 14}, {-3, 0.9, -10}, {-3, 8, -10}, {-3, 8, 14});
  parts.color = {0.45f, 0.75f, 0.35f};
  parts.quad({-3, -4, 14}, {-3, -4, -10}, {-3, 0.9, -10}, {-3, 0.9, 14});
  parts.finish = look.ceiling;
  parts.color = look.is_plain() ? glm::vec3(0.55f, 0.54f, 0.50f) : glm::vec3(0.9f);
  parts.quad({0, kRoom.y, 0}, {kRoom.x, kRoom.y, 0}, {kRoom.x, kRoom.y, kRoom.z}, {0, kRoom.y, kRoom.z});
  return {parts.take()};
}

std::vector<Mesh> build(const ClassroomLook& look, double budget, Random& random) {
  MeshBuilder room("room"), fittings("fittings"), desks("desks"), blinds("blinds"), strings("strings");
  add_room(room, look, 0.1 * budget, random);
  add_fittings(fittings, look);
  add_teacher_corner(desks, look, 0.05 * budget, random);
  const int count = std::clamp(static_cast<int>(budget / 2000), 2, 12);
  for (int i = 0; i < count; ++i) {
    const dvec3 at(2.3 + 1.75 * (i % 3), 0, 2.9 + 1.5 * (i / 3));
    add_desk(desks, look, at, random.uniform(-0.1, 0.1), 0.4 * budget / count, random);
  }
  for (const auto& window : kWindows) {
    add_blinds(blinds, look, window, 0.075 * budget, random);
    add_strings(strings, look, window, 0.15 * budget);
  }
  std::vector<Mesh> meshes = unlit_parts(look);
  for (MeshBuilder* part : {&room, &fittings, &desks, &blinds, &strings}) meshes.push_back(part->take());
  return meshes;
}

}  // namespace

Trace classroom_trace(const SceneOptions& options, std::uint32_t default_triangles, const ClassroomLook& look) {
  const Camera camera{
      .eye = {6.9, 1.75, 8.3}, .target = {1.9, 1.25, 2.6}, .up = {0, 1, 0}, .fovy_deg = 42, .near = 0.1, .far = 40};
  const auto build_look = [&](double budget, Random& random) { return build(look, budget, random); };
  return one_frame(options, camera, build_to_budget(options, default_triangles, build_look), Shoulder::right);
}

Trace make_classroom(const SceneOptions& options) {
  Trace trace = classroom_trace(options, 100000, {});
  trace.frames[0].draws[0].shading = Shading::unlit;
  return trace;
}

}  // namespace beampipe
