#include <algorithm>
#include <cmath>
#include <string_view>

#include "traces/scenes/classroom.h"
#include "traces/scenes/textures.h"

namespace beampipe {
namespace {

using glm::dvec2, glm::dvec4;

// Letters as strokes in a grid: each stroke is a list of points, x from 0 to 4 and y from 0 to 8 upwards, and the
// letters stand at y = 2.
struct Letter {
  char name;
  std::string_view strokes;
};
constexpr Letter kLetters[] = {
    {'a', "461605031242 4642"},
    {'b', "0802 063645433202"},
    {'c', "4536160503123243"},
    {'e', "04444536160503123243"},
    {'f', "48382722 1636"},
    {'g', "461605031242 4641301001"},
    {'i', "2622 2727"},
    {'l', "2822"},
    {'n', "0602 0516364542"},
    {'o', "160503123243453616"},
    {'r', "0602 04163646"},
    {'t', "28233242 1636"},
    {'1', "072822"},
    {'2', "07183847460242"},
    {'+', "2723 0545"},
    {'=', "0646 0444"},
    {'/', "4802"},
};

// A blackboard of 4.2 x 1.2 m with what is written on it.
class Blackboard {
 public:
  Blackboard() : distance_(std::size_t{kSize.width} * kSize.height, 1.0) {}

  void write(std::string_view text, dvec2 at, double height) {
    for (const char name : text) {
      if (name == '^') {  // the next letter is an exponent
        at.y -= 0.5 * height;
        height *= 0.6;
        continue;
      }
      const auto letter = std::ranges::find(kLetters, name, &Letter::name);
      if (letter != std::end(kLetters)) write_strokes(letter->strokes, at, height / 6);
      at.x += 0.95 * height;
    }
  }

  void draw(const dvec2& a, const dvec2& b) {
    const auto texel = [](double metres, std::uint32_t most) {
      return static_cast<std::uint32_t>(std::clamp(std::floor(metres * kPerMetre), 0.0, static_cast<double>(most)));
    };
    const dvec2 low = glm::min(a, b) - 0.03, high = glm::max(a, b) + 0.03, along = b - a;
    for (std::uint32_t j = texel(low.y, kSize.height); j < texel(high.y, kSize.height); ++j) {
      for (std::uint32_t i = texel(low.x, kSize.width); i < texel(high.x, kSize.width); ++i) {
        const dvec2 to = dvec2(i + 0.5, j + 0.5) / kPerMetre - a;
        const double squared = along.x * along.x + along.y * along.y;
        const double t = squared > 0 ? std::clamp((to.x * along.x + to.y * along.y) / squared, 0.0, 1.0) : 0.0;
        const double x = to.x - t * along.x, y = to.y - t * along.y;
        double& nearest = distance_[std::size_t{j} * kSize.width + i];
        nearest = std::min(nearest, std::sqrt(x * x + y * y));
      }
    }
  }

  TextureImage paint() const {
    return paint_image("blackboard", kSize, [&](double x, double y) {
      const double wiped = std::floor(24 * fractal_noise(x, y, 9, 3, 3, 31)) / 24;
      const auto i = static_cast<std::size_t>(x * kSize.width), j = static_cast<std::size_t>(y * kSize.height);
      const double line = smooth_step(0.014, 0.005, distance_[j * kSize.width + i]);
      const double chalk = line * (0.6 + 0.4 * lattice_noise(x, y, 512, 146, 32));
      const dvec4 board(0.17 + 0.16 * wiped, 0.31 + 0.15 * wiped, 0.25 + 0.15 * wiped, 1);
      return board + chalk * (dvec4(0.95, 0.95, 0.90, 1) - board);
    });
  }

 private:
  static constexpr ImageSize kSize{1024, 292};
  static constexpr double kPerMetre = 1024 / 4.2;

  void write_strokes(std::string_view strokes, const dvec2& at, double unit) {
    const auto point = [&](std::size_t i) { return at + unit * dvec2(strokes[i] - '0', 2 - (strokes[i + 1] - '0')); };
    for (std::size_t i = 0; i + 3 < strokes.size(); i += 2) {
      if (strokes[i + 2] == ' ') {
        i += 1;
        continue;
      }
      draw(point(i), point(i + 2));
    }
  }

