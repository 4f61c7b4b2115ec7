#include <algorithm>
#include <cmath>

#include "traces/scenes/interior_textures.h"
#include "traces/scenes/scene.h"

namespace beampipe {
namespace {

using glm::dvec3, glm::dvec4;

// Metres. Shelves stand along the whole wall x = -1.6; the far wall is z = 0.
constexpr double kBooksAt = -1.6, kStudyRight = 1.6, kStudyDepth = 8, kStudyHeight = 2.7, kBoardDepth = 0.3;

struct StudyLook {
  Finish wallpaper, boards, carpet, spine, page, paint;
};

// Along z, and what is above the board.
struct Shelf {
  double from, to, bottom, space;
};

// Books with their backs to the room. Spines are textures of their own. `width`: of a book, in the mean.
void add_spines(MeshBuilder& books, const Shelf& shelf, double width, Random& random) {
  const double bottom = shelf.bottom;
  for (double z = shelf.from; z + 1.6 * width < shelf.to;) {
    const double thick = width * random.uniform(0.5, 1.5), high = shelf.space * random.uniform(0.6, 0.93);
    if (random.uniform() < 0.05) z += 2 * thick;
    books.color = random.uniform({0.35, 0.25, 0.2}, {1.0, 0.9, 0.8});
    books.box({kBooksAt + 0.02, bottom, z},
              {kBooksAt + kBoardDepth * random.uniform(0.65, 0.9), bottom + high, z + thick});
    z += thick + 0.002;
  }
}

void add_bookcase(MeshBuilder& wood, MeshBuilder& books, double width, bool is_small, Random& random) {
  const int boards = is_small ? 2 : 7, fields = is_small ? 2 : 8;
  const double pitch = kStudyHeight / boards, field = kStudyDepth / fields;
  for (int i = 0; i <= fields; ++i)
    wood.box({kBooksAt, 0, i * field - 0.02}, {kBooksAt + kBoardDepth, kStudyHeight, i * field + 0.02});
  for (int k = 0; k < boards; ++k)
    for (int i = 0; i < fields; ++i) {
      const double from = i * field + 0.02, to = (i + 1) * field - 0.02;
      wood.box({kBooksAt, k * pitch, from}, {kBooksAt + kBoardDepth, k * pitch + 0.03, to});
      add_spines(books, {from, to, k * pitch + 0.03, pitch - 0.03}, width, random);
    }
}

void add_desk(MeshBuilder& wood, MeshBuilder& pages, Random& random) {
  wood.box({0.2, 0.70, 3.4}, {1.1, 0.74, 5.0});
  for (const double x : {0.25, 1.05})
    for (const double z : {3.45, 4.95}) wood.box({x - 0.03, 0, z - 0.03}, {x + 0.03, 0.70, z + 0.03});
  for (int i = 0; i < 6; ++i) {
    const double x = random.uniform(0.25, 0.8), z = random.uniform(3.75, 4.9), y = 0.742 + 0.001 * i;
    pages.quad({x, y, z}, {x + 0.21, y, z}, {x + 0.21, y, z - 0.3}, {x, y, z - 0.3});
  }
}

std::vector<Mesh> build_study_meshes(const StudyLook& look, double budget, Random& random) {
  MeshBuilder walls("walls"), ceiling("ceiling"), floor("floor"), carpet("carpet"), wood("wood"), books("books"),
      pages("pages");
  walls.finish = look.wallpaper, walls.color = glm::vec3(0.95f);
  walls.quad({kBooksAt, 0, 0}, {kStudyRight, 0, 0}, {kStudyRight, kStudyHeight, 0}, {kBooksAt, kStudyHeight, 0});
  walls.quad({kStudyRight, 0, 0}, {kStudyRight, 0, kStudyDepth}, {kStudyRight, kStudyHeight, kStudyDepth},
             {kStudyRight, kStudyHeight, 0});
  walls.quad({kBooksAt, 0, kStudyDepth}, {kBooksAt, 0, 0}, {kBooksAt, kStudyHeight, 0},
             {kBooksAt, kStudyHeight, kStudyDepth});
  ceiling.finish = look.paint, ceiling.color = {0.86f, 0.85f, 0.82f};
  ceiling.quad({kBooksAt, kStudyHeight, 0}, {kStudyRight, kStudyHeight, 0}, {kStudyRight, kStudyHeight, kStudyDepth},
               {kBooksAt, kStudyHeight, kStudyDepth});
  floor.finish = look.boards, floor.color = {0.75f, 0.55f, 0.36f};
  floor.quad({kBooksAt, 0, kStudyDepth}, {kStudyRight, 0, kStudyDepth}, {kStudyRight, 0, 0}, {kBooksAt, 0, 0});
  carpet.finish = look.carpet, carpet.color = glm::vec3(1.0f);
  carpet.texture_place = [](const dvec3& p) { return glm::dvec2(p.x + 1, p.z - 0.6) / 1.9; };
  carpet.quad({-1.0, 0.01, 7.0}, {0.9, 0.01, 7.0}, {0.9, 0.01, 0.6}, {-1.0, 0.01, 0.6});
  wood.finish = look.boards, wood.color = {0.45f, 0.28f, 0.16f};
  books.finish = look.spine;
  pages.finish = look.page, pages.color = glm::vec3(1.0f);
  add_desk(wood, pages, random);
  const bool is_small = budget < 6000;
  // A book has 12 triangles, and a metre of shelf has room for one in each `width`.
  const double metres = kStudyDepth * (is_small ? 2 : 7);
  add_bookcase(wood, books, std::min(0.5, 12 * metres / std::max(0.1 * budget, budget - (is_small ? 150.0 : 900.0))),
               is_small, random);
  return {walls.take(), ceiling.take(), floor.take(), carpet.take(), wood.take(), books.take(), pages.take()};
}

// Bands of gold and lines of a title, along the longer side.
dvec4 spine(double x, double y) {
  const bool is_band = std::abs(x - 0.12) < 0.02 || std::abs(x - 0.88) < 0.02 || std::abs(x - 0.7) < 0.01;
  const bool is_line = x > 0.2 && x < 0.62 && triangle_wave(2 * y) > 0.35 && lattice_noise(x, 0.3, 64, 1, 71) > 0.4;
  if (is_band || is_line) return {0.95, 0.80, 0.40, 1};
  const double leather = 0.6 + 0.25 * fractal_noise(x, y, 32, 8, 3, 72);
  return {leather, 0.95 * leather, 0.9 * leather, 1};
}

// Lines of words.
dvec4 page(double x, double y) {
  const double line = 28 * y - std::floor(28 * y), number = std::floor(28 * y);
  const bool is_text = x > 0.1 && x < 0.9 && y > 0.08 && y < 0.92 && line > 0.35 && line < 0.75;
  const bool is_ink = is_text && lattice_noise(x, (number + 0.5) / 28, 90, 28, 73) > 0.42;
  const double light = is_ink ? 0.15 : 0.95;
  return {light, light, 0.97 * light, 1};
}

}  // namespace

Trace make_study(const SceneOptions& options) {
  Surfaces surfaces;
  const auto material = [&](const char* name, float roughness, TextureImage image) {
    const Texture texture = surfaces.add(std::move(image));
    return surfaces.add(Material{.name = name, .base_texture = texture, .roughness = roughness});
  };
  const StudyLook look{
      .wallpaper = {material("wallpaper", 0.9f, paint_wallpaper({0.62, 0.70, 0.62, 1}, {0.12, 0.28, 0.22, 1})), 0.6},
      .boards = {material("boards", 0.4f, paint_boards()), 0.7},
      .carpet = {material("carpet", 1.0f, paint_carpet({0.10, 0.14, 0.35, 1}, {0.80, 0.72, 0.55, 1}))},
      .spine = {material("leather", 0.5f, paint_image("spine", {256, 64}, spine))},
      .page = {material("page", 0.8f, paint_image("page", {256, 512}, page))},
      .paint = {surfaces.add(Material{.name = "paint", .roughness = 0.8f})}};
  const Camera camera{
      .eye = {0.1, 1.5, 7.6}, .target = {-0.45, 1.1, 0}, .up = {0, 1, 0}, .fovy_deg = 50, .near = 0.1, .far = 30};
  const auto build_study = [&](double budget, Random& random) { return build_study_meshes(look, budget, random); };
  Trace trace = one_frame(options, camera, build_to_budget(options, 20000, build_study));
  add_surfaces(trace, std::move(surfaces), {0.70f, 0.68f, 0.62f},
               {.sky = {0.46f, 0.46f, 0.46f}, .ground = {0.38f, 0.34f, 0.30f}});
  return trace;
}

}  // namespace beampipe
