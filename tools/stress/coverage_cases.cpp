// Cases that are hard on areas: thin, tiny and many triangles, and edges in special places.
#include <cmath>

#include "tools/stress/case_parts.h"

namespace beampipe {
namespace {

HardCase slivers() {
  Screen screen(16, 16);
  // 65,000 px long and 1/256 px thick: length over thickness is 1.7 x 10^7.
  for (int i = 0; i < 7; ++i) {
    const double y = 1.0 + 2 * i, slope = 0.013 * (i - 3);
    const auto at = [&](double x, double above) { return glm::dvec2(x, y + slope * (x - 8) + above); };
    screen.triangle(at(-32000, 0), at(32000, 0), at(32000, 1.0 / 256), 0.5, i % 2 ? kRed : kGreen);
  }
  return {"slivers", "length over thickness 1.7 x 10^7", screen.trace(), {}, {}};
}

HardCase specks() {
  Screen screen(16, 16);
  for (int i = 0; i < 16; ++i) {
    // Areas from 2^-17 px, the smallest on the grid, to 2^-3 px.
    const double size = std::ldexp(1.0, i / 2 - 8), other = std::ldexp(1.0, (i + 1) / 2 - 8);
    const glm::dvec2 corner(i + 0.25, (i * 7) % 16 + 0.25);
    screen.triangle(corner, corner + glm::dvec2(size, 0), corner + glm::dvec2(0, other), 0.5, kRed);
    // Smaller than the grid, so that it is snapped to nothing.
    const glm::dvec2 below = corner + glm::dvec2(0.25 / 256, 0.5);
    screen.triangle(below, below + glm::dvec2(0.2 / 256, 0), below + glm::dvec2(0, 0.2 / 256), 0.4, kGreen);
  }
  return {"specks", "areas of 10^-6 px (which snapping removes), and from 7.6 x 10^-6 px up", screen.trace(), {}, {}};
}

HardCase large() {
  Screen screen(512, 400);
  screen.triangle({0.3, 0.7}, {511.2, 3.4}, {17.9, 399.6}, 0.5, kRed);
  return {"large", "one triangle of 10^5 px", screen.trace(), {}, full_masks()};
}

HardCase corners() {
  Screen screen(8, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) screen.triangle({x, y}, {x + 1, y}, {x, y + 1}, 0.5, (x + y) % 2 ? kRed : kBlue);
  return {"pixel_corners", "all vertices on pixel corners", screen.trace(), {}, {}};
}

HardCase through_samples() {
  Screen screen(16, 4);
  // Sample positions are multiples of 1/16 px (of 1/128 px above 16 samples), and so are these edges.
  for (int i = 0; i < 16; ++i) {
    const double u = i + i / 16.0;
    screen.triangle({u, 0}, {u, 2}, {i + 1, 2}, 0.5, kRed);
    screen.triangle({i, 2 + i / 16.0}, {i + 1, 2 + i / 16.0}, {i, 4}, 0.5, kGreen);
  }
  return {"through_samples", "edges that pass exactly through sample positions", screen.trace(), {}, {}};
}

HardCase edge_on() {
  Screen screen(16, 16);
  for (int i = 0; i < 8; ++i) {
    const double x = 2 * i + 0.3 + i / 64.0, thickness = 1.0 / 256;
    screen.triangle({x, 1, 0.01}, {x + thickness, 14, 0.99}, {x + 2 * thickness, 7, 0.5}, kRed);
    screen.triangle({x, 2.5, 0.75}, {x + 1, 9.5, 0.75}, {x, 9.5, 0.75}, kBlue);
  }
  return {"edge_on",
          "triangles seen almost edge-on, with depth slopes of 250 per pixel, that cut through others",
          screen.trace(),
          {},
          together({mask_limits(0.02), merge_limits(0.03, 0.01)})};
}

// A fan of triangles from a hub to `rim` points on a square around it.
Trace fan(std::uint32_t side, const glm::dvec2& hub, double reach, int rim) {
  Screen screen(side, side);
  const auto at = [&](int i) {
    const double t = 4.0 * (i % rim) / rim, along = 2 * (t - std::floor(t)) - 1;
    switch (static_cast<int>(t)) {
      case 0:
        return hub + reach * glm::dvec2(along, -1);
      case 1:
        return hub + reach * glm::dvec2(1, along);
      case 2:
        return hub + reach * glm::dvec2(-along, 1);
      default:
        return hub + reach * glm::dvec2(-1, -along);
    }
  };
  for (int i = 0; i < rim; ++i) screen.triangle(hub, at(i), at(i + 1), 0.5, kRed);
  return screen.trace();
}

HardCase shared_edges() {
  HardCase result{"shared_edges", "edges at 4,096 angles, each shared by two triangles", {}, {}, {}};
  result.trace = fan(16, {8.3, 7.6}, 3000, 4096);
  result.picture = ExactPicture{.elsewhere = glm::dvec4(glm::dvec3(kRed), 1.0)};
  result.limits = merge_limits(0.45, 0.75);
  return result;
}

HardCase fan_10000() {
  HardCase result{"fan", "10,000 triangles around one vertex", {}, {}, {}};
  result.trace = fan(4, {2.0, 2.0}, 30000, 10000);
  result.picture = ExactPicture{.elsewhere = glm::dvec4(glm::dvec3(kRed), 1.0)};
  result.limits = merge_limits(0.45, 0.75);
  return result;
}

HardCase tiled_pixel() {
  Screen screen(1, 1);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x) screen.rectangle({x / 128.0, y / 64.0}, {(x + 1) / 128.0, (y + 1) / 64.0}, 0.5, kRed);
  HardCase result{"tiled_pixel", "16,384 triangles that tile one pixel, so that their areas add up to 1", {}, {}, {}};
  result.picture = ExactPicture{.elsewhere = glm::dvec4(glm::dvec3(kRed), 1.0)};
  result.trace = screen.trace();
  // Adding shares of 0.75 / 16,384 stops at 0.125: above it, half a unit in the last place of fp16 is 2^-14. This loses
  // 0.625 of the red.
  result.limits = together({merge_limits(0.45, 0.75), {{ErrorSource::merges_in_fp16, {0.626, kStored}}}});
  return result;
}

HardCase fp16_sums() {
  Screen screen(1, 1);
  const glm::vec3 color(0.7f, 0.3f, 0.1f);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) screen.rectangle({x / 16.0, y / 16.0}, {(x + 1) / 16.0, (y + 1) / 16.0}, 0.5, color);
  HardCase result{"fp16_sums", "512 shares of a colour that fp16 cannot represent", {}, {}, {}};
  result.picture = ExactPicture{.elsewhere = glm::dvec4(glm::dvec3(color), 1.0)};
  result.trace = screen.trace();
  result.limits = together(
      {merge_limits(0.45, 0.5),
       {{ErrorSource::sums_in_fp16, {0.05, "each of 256 sums is rounded to fp16, by at most 2^-12"}},
        {ErrorSource::sums_in_unorm8, {9 * kUnorm8Error, "each of 9 sums is rounded to 8 bits, by at most 2^-9"}}}});
  return result;
}

}  // namespace

std::vector<HardCase> coverage_cases() {
  return {slivers(), specks(),       large(),     corners(),     through_samples(),
          edge_on(), shared_edges(), fan_10000(), tiled_pixel(), fp16_sums()};
}

}  // namespace beampipe