  std::vector<double> distance_;  // from each texel to the nearest line, in metres
};

TextureImage paint_blackboard() {
  Blackboard board;
  board.write("area of a triangle", {0.22, 0.30}, 0.098);
  board.write("a=bc/2", {0.25, 0.66}, 0.15);
  board.write("a^2", {0.25, 1.02}, 0.15);
  board.write("+b^2", {0.52, 1.02}, 0.15);
  board.write("=c^2", {0.95, 1.02}, 0.15);
  for (int i = 0; i <= 6; ++i) board.draw({2.0 + 0.25 * i, 0.18}, {2.0 + 0.25 * i, 1.18 - 0.15});  // pixels
  for (int i = 0; i <= 3; ++i) board.draw({2.0, 0.18 + 0.2833 * i}, {3.5, 0.18 + 0.2833 * i});
  const dvec2 corners[] = {{2.1, 0.95}, {3.35, 0.66}, {2.55, 0.24}};
  for (int i = 0; i < 3; ++i) {
    board.draw(corners[i], corners[(i + 1) % 3]);
    board.draw(corners[i] + dvec2(0.008, 0.006), corners[(i + 1) % 3] + dvec2(0.006, 0.008));  // drawn twice: thick
  }
  return board.paint();
}

// Land where the noise is high, and ice at the poles.
TextureImage paint_globe() {
  return paint_image("globe", {256, 128}, [](double x, double y) {
    const double height = fractal_noise(x, y, 5, 3, 4, 41), to_pole = std::abs(2 * y - 1);
    if (to_pole + 0.2 * height > 0.97) return dvec4(0.95, 0.96, 0.98, 1);
    if (height < 0.52) return dvec4(0.15, 0.40, 0.70, 1);
    return height < 0.60 ? dvec4(0.35, 0.58, 0.25, 1) : dvec4(0.66, 0.55, 0.30, 1);
  });
}

// Two pale bars on a cover, for a title.
TextureImage paint_cover() {
  return paint_image("book cover", {64, 64}, [](double x, double y) {
    const bool title = x > 0.2 && x < 0.8 && ((y > 0.2 && y < 0.3) || (y > 0.38 && y < 0.44));
    const bool spine = x < 0.06;
    const double light = title ? 1.0 : spine ? 0.55 : 0.78;
    return dvec4(light, light, light, 1);
  });
}

}  // namespace

Trace make_room(const SceneOptions& options) {
  Surfaces surfaces;
  ClassroomLook look;
  const Texture wood =
      surfaces.add(paint_image("wood", {512, 512}, [](double x, double y) { return wood_tint(wood_grain(x, y)); }));
  const Texture grain =
      surfaces.add(paint_normals("grain", {256, 256}, [](double x, double y) { return -0.006 * wood_grain(x, y); }));
  const Texture varnish = surfaces.add(paint_roughness("varnish", {128, 128}, [](double x, double y) {
    return 0.35 + 0.5 * smooth_step(0.35, 0.75, fractal_noise(x, y, 4, 8, 3, 21));  // worn off in places
  }));
  const Texture plaster = surfaces.add(paint_normals(
      "plaster", {256, 256}, [](double x, double y) { return 0.02 * fractal_noise(x, y, 24, 24, 3, 22); }));
  const Texture cloth = surfaces.add(paint_image("lacquer", {64, 64}, [](double x, double y) {
    const double light = 0.80 + 0.14 * lattice_noise(x, y, 4, 32, 23);
    return dvec4(light, light, light, 1);
  }));

  look.wood = {
      surfaces.add(Material{.name = "varnished wood", .base_texture = wood, .metallic_roughness_texture = varnish}),
      1.1};
  look.floor = {
      surfaces.add(Material{.name = "parquet", .base_texture = wood, .roughness = 0.5f, .normal_texture = grain}), 1.3};
  look.plaster = {surfaces.add(Material{.name = "plaster", .roughness = 0.9f, .normal_texture = plaster}), 0.6};
  look.ceiling = {look.plaster.material, 1.2};
  look.paint = {surfaces.add(Material{.name = "paint", .roughness = 0.5f})};
  look.board = {surfaces.add(
      Material{.name = "blackboard", .base_texture = surfaces.add(paint_blackboard()), .roughness = 0.8f})};
  look.steel = {surfaces.add(Material{.name = "steel", .metallic = 1, .roughness = 0.35f})};
  look.plastic = {surfaces.add(Material{.name = "plastic", .roughness = 0.4f})};
  look.paper = {surfaces.add(Material{.name = "book", .base_texture = surfaces.add(paint_cover()), .roughness = 0.6f})};
  look.globe = {
      surfaces.add(Material{.name = "globe", .base_texture = surfaces.add(paint_globe()), .roughness = 0.3f})};
  look.slats = {
      surfaces.add(Material{.name = "slats", .base_texture = cloth, .roughness = 0.35f, .double_sided = true}), 0.3};
  look.cord = {surfaces.add(Material{.name = "cord", .roughness = 0.6f})};
  look.outside = {surfaces.add(
      Material{.name = "outside", .base_color = {0.55f, 0.70f, 0.90f, 1.0f}, .double_sided = true, .unlit = true})};

  Trace trace = classroom_trace(options, 40000, look);
  add_surfaces(trace, std::move(surfaces), {0.85f, 0.80f, 0.70f},
               {.sky = {0.42f, 0.44f, 0.48f}, .ground = {0.34f, 0.30f, 0.25f}});
  return trace;
}

}  // namespace beampipe
