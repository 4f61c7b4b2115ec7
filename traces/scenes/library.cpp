#include <algorithm>
#include <cmath>

#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3;

// Metres. Shelves stand along both side walls and the back wall, which is z = 0.
constexpr double kLibraryWidth = 6, kLibraryDepth = 9, kLibraryHeight = 3.2, kShelfDepth = 0.3, kShelfHeight = 2.8,
                 kSideLength = 5.4;
constexpr glm::vec3 kShelfWood(0.38f, 0.22f, 0.11f);

// Puts what stands at z = 0, with its back towards -z, along one of the walls.
std::function<dvec3(const dvec3&)> along_wall(int wall) {
  if (wall == 0) return [](const dvec3& p) { return dvec3(p.x - kLibraryWidth / 2, p.y, p.z); };
  // Shelves of the side walls begin where those of the back wall end.
  if (wall == 1)
    return [](const dvec3& p) { return dvec3(p.z - kLibraryWidth / 2, p.y, kShelfDepth + kSideLength - p.x); };
  return [](const dvec3& p) { return dvec3(kLibraryWidth / 2 - p.z, p.y, kShelfDepth + p.x); };
}

// Books stand side by side; a few lean, and now and then there is a gap. `width`: of a typical book.
void add_books(MeshBuilder& books, double length, double bottom, double space, double width, Random& random) {
  for (double x = 0.02; x < length - 2 * width;) {
    const double thick = width * random.uniform(0.5, 1.4), high = space * random.uniform(0.55, 0.92);
    const double deep = kShelfDepth * random.uniform(0.6, 0.9);
    if (random.uniform() < 0.06) x += thick;
    books.color = random.uniform({0.08, 0.05, 0.04}, {0.7, 0.5, 0.45});
    const double slope = random.uniform() < 0.08 ? 0.15 : 0;
    const auto place = books.place;
    books.place = [&](const dvec3& p) { return place(dvec3(p.x + slope * (p.y - bottom), p.y, p.z)); };
    books.box({x, bottom, 0.02}, {x + thick, bottom + high, deep});
    books.place = place;
    x += thick + slope * high + 0.001;
  }
}

// `boards`: above each other; `field`: the distance of uprights, about; `width`: as above.
struct Shelves {
  int boards;
  double field, width;
};

void add_shelves(MeshBuilder& wood, MeshBuilder& books, int wall, double length, const Shelves& shelves,
                 Random& random) {
  const int uprights = static_cast<int>(length / shelves.field);
  const double pitch = kShelfHeight / shelves.boards;
  wood.place = books.place = along_wall(wall);
  wood.color = random.vary(kShelfWood, 0.1);
  for (int i = 0; i <= uprights; ++i) {
    const double x = length * i / uprights;
    wood.box({x - 0.015, 0, 0}, {x + 0.015, kShelfHeight, kShelfDepth});
  }
  for (int k = 0; k <= shelves.boards; ++k)
    for (int i = 0; i < uprights; ++i) {
      const double from = length * i / uprights + 0.015, to = length * (i + 1) / uprights - 0.015, y = k * pitch;
      wood.box({from, y, 0}, {to, y + 0.025, kShelfDepth});
      if (k == shelves.boards) continue;
      const auto place = along_wall(wall);
      books.place = [=](const dvec3& p) { return place(dvec3(p.x + from, p.y, p.z)); };
      add_books(books, to - from, y + 0.025, pitch - 0.025, shelves.width, random);
    }
  wood.place = books.place = nullptr;
}

void add_ladder(MeshBuilder& wood, Random& random) {
  wood.color = random.vary({0.55f, 0.40f, 0.20f}, 0.1);
  const auto at = [](double x, double t) { return dvec3(x, 2.7 * t, 1.3 - 0.9 * t); };
  for (const double x : {0.9, 1.35}) wood.tube(line(at(x, 0), at(x, 1)), 0.02, 6);
  for (int i = 1; i < 10; ++i) wood.tube(line(at(0.9, i / 10.0), at(1.35, i / 10.0)), 0.012, 5);
}

void add_table(MeshBuilder& wood, MeshBuilder& lamps, double z, int rings) {
  wood.color = kShelfWood;
  wood.box({-1.1, 0.74, z - 0.4}, {1.1, 0.78, z + 0.4});
  for (const double x : {-1.0, 1.0})
    for (const double side : {-0.33, 0.33}) wood.tube(line({x, 0, z + side}, {x, 0.74, z + side}), 0.03, 6);
  lamps.color = {0.65f, 0.50f, 0.18f};
  lamps.tube(line({0.5, 0.78, z}, {0.5, 1.1, z}), 0.012, 6);
  lamps.color = {0.10f, 0.42f, 0.22f};
  lamps.sphere({0.5, 1.15, z}, 0.11, 2 * rings, rings);
}

std::vector<Mesh> library_meshes(double budget, Random& random) {
  MeshBuilder ceiling("ceiling"), room("room"), wood("wood"), books("books"), lamps("lamps");
  room.color = {0.42f, 0.36f, 0.30f};
  room.quad({-3, 0, kLibraryDepth}, {3, 0, kLibraryDepth}, {3, 0, 0}, {-3, 0, 0});
  room.color = {0.66f, 0.62f, 0.54f};
  room.quad({-3, 0, 0}, {3, 0, 0}, {3, kLibraryHeight, 0}, {-3, kLibraryHeight, 0});
  room.quad({-3, 0, kLibraryDepth}, {-3, 0, 0}, {-3, kLibraryHeight, 0}, {-3, kLibraryHeight, kLibraryDepth});
  room.quad({3, 0, 0}, {3, 0, kLibraryDepth}, {3, kLibraryHeight, kLibraryDepth}, {3, kLibraryHeight, 0});
  ceiling.color = {0.40f, 0.39f, 0.36f};
  ceiling.quad({-3, kLibraryHeight, 0}, {3, kLibraryHeight, 0}, {3, kLibraryHeight, kLibraryDepth},
               {-3, kLibraryHeight, kLibraryDepth});
  const int rings = divisions(0.02 * budget, 8, 4);
  const bool is_small = budget < 8000;
  add_table(wood, lamps, 4.4, rings);
  if (!is_small) add_table(wood, lamps, 2.4, rings);
  if (!is_small) add_ladder(wood, random);
  Shelves shelves{is_small ? 2 : 7, is_small ? 2.0 : 1.0, 0};
  // A book has 12 triangles.
  const double length = (kLibraryWidth + 2 * kSideLength) * shelves.boards;
  const double left = std::max(0.1 * budget, budget - (is_small ? 600.0 : 3000.0));
  shelves.width = std::min(0.6, 12 * length / left);
  add_shelves(wood, books, 0, kLibraryWidth, shelves, random);
  for (const int wall : {1, 2}) add_shelves(wood, books, wall, kSideLength, shelves, random);
  return {ceiling.take(), room.take(), wood.take(), books.take(), lamps.take()};
}

}  // namespace

Trace make_library(const SceneOptions& options) {
  const Camera camera{
      .eye = {0.7, 1.65, 8.6}, .target = {-0.3, 1.35, 0}, .up = {0, 1, 0}, .fovy_deg = 40, .near = 0.2, .far = 30};
  Trace trace = one_frame(options, camera, build_to_budget(options, 60000, library_meshes));
  trace.frames[0].draws[0].shading = Shading::unlit;  // the light comes from above
  return trace;
}

}  // namespace beampipe
