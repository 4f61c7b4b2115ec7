#include "tools/stress/hard_cases.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace beampipe {
namespace {

// Colours whose sums of a few are exact in fp16, so that what is left of an error is not the format's.
constexpr glm::vec3 kRed{0.75f, 0.25f, 0.125f}, kGreen{0.125f, 0.75f, 0.25f}, kBlue{0.25f, 0.125f, 0.75f};
constexpr glm::vec3 kBackground{0.5f, 0.5f, 1.0f};

// Builds a trace whose x and y are in pixels (y down) and whose z runs from 0, the near plane, to 1.
class Screen {
 public:
  Screen(std::uint32_t width, std::uint32_t height) {
    frame_.width = width, frame_.height = height;
    frame_.background = kBackground;
    frame_.projection[0][0] = 2.0 / width;
    frame_.projection[1][1] = -2.0 / height;
    frame_.projection[2][2] = 2.0;
    frame_.projection[3] = glm::dvec4(-1.0, 1.0, -1.0, 1.0);
  }

  Screen& triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::vec3& color) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (const glm::dvec3& corner : {a, b, c}) mesh_.positions.emplace_back(corner);
    mesh_.triangles.emplace_back(first, first + 1, first + 2);
    mesh_.colors.push_back(color);
    return *this;
  }
  Screen& triangle(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, double z, const glm::vec3& color) {
    return triangle({a, z}, {b, z}, {c, z}, color);
  }
  Screen& rectangle(const glm::dvec2& low, const glm::dvec2& high, double z, const glm::vec3& color) {
    triangle(low, {high.x, low.y}, high, z, color);
    return triangle(low, high, {low.x, high.y}, z, color);
  }
  Frame& frame() { return frame_; }

  Trace trace() {
    Trace trace;
    mesh_.name = "triangles";
    trace.meshes.push_back(std::move(mesh_));
    frame_.draws.emplace_back();
    trace.frames.push_back(std::move(frame_));
    return trace;
  }

 private:
  Mesh mesh_;
  Frame frame_;
};

constexpr const char* kOver = "OVER takes fragments for independent of each other";
constexpr const char* kPaper = "masks of 32 positions; local coverage above 1 is lost";
constexpr const char* kText = "slopes in 16 bits make a slab of equal planes, of which each later triangle takes half";
constexpr const char* kFull = "a mask without a gap counts as full coverage: corners beyond its positions are lost";
constexpr const char* kDepth = "32-bit depth: surfaces less than its rounding apart change places";
constexpr const char* kTwice = "without a stencil equal depths count twice";
constexpr const char* kStored = "a sum stored in fp16 stops growing where a share is less than half its last place";
constexpr const char* kMask = "areas of what is partly hidden are estimated from mask positions";

constexpr const char* kUnseen = "a triangle that covers no position is not seen";
constexpr const char* kSlopes = "slopes of layers are stored in 8 bits: crossings move by a few positions";

const std::string kStream = "beam:order=stream", kSmallStream = "beam:order=stream,bits=64",
                  kCoarseStream = "beam:order=stream,bits=32";

// Of techniques that take a mask without a gap for full coverage, in pixels that so many edges cut.
std::map<std::string, StatedLimit> full_masks(int edges = 1) {
  return {{"beam", {edges * largest_cut(256), kFull}},        {"beam:bits=64", {edges * largest_cut(64), kFull}},
          {"beam:bits=32", {edges * largest_cut(32), kFull}}, {kStream, {edges * largest_cut(128), kFull}},
          {kCoarseStream, {edges * largest_cut(32), kFull}},  {kSmallStream, {edges * largest_cut(64), kFull}}};
}

HardCase slivers() {
  Screen screen(16, 16);
  // 65,000 px long and 1/256 px thick: length over thickness is 1.7 x 10^7.
  for (int i = 0; i < 7; ++i) {
    const double y = 1.0 + 2 * i, slope = 0.013 * (i - 3);
    const auto at = [&](double x, double above) { return glm::dvec2(x, y + slope * (x - 8) + above); };
    screen.triangle(at(-32000, 0), at(32000, 0), at(32000, 1.0 / 256), 0.5, i % 2 ? kRed : kGreen);
  }
  // In the middle each is half as thick, and at most hypot(1, 0.039) long in a pixel.
  const double lost = 1.001 / 512;
  return {"slivers",
          "length over thickness 1.7 x 10^7",
          screen.trace(),
          {},
          {{kStream, {lost, kUnseen}}, {kSmallStream, {lost, kUnseen}}}};
}

