#include "traces/scenes/interior_textures.h"

#include <algorithm>
#include <cmath>

namespace beampipe {
namespace {

using glm::dvec4;

dvec4 mixed(const dvec4& a, const dvec4& b, double share) { return a + share * (b - a); }

}  // namespace

TextureImage paint_wallpaper(const dvec4& ground, const dvec4& figure) {
  return paint_image("wallpaper", {512, 512}, [&](double x, double y) {
    const double stripe = triangle_wave(4 * x);  // 1 in the middle of a light stripe
    const double line = smooth_step(0.06, 0.02, std::abs(stripe - 0.5));
    // A sprig: a stem with leaves to both sides, eight of them one above the other.
    const double across = std::abs(4 * x - std::floor(4 * x) - 0.5), up = 8 * y - std::floor(8 * y);
    const double leaf_x = (across - 0.13) / 0.11, leaf_y = (up - 0.5 + 1.6 * across) / 0.16;
    const double leaf = smooth_step(1.15, 0.85, leaf_x * leaf_x + leaf_y * leaf_y);
    const double stem = smooth_step(0.03, 0.015, across) * smooth_step(0.05, 0.1, up);
    const double paper = 0.96 + 0.04 * lattice_noise(x, y, 128, 128, 51);
    return mixed(mixed(ground, figure, 0.18 * smooth_step(0.45, 0.55, stripe)), figure, std::max({line, leaf, stem})) *
           dvec4(paper, paper, paper, 1);
  });
}

TextureImage paint_carpet(const dvec4& ground, const dvec4& figure) {
  return paint_image("carpet", {512, 512}, [&](double x, double y) {
    constexpr double kKnots = 128;
    const double kx = (std::floor(kKnots * x) + 0.5) / kKnots, ky = (std::floor(kKnots * y) + 0.5) / kKnots;
    const double lozenge = triangle_wave(4 * kx) + triangle_wave(4 * ky);
    const double to_side = std::min(kx, 1 - kx);
    bool is_figure = std::abs(lozenge - 1) < 0.12 || lozenge < 0.25 || lozenge > 1.8;
    if (to_side < 0.1) is_figure = triangle_wave(16 * ky) > 10 * to_side;
    if (to_side > 0.1 && to_side < 0.12) is_figure = true;
    // A knot is lighter in its middle, and no two have quite the same wool.
    const double wool =
        0.75 + 0.2 * triangle_wave(kKnots * x) * triangle_wave(kKnots * y) + 0.15 * lattice_noise(kx, ky, 128, 128, 52);
    return (is_figure ? figure : ground) * dvec4(wool, wool, wool, 1);
  });
}

TextureImage paint_boards() {
  return paint_image("boards", {512, 512}, [](double x, double y) {
    const double board = std::floor(4 * y), shift = 0.37 * board;
    const double seam = smooth_step(0.0, 0.02, std::abs(4 * y - std::round(4 * y)));
    const double end = smooth_step(0.0, 0.005, std::abs(x + shift - std::round(x + shift)));
    const double light = (0.85 + 0.15 * lattice_noise(0, y, 1, 4, 53)) * (0.35 + 0.65 * std::min(seam, end));
    return wood_tint(wood_grain(x + shift, y + 0.21 * board)) * dvec4(light, light, light, 1);
  });
}

}  // namespace beampipe
