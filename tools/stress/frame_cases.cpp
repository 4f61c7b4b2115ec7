// Frames at the ends of ranges: vertices that are not finite, the smallest and largest pictures, many layers.
#include <limits>

#include "tools/stress/case_parts.h"
#include "traces/size_text.h"

namespace beampipe {
namespace {

HardCase not_finite() {
  Screen screen(8, 8);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  screen.triangle({nan, 1}, {7, 1}, {1, 7}, 0.1, kRed);
  screen.triangle({1, 1}, {7, inf}, {1, 7}, 0.1, kRed);
  screen.triangle({1, 1}, {7, 1}, {-inf, 7}, 0.1, kRed);
  screen.triangle({1, 1, nan}, {7, 1, 0.1}, {1, 7, 0.1}, kRed);
  screen.triangle({1e-40, 1e-45}, {7.5, 1e-42}, {1e-44, 6.25}, 0.5, kGreen);
  return {"not_finite",
          "vertices that are NaN or infinite, whose triangles are dropped, and denormal ones",
          screen.trace(),
          {},
          full_masks()};
}

HardCase empty_frame() {
  Screen screen(5, 3);
  HardCase result{"empty", "no triangles", {}, {}, {}};
  result.trace = screen.trace();
  result.picture = ExactPicture{.elsewhere = glm::dvec4(glm::dvec3(kBackground), 0.0)};
  return result;
}

HardCase one_pixel() {
  Screen screen(1, 1);
  screen.triangle({-0.3, 0.1}, {1.2, 0.4}, {0.3, 1.7}, 0.5, kRed);
  return {"one_pixel",
          "a viewport of 1 x 1",
          screen.trace(),
          {},
          {{ErrorSource::quads_over_the_border, {0.3, "its 2x2 quad extends beyond the frame"}}}};
}

HardCase widest(std::uint32_t width, std::uint32_t height, const std::string& name) {
  Screen screen(width, height);
  screen.triangle({width - 3.2, height * 0.1}, {width - 0.1, height * 0.5}, {width - 2.9, height * 0.9}, 0.5, kRed);
  return {name, "a viewport of " + size_text(width, height), screen.trace(), {}, full_masks()};
}

HardCase deep_pixel() {
  constexpr int kLayers = 5000;
  Screen screen(1, 1);
  for (int i = kLayers; i-- > 0;)
    screen.triangle({-1, -1}, {3, -1}, {-1, 3}, static_cast<double>(i + 1) / (kLayers + 2), i == 0 ? kRed : kBlue);
  HardCase result{"deep_pixel_5000", "5000 fragments that cover one pixel, from far to near", {}, {}, {}};
  result.picture = ExactPicture{.elsewhere = glm::dvec4(glm::dvec3(kRed), 1.0)};
  result.trace = screen.trace();
  return result;
}

}  // namespace

std::vector<HardCase> frame_cases() {
  return {not_finite(), empty_frame(), one_pixel(), widest(16384, 2, "widest"), widest(2, 16384, "highest"),
          deep_pixel()};
}

}  // namespace beampipe