HardCase specks() {
  Screen screen(16, 16);
  for (int i = 0; i < 16; ++i) {
    // From 2^-17 px of area, the least that the grid has, to 2^-3.
    const double size = std::ldexp(1.0, i / 2 - 8), other = std::ldexp(1.0, (i + 1) / 2 - 8);
    const glm::dvec2 corner(i + 0.25, (i * 7) % 16 + 0.25);
    screen.triangle(corner, corner + glm::dvec2(size, 0), corner + glm::dvec2(0, other), 0.5, kRed);
    // Less than the grid: snapped to nothing.
    const glm::dvec2 below = corner + glm::dvec2(0.25 / 256, 0.5);
    screen.triangle(below, below + glm::dvec2(0.2 / 256, 0), below + glm::dvec2(0, 0.2 / 256), 0.4, kGreen);
  }
  // A speck of 1/8 x 1/8 px covers no position of 128, one of 1/8 x 1/4 none of 64; larger ones cover some.
  return {"specks",
          "areas from 10^-6 px (snapped to none) and 7.6 x 10^-6 px up",
          screen.trace(),
          {},
          {{kStream, {0x1p-7, kUnseen}}, {kSmallStream, {0x1p-6, kUnseen}}, {kCoarseStream, {0x1p-6, kUnseen}}}};
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
  // Sample positions are multiples of 1/16 px (1/128 px in super-resolution): so are these edges.
  for (int i = 0; i < 16; ++i) {
    const double u = i + i / 16.0;
    screen.triangle({u, 0}, {u, 2}, {i + 1, 2}, 0.5, kRed);
    screen.triangle({i, 2 + i / 16.0}, {i + 1, 2 + i / 16.0}, {i, 4}, 0.5, kGreen);
  }
  return {
      "through_samples", "edges through sample positions", screen.trace(), {}, {{kCoarseStream, {0x1p-6, kUnseen}}}};
}

HardCase edge_on() {
  Screen screen(16, 16);
  for (int i = 0; i < 8; ++i) {
    const double x = 2 * i + 0.3 + i / 64.0, thickness = 1.0 / 256;
    screen.triangle({x, 1, 0.01}, {x + thickness, 14, 0.99}, {x + 2 * thickness, 7, 0.5}, kRed);
    screen.triangle({x, 2.5, 0.75}, {x + 1, 9.5, 0.75}, {x, 9.5, 0.75}, kBlue);
  }
  return {"edge_on",
          "depth slopes of 250 per pixel, cutting through others",
          screen.trace(),
          {},
          {{"beam", {0.02, kMask}},
           {kSmallStream, {0.05, kMask}},
           {kCoarseStream, {0.06, kMask}},
           {"beam:rules=paper", {0.03, kPaper}},
           {"alpha", {0.01, kOver}}}};
}

// `rim` points on a square around a hub.
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
  result.everywhere = glm::dvec4(glm::dvec3(kRed), 1.0);
  result.limits = {{"alpha", {0.75, kOver}}, {"beam:rules=paper", {0.45, kPaper}}};
  return result;
}

HardCase fan_10000() {
  HardCase result{"fan", "10,000 triangles around one vertex", {}, {}, {}};
  result.trace = fan(4, {2.0, 2.0}, 30000, 10000);
  result.everywhere = glm::dvec4(glm::dvec3(kRed), 1.0);
  result.limits = {{"alpha", {0.75, kOver}}, {"beam:rules=paper", {0.45, kPaper}}};
  return result;
}

HardCase tiled_pixel() {
  Screen screen(1, 1);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x) screen.rectangle({x / 128.0, y / 64.0}, {(x + 1) / 128.0, (y + 1) / 64.0}, 0.5, kRed);
  HardCase result{"tiled_pixel", "16,384 triangles tile one pixel: their areas add up to 1", {}, {}, {}};
  result.everywhere = glm::dvec4(glm::dvec3(kRed), 1.0);
  result.trace = screen.trace();
  // Shares of 0.75 / 16,384 stop at 0.125, above which half of fp16's last place is 2^-14: 0.625 of the red are lost.
  result.limits = {{"alpha", {0.75, kOver}},
                   {"beam:rules=paper", {0.626, kStored}},
                   {"beam:rules=paper,storage=float32", {0.45, kPaper}}};
  return result;
}

