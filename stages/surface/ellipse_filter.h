// Weights of the texels in a pixel's footprint, which is an ellipse in the image: an elliptical weighted average.
//
// Sources: P. S. Heckbert, "Fundamentals of Texture Mapping and Image Warping", Master's thesis, University of
// California, Berkeley, 1989, section 3.5, with the variances of a pixel and of a texel added; numbers as Mesa 22.3
// chooses them for its software drivers (lp_build_sample_aniso), whose pictures captured traces are compared with: the
// ellipse ends where its quadratic form is 1, and there the Gaussian weight is exp(-2).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace beampipe {

// exp(-2 n / 1023) for n = 0..1023, with six decimals: so they are the same with every library of mathematics.
inline const std::array<float, 1024>& ellipse_weights() {
  static const std::array<float, 1024> weights = [] {
    std::array<float, 1024> made{};
    for (std::size_t n = 0; n < made.size(); ++n)
      made[n] = static_cast<float>(std::round(std::exp(-2.0 * static_cast<double>(n) / 1023) * 1e6) / 1e6);
    return made;
  }();
  return weights;
}

// Calls visit(x, y, weight) for each texel in the footprint, row by row; weights are above 0, and their sum is not 1.
// `middle`: the place of the pixel in texels, with whole numbers at the centres of texels. `slopes`: how the place
// changes per pixel to the right and down, in texels. Longer slopes than 256 texels are shortened, which bounds the
// work. Without numbers there is one texel.
template <class Visit>
void visit_ellipse(const std::array<float, 2>& middle, std::array<std::array<float, 2>, 2> slopes, Visit&& visit) {
  constexpr float kMostSlope = 256, kFarthest = 1e6f;
  for (auto& slope : slopes) {
    const float length = std::sqrt(slope[0] * slope[0] + slope[1] * slope[1]);
    if (!std::isfinite(length)) slope = {};
    if (length > kMostSlope)
      for (float& each : slope) each *= kMostSlope / length;
  }
  const auto& [right, down] = slopes;
  // a x^2 + b x y + c y^2 = full is the ellipse.
  const float a = right[1] * right[1] + down[1] * down[1] + 1, c = right[0] * right[0] + down[0] * down[0] + 1;
  const float b = -2 * (right[0] * right[1] + down[0] * down[1]);
  const float full = a * c - b * b / 4;
  const float scale = 1023 / full;
  const float half_width = std::sqrt(c), half_height = std::sqrt(a);
  std::array<float, 2> at = middle;
  for (float& each : at) each = std::isnan(each) ? 0.0f : std::clamp(each, -kFarthest, kFarthest);
  const auto below = [](float place) { return static_cast<std::int64_t>(std::floor(place)); };
  const auto above = [](float place) { return static_cast<std::int64_t>(std::ceil(place)); };
  for (std::int64_t y = below(at[1] - half_height); y <= above(at[1] + half_height); ++y) {
    const float dy = static_cast<float>(y) - at[1];
    for (std::int64_t x = below(at[0] - half_width); x <= above(at[0] + half_width); ++x) {
      const float dx = static_cast<float>(x) - at[0];
      const float form = (a * scale * dx + b * scale * dy) * dx + c * scale * dy * dy;
      if (form < 1024) visit(x, y, ellipse_weights()[static_cast<std::size_t>(std::max(form, 0.0f))]);
    }
  }
}

}  // namespace beampipe
