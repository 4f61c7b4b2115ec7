// Cases that are hard on coordinates and depth: clipping, wide ranges, and surfaces that are nearly in the same place.
#include <array>
#include <utility>

#include "tools/stress/case_parts.h"

namespace beampipe {

Trace perspective(double near, double far, const std::vector<std::array<glm::vec3, 3>>& triangles) {
  Trace trace;
  Mesh mesh;
  mesh.name = "triangles";
  const glm::vec3 colors[] = {kRed, kGreen, kBlue};
  for (const auto& corners : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::vec3& corner : corners) mesh.positions.push_back(corner);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.colors.push_back(colors[(mesh.triangles.size() - 1) % 3]);
  }
  trace.meshes.push_back(std::move(mesh));
  Frame& frame = trace.frames.emplace_back();
  frame.width = frame.height = 16;
  frame.background = kBackground;
  set_camera(frame,
             {.eye = {0, 0, 0}, .target = {0, 0, -1}, .up = {0, 1, 0}, .fovy_deg = 90, .near = near, .far = far});
  frame.draws.emplace_back();
  return trace;
}

namespace {

HardCase near_plane() {
  return {"near_plane",
          "triangles that cross the near plane and the plane of the eye, where w is 0",
          perspective(0.01, 100,
                      {{{{-0.5f, -0.5f, -2.0f}, {0.6f, -0.4f, -2.0f}, {0.1f, 0.8f, 1.5f}}},
                       {{{-3.0f, 1.0f, -4.0f}, {3.0f, 1.0f, -4.0f}, {0.0f, 1.0f, 0.0f}}},
                       {{{-1.0f, -1.0f, 1.0f}, {1.0f, -1.0f, 1.0f}, {0.0f, -0.2f, -0.3f}}}}),
          {},
          together({mask_limits(0.02), merge_limits(0.15, 0.3)})};
}

// Triangles with vertices `far` million pixels outside the picture.
HardCase guard_band(double far, const std::string& name, const std::string& what) {
  Screen screen(16, 16);
  screen.triangle({-3e6 * far, 2e6 * far}, {4e6 * far, -1e6 * far}, {1e6 * far, 5e6 * far}, 0.5, kRed);
  screen.triangle({-8e6 * far, 8.3}, {8e6 * far, -4.2}, {9e6 * far, -7e6 * far}, 0.25, kGreen);
  return {name, what, screen.trace(), {}, together({mask_limits(0.01), merge_limits(0.1, 0.3)})};
}

HardCase wide_coordinates() {
  // Near 2^24 the floats of a mesh are whole numbers; the transform moves the triangle into the picture.
  Screen screen(16, 16);
  const double base = 16777200.0;
  screen.triangle({base + 1, base + 2, 0.5}, {base + 14, base + 5, 0.5}, {base + 6, base + 15, 0.5}, kRed);
  Trace trace = screen.trace();
  trace.frames[0].draws[0].transform[3] = glm::dvec4(-base, -base, 0.0, 1.0);
  return {"wide_coordinates", "24-bit coordinates that the transform moves into the picture", trace, {}, full_masks()};
}

// Near plane 0.001, far plane 10,000, and two triangles at a distance of 9,000 that are 10^-6 of it apart.
constexpr float kFarAway = -9000.0f, kBehindIt = -9000.01f;
constexpr std::array<glm::vec3, 3> kNearerOne{
    {{-6000, 3000, kFarAway}, {5000, 5000, kFarAway}, {1000, -8000, kFarAway}}},
    kFartherOne{{{-5000, -5000, kBehindIt}, {6000, -4000, kBehindIt}, {0, 8000, kBehindIt}}};

HardCase depth_range() {
  // As in a reversed depth buffer, depth is finest far away (stages/data/setup_triangle.h).
  return {"depth_range",
          "near to far as 1 : 10^7, and surfaces 10^-6 apart at the far end, of which the nearer one is drawn last",
          perspective(0.001, 10000, {kFartherOne, kNearerOne}),
          {},
          together({mask_limits(0.03), merge_limits(0.15, 0.3)})};
}

HardCase depth_range_turned() {
  Trace trace = perspective(0.001, 10000, {kNearerOne, kFartherOne});
  for (int column = 0; column < 4; ++column) trace.frames[0].projection[column][2] *= -1;
  HardCase result{
      "depth_range_turned",
      "the same with clip space's z negated: depth is coarsest far away, and the farther surface is in front",
      std::move(trace),
      {},
      together({mask_limits(0.7, kDepth), merge_limits(0.7, 0.7)})};
  for (const ErrorSource source : {ErrorSource::merges_of_layers, ErrorSource::sampled_depth})
    result.limits[source] = {0.7, kDepth};
  result.limits[ErrorSource::double_counting] = {2.0, kTwice};
  return result;
}

HardCase coincident() {
  Screen screen(16, 16);
  const glm::dvec3 a(1.3, 2.1, 0.2), b(14.7, 4.4, 0.7), c(6.2, 15.1, 0.5);
  screen.triangle(a, b, c, kRed).triangle(b, c, a, kGreen).triangle(c, b, a, kBlue);
  const double twice_halved = 0.75 - (0.75 / 4 + 0.125 / 4 + 0.25 / 2);  // red, given the shares of all three
  const double not_quite_half = 0.01;  // the slab reaches positions that are visible, and these are not all
  return {"coincident",
          "three equal triangles, of which the first is visible",
          screen.trace(),
          {},
          together({mask_limits(0.25),
                    merge_limits(0.4, 0.6),
                    {{ErrorSource::double_counting, {2.0, kTwice}},
                     {ErrorSource::merges_of_half_slopes, {twice_halved + not_quite_half + kFp16Error, kText}}}})};
}

HardCase coplanar() {
  Screen screen(16, 16);
  const glm::dvec3 a(1.3, 2.1, 0.2), b(14.7, 4.4, 0.7), c(6.2, 15.1, 0.5);
  screen.triangle(a, b, c, kRed).triangle(a, (b + c) * 0.5, c, kBlue);
  return {"coplanar",
          "two triangles in one plane with different vertices; after snapping their planes are 10^-6 apart",
          screen.trace(),
          {},
          together({mask_limits(0.25),
                    merge_limits(0.7, 0.7),
                    {{ErrorSource::sampled_depth, {1.0, kDepth}}, {ErrorSource::double_counting, {2.0, kDepth}}}})};
}

HardCase grazing() {
  Screen screen(16, 16);
  screen.triangle({0, 0, 0.5}, {16, 0, 0.5}, {8, 16, 0.5}, kRed);
  screen.triangle({0, 1, 0.49999}, {16, 2, 0.50001}, {7, 15, 0.500005}, kGreen);
  screen.triangle({0, 12, 0.3}, {16, 3, 0.7}, {15, 16, 0.6}, kBlue);
  // A sample that shows the wrong triangle contributes its share of the largest colour difference.
  const auto wrong_samples = [](int samples) { return samples <= 4 ? 0.75 / samples : 0.1; };
  return {"grazing",
          "triangles that intersect at slopes of 10^-6 per pixel",
          screen.trace(),
          {},
          together({mask_limits(0.25),
                    merge_limits(0.5, 0.5),
                    {{ErrorSource::sampled_depth, {wrong_samples, kDepth}},
                     {ErrorSource::merges_of_layers, {3.0 / 32, kSlopes}}}})};
}

}  // namespace

std::vector<HardCase> depth_cases() {
  return {near_plane(),
          guard_band(1, "guard_band", "vertices millions of pixels outside"),
          guard_band(1e6, "guard_band_far", "vertices 10^13 pixels outside"),
          wide_coordinates(),
          depth_range(),
          depth_range_turned(),
          coincident(),
          coplanar(),
          grazing()};
}

}  // namespace beampipe