HardCase fp16_sums() {
  Screen screen(1, 1);
  const glm::vec3 color(0.7f, 0.3f, 0.1f);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) screen.rectangle({x / 16.0, y / 16.0}, {(x + 1) / 16.0, (y + 1) / 16.0}, 0.5, color);
  HardCase result{"fp16_sums", "512 shares of a colour that fp16 does not have", {}, {}, {}};
  result.everywhere = glm::dvec4(glm::dvec3(color), 1.0);
  result.trace = screen.trace();
  result.limits = {{"alpha", {0.5, kOver}},
                   {"beam:rules=paper", {0.45, kPaper}},
                   {"acaa", {0.05, "each sum is rounded to fp16: 2^-12 at most, 256 times"}},
                   {"acaa:8,color=unorm8", {9 * 0.5 / 255, "each sum is rounded to 8 bits: 2^-9 at most, 9 times"}},
                   {"acaa:8,color=fp32", {0x1p-11, "sums in fp32"}}};
  return result;
}

// A perspective camera at the origin that looks along -z: x and y are in units of the distance.
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
  set_camera(frame, {{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90, near, far});
  frame.draws.emplace_back();
  return trace;
}

HardCase near_plane() {
  return {"near_plane",
          "triangles through the near plane and the eye's plane, where w is 0",
          perspective(0.01, 100,
                      {{{{-0.5f, -0.5f, -2.0f}, {0.6f, -0.4f, -2.0f}, {0.1f, 0.8f, 1.5f}}},
                       {{{-3.0f, 1.0f, -4.0f}, {3.0f, 1.0f, -4.0f}, {0.0f, 1.0f, 0.0f}}},
                       {{{-1.0f, -1.0f, 1.0f}, {1.0f, -1.0f, 1.0f}, {0.0f, -0.2f, -0.3f}}}}),
          {},
          {
              {"beam", {0.02, kMask}},
              {"beam:rules=paper", {0.15, kPaper}},
              {"alpha", {0.3, kOver}},
          }};
}

// `far` times millions of pixels outside.
HardCase guard_band(double far, const std::string& name, const std::string& what) {
  Screen screen(16, 16);
  screen.triangle({-3e6 * far, 2e6 * far}, {4e6 * far, -1e6 * far}, {1e6 * far, 5e6 * far}, 0.5, kRed);
  screen.triangle({-8e6 * far, 8.3}, {8e6 * far, -4.2}, {9e6 * far, -7e6 * far}, 0.25, kGreen);
  return {name,
          what,
          screen.trace(),
          {},
          {{"alpha", {0.3, kOver}}, {"beam:rules=paper", {0.1, kPaper}}, {"beam", {0.01, kMask}}}};
}

HardCase wide_coordinates() {
  // Around 2^24 the floats of a mesh are whole numbers: the triangle's place is in the transform.
  Screen screen(16, 16);
  const double base = 16777200.0;
  screen.triangle({base + 1, base + 2, 0.5}, {base + 14, base + 5, 0.5}, {base + 6, base + 15, 0.5}, kRed);
  Trace trace = screen.trace();
  trace.frames[0].draws[0].transform[3] = glm::dvec4(-base, -base, 0.0, 1.0);
  return {"wide_coordinates", "24-bit coordinates, moved back by the transform", trace, {}, full_masks()};
}

// near 0.001, far 10,000: a relative step of 10^-6 at 9,000.
constexpr float kFarAway = -9000.0f, kBehindIt = -9000.01f;
constexpr std::array<glm::vec3, 3> kNearerOne{
    {{-6000, 3000, kFarAway}, {5000, 5000, kFarAway}, {1000, -8000, kFarAway}}},
    kFartherOne{{{-5000, -5000, kBehindIt}, {6000, -4000, kBehindIt}, {0, 8000, kBehindIt}}};

HardCase depth_range() {
  // Depth is finest far away (stages/data/setup_triangle.h), as a reversed buffer's.
  return {"depth_range",
          "near to far 1 : 10^7, surfaces 10^-6 apart at the far end; the nearer one is drawn last",
          perspective(0.001, 10000, {kFartherOne, kNearerOne}),
          {},
          {{"beam", {0.03, kMask}}, {"beam:rules=paper", {0.15, kPaper}}, {"alpha", {0.3, kOver}}}};
}

HardCase depth_range_turned() {
  Trace trace = perspective(0.001, 10000, {kNearerOne, kFartherOne});
  for (int column = 0; column < 4; ++column) trace.frames[0].projection[column][2] *= -1;
  HardCase result{"depth_range_turned",
                  "the same with clip space's z negated: depth is coarsest far away, and the farther one wins",
                  std::move(trace),
                  {},
                  {{"alpha", {0.7, kOver}}, {"beam:rules=paper", {0.7, kPaper}}}};
  for (const char* name : {"beam", "z3", "msaa", "acaa:8,double=stencil", "deferred", "visibility", "taa", "dvm"})
    result.limits[name] = {0.7, kDepth};
  result.limits["acaa"] = {2.0, kTwice};
  return result;
}

HardCase coincident() {
  Screen screen(16, 16);
  const glm::dvec3 a(1.3, 2.1, 0.2), b(14.7, 4.4, 0.7), c(6.2, 15.1, 0.5);
  screen.triangle(a, b, c, kRed).triangle(b, c, a, kGreen).triangle(c, b, a, kBlue);
  const double twice_halved = 0.75 - (0.75 / 4 + 0.125 / 4 + 0.25 / 2);  // red, by the shares of all three
  return {"coincident",
          "three equal triangles: the first one stays",
          screen.trace(),
          {},
          {{"acaa", {2.0, kTwice}},
           {"acaa:8,double=stencil", {0x1p-11, "fp16"}},
           {"alpha", {0.6, kOver}},
           {"beam:rules=paper", {0.4, kPaper}},
           {"beam:rules=paper,storage=text", {twice_halved + 0x1p-11, kText}},
           {"beam", {0.25, kMask}}}};
}

HardCase coplanar() {
  Screen screen(16, 16);
  const glm::dvec3 a(1.3, 2.1, 0.2), b(14.7, 4.4, 0.7), c(6.2, 15.1, 0.5);
  screen.triangle(a, b, c, kRed).triangle(a, (b + c) * 0.5, c, kBlue);
  return {"coplanar",
          "two triangles in one plane with other vertices: snapped, their planes are 10^-6 apart",
          screen.trace(),
          {},
          {{"msaa", {1.0, kDepth}},
           {"acaa", {2.0, kDepth}},
           {"acaa:8,double=stencil", {1.0, kDepth}},
           {"deferred", {1.0, kDepth}},
           {"visibility", {1.0, kDepth}},
           {"taa", {1.0, kDepth}},
           {"dvm", {1.0, kDepth}},
           {"alpha", {0.7, kOver}},
           {"beam:rules=paper", {0.7, kPaper}},
           {"beam", {0.25, kMask}}}};
}

HardCase grazing() {
  Screen screen(16, 16);
  screen.triangle({0, 0, 0.5}, {16, 0, 0.5}, {8, 16, 0.5}, kRed);
  screen.triangle({0, 1, 0.49999}, {16, 2, 0.50001}, {7, 15, 0.500005}, kGreen);
  screen.triangle({0, 12, 0.3}, {16, 3, 0.7}, {15, 16, 0.6}, kBlue);
  HardCase result{"grazing",
                  "triangles that cut through each other at 10^-6 depth per pixel",
                  screen.trace(),
                  {},
                  {{"beam", {0.25, kMask}},
                   {"beam:rules=paper", {0.5, kPaper}},
                   {"msaa", {0.1, kDepth}},
                   {"acaa", {0.1, kDepth}},
                   {"z3", {3.0 / 32, kSlopes}},
                   {"alpha", {0.5, kOver}}}};
  // A sample that changes places takes its share of the largest colour along.
  for (const int samples : {1, 2, 4})
    for (const char* name : {"msaa:", "acaa:"})
      result.limits[name + std::to_string(samples)] = {0.75 / samples, kDepth};
  for (const char* name : {"taa", "deferred", "visibility"}) result.limits[name] = {0.75, kDepth};
  return result;
}

HardCase not_finite() {
  Screen screen(8, 8);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  screen.triangle({nan, 1}, {7, 1}, {1, 7}, 0.1, kRed);
  screen.triangle({1, 1}, {7, inf}, {1, 7}, 0.1, kRed);
  screen.triangle({1, 1}, {7, 1}, {-inf, 7}, 0.1, kRed);
  screen.triangle({1, 1, nan}, {7, 1, 0.1}, {1, 7, 0.1}, kRed);
  screen.triangle({1e-40, 1e-45}, {7.5, 1e-42}, {1e-44, 6.25}, 0.5, kGreen);
  return {
      "not_finite", "vertices that are NaN or infinite (dropped), and denormal ones", screen.trace(), {}, full_masks()};
}

HardCase empty_frame() {
  Screen screen(5, 3);
  HardCase result{"empty", "no triangle", {}, {}, {}};
  result.trace = screen.trace();
  result.everywhere = glm::dvec4(glm::dvec3(kBackground), 0.0);
  return result;
}

HardCase one_pixel() {
  Screen screen(1, 1);
  screen.triangle({-0.3, 0.1}, {1.2, 0.4}, {0.3, 1.7}, 0.5, kRed);
  return {"one_pixel",
          "a viewport of 1 x 1",
          screen.trace(),
          {},
          {{"dvm", {0.3, "its 2x2 quad reaches beyond the frame"}}}};
}

HardCase widest(std::uint32_t width, std::uint32_t height, const std::string& name, int edges_in_a_pixel) {
  Screen screen(width, height);
  screen.triangle({width - 3.2, height * 0.1}, {width - 0.1, height * 0.5}, {width - 2.9, height * 0.9}, 0.5, kRed);
  return {name,
          "a viewport of " + std::to_string(width) + " x " + std::to_string(height),
          screen.trace(),
          {},
          full_masks(edges_in_a_pixel)};
}

HardCase deep_pixel(int layers) {
  Screen screen(1, 1);
  for (int i = layers; i-- > 0;)
    screen.triangle({-1, -1}, {3, -1}, {-1, 3}, static_cast<double>(i + 1) / (layers + 2), i == 0 ? kRed : kBlue);
  HardCase result{"deep_pixel_" + std::to_string(layers),
                  std::to_string(layers) + " fragments that cover one pixel, far to near",
                  {},
                  {},
                  {}};
  result.everywhere = glm::dvec4(glm::dvec3(kRed), 1.0);
  result.trace = screen.trace();
  return result;
}

}  // namespace

double largest_cut(int positions) {
  switch (positions) {
    case 32:
      return 0.0441;
    case 64:
      return 0x1p-5;
    default:
      return 0x1p-6;
  }
}

std::vector<HardCase> hard_cases(bool with_heavy) {
  std::vector<HardCase> cases = {slivers(),
                                 specks(),
                                 large(),
                                 corners(),
                                 through_samples(),
                                 edge_on(),
                                 shared_edges(),
                                 fan_10000(),
                                 tiled_pixel(),
                                 fp16_sums(),
                                 near_plane(),
                                 guard_band(1, "guard_band", "vertices millions of pixels outside"),
                                 guard_band(1e6, "guard_band_far", "vertices 10^13 pixels outside"),
                                 wide_coordinates(),
                                 depth_range(),
                                 depth_range_turned(),
                                 coincident(),
                                 coplanar(),
                                 grazing(),
                                 not_finite(),
                                 empty_frame(),
                                 one_pixel(),
                                 widest(16384, 2, "widest", 1),
                                 widest(2, 16384, "highest", 1),
                                 deep_pixel(5000)};
  for (HardCase& hard_case : cases)
    hard_case.limits["dvm:material=draw"] = {0.75, "triangles of a draw share the colours of a quad's four samples"};
  if (with_heavy) {
    cases.push_back(deep_pixel(1'000'000));
    // Its sides are so steep that for many rows both lie near the borders of one column of pixels.
    cases.push_back(widest(16384, 16384, "widest_and_highest", 2));
  }
  return cases;
}

}  // namespace beampipe
