// Cases of the state that draws of captured programs have: scissors, viewports, culling, depth ranges, biases,
// functions and clears. What their pictures are follows by hand: each pixel shows one colour or the background.
#include "tools/stress/case_parts.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kSide = 16;  // of the pictures, in pixels

// Covers the picture: sides pass far from it.
void cover(Screen& screen, double z, const glm::vec3& color, double z_right = -1) {
  const double slope = (z_right < 0 ? 0 : z_right - z) / kSide;
  screen.triangle({-20, -20, z - 20 * slope}, {60, -20, z + 60 * slope}, {-20, 60, z - 20 * slope}, color);
}

// The picture of color(x, y) for each pixel; none: the background.
template <class Color>
ExactPicture picture_of(Color&& color) {
  ExactPicture picture;
  picture.high = glm::ivec2(kSide);
  for (int y = 0; y < static_cast<int>(kSide); ++y)
    for (int x = 0; x < static_cast<int>(kSide); ++x) {
      const std::optional<glm::vec3> found = color(x, y);
      picture.rgba.emplace_back(glm::dvec3(found.value_or(kBackground)), found ? 1.0 : 0.0);
    }
  return picture;
}

HardCase of(const std::string& name, const std::string& what, Screen& screen, ExactPicture picture) {
  return {name, what, screen.trace(), std::move(picture), {}};
}

using Color = std::optional<glm::vec3>;

bool is_in(int x, int y, const glm::ivec4& box) { return x >= box.x && y >= box.y && x < box.z && y < box.w; }

// Where clipping cuts a triangle into several, they meet in an edge inside of a pixel.
HardCase with_pieces(HardCase result) {
  result.limits[ErrorSource::independent_fragments] = {
      0.25, "two pieces of a triangle share a pixel, which OVER takes for independent"};
  result.limits[ErrorSource::published_merges] = {0.25, kCasav};
  return result;
}

HardCase scissor() {
  Screen screen(kSide, kSide);
  cover(screen, 0.6, kGreen);
  DrawState state;
  state.scissor = Scissor{3, 5, 8, 7};
  screen.draw(state);
  cover(screen, 0.3, kRed);
  return with_pieces(of("scissor", "a triangle over the picture that a scissor cuts to 8 x 7 pixels", screen,
                        picture_of([](int x, int y) {
                          return Color(is_in(x, y, {3, 5, 11, 12}) ? kRed : kGreen);
                        })));
}

HardCase viewport(bool upside_down) {
  Screen screen(kSide, kSide);
  DrawState state;
  state.viewport = upside_down ? Viewport{2, 12, 9, -8} : Viewport{2, 4, 9, 8};
  state.front_is_clockwise = upside_down;
  screen.draw(state, Cull::back);
  screen.triangle({-20, -20}, {-20, 60}, {60, -20}, 0.5, kRed);
  return with_pieces(of(
      upside_down ? "viewport_turned" : "viewport",
      std::string("a viewport of 9 x 8 pixels") + (upside_down ? ", upside down, so that the front is clockwise" : ""),
      screen, picture_of([](int x, int y) {
        return is_in(x, y, {2, 4, 11, 12}) ? Color(kRed) : std::nullopt;
      })));
}

// Rows of four: counter-clockwise and clockwise, with the front counter-clockwise and clockwise.
HardCase culling() {
  Screen screen(kSide, kSide);
  constexpr Cull kCulls[] = {Cull::none, Cull::back, Cull::front};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      DrawState state;
      state.front_is_clockwise = column >= 2;
      state.scissor = Scissor{column * 4, row * 4, 3, 3};
      screen.draw(state, kCulls[row]);
      const glm::dvec2 a(-20, -20), b(60, -20), c(-20, 60);
      column % 2 ? screen.triangle(a, b, c, 0.5, kRed) : screen.triangle(a, c, b, 0.5, kRed);
    }
  return with_pieces(
      of("culling", "both windings, both fronts and all ways to cull", screen, picture_of([](int x, int y) {
           const int row = y / 4, column = x / 4;
           if (x % 4 == 3 || y % 4 == 3 || row == 3) return Color();
           const bool is_front = (column % 2 == 0) == (column < 2);
           return row == 0 || (row == 1) == is_front ? Color(kRed) : Color();
         })));
}

// Window depths: 0.45 (red), 0.4 (green, from a clip depth behind red's), 0.35 (blue, whose range is turned around).
HardCase depth_ranges() {
  Screen screen(kSide, kSide);
  const auto in_range = [&](float near, float far, int left) {
    DrawState state;
    state.depth.near = near, state.depth.far = far;
    state.scissor = Scissor{left, 0, kSide, kSide};
    screen.draw(state);
  };
  in_range(0, 1, 0), cover(screen, 0.45, kRed);
  in_range(0, 0.5f, 5), cover(screen, 0.8, kGreen);
  in_range(1, 0, 10), cover(screen, 0.65, kBlue);
  return with_pieces(of("depth_ranges", "ranges 0..1, 0..0.5 and 1..0, which decide who is nearest", screen,
                        picture_of([](int x, int) { return Color(x < 5    ? kRed
                                                                 : x < 10 ? kGreen
                                                                          : kBlue); })));
}

// On one plane, which is tilted: the bias decides who is in front.
HardCase depth_bias() {
  Screen screen(kSide, kSide);
  cover(screen, 0.4, kRed, 0.42);
  const auto with_bias = [&](const DepthBias& bias, int left) {
    DrawState state;
    state.depth.bias = bias;
    state.scissor = Scissor{left, 0, 4, kSide};
    screen.draw(state);
    cover(screen, 0.4, kGreen, 0.42);
  };
  with_bias({.constant = 0x1p-18f}, 0);
  with_bias({.constant = -0x1p-18f}, 4);
  with_bias({.slope = -0.01f}, 8);
  with_bias({.constant = 0.25f, .slope = 1, .clamp = -0x1p-18f}, 12);  // a negative clamp is a lower bound
  HardCase result =
      with_pieces(of("depth_bias", "equal planes that constant and slope biases put behind or in front", screen,
                     picture_of([](int x, int) { return Color(x < 4 || x >= 12 ? kRed : kGreen); })));
  for (const ErrorSource source : {ErrorSource::independent_fragments, ErrorSource::merges_one_by_one})
    result.limits[source] = {0.75,
                             "fragments have one depth each, and pieces of one plane differ by more than the bias"};
  return result;
}

// Three equal triangles: with less_equal the last one wins.
HardCase depth_functions() {
  Screen screen(kSide, kSide);
  const auto with = [&](Compare function, double z, const glm::vec3& color, int left, int width) {
    DrawState state;
    state.depth.function = function;
    state.scissor = Scissor{left, 0, static_cast<std::uint32_t>(width), kSide};
    screen.draw(state);
    cover(screen, z, color);
  };
  with(Compare::less_equal, 0.5, kRed, 0, 16);
  with(Compare::less_equal, 0.5, kGreen, 4, 12);
  with(Compare::less_equal, 0.5, kBlue, 8, 8);
  with(Compare::less_equal, 0.25, kRed, 12, 4);
  HardCase result = with_pieces(of("depth_functions", "equal triangles with less_equal, of which the last one wins",
                                   screen, picture_of([](int x, int) {
                                     return Color(x < 4 ? kRed : x < 8 ? kGreen : x < 12 ? kBlue : kRed);
                                   })));
  result.limits[ErrorSource::double_counting] = {3 * 0.75, kTwice};
  return result;
}

HardCase depth_clear() {
  Screen screen(kSide, kSide);
  cover(screen, 0.1, kRed);
  DrawState state;
  state.depth.cleared_before = true;
  state.scissor = Scissor{0, 0, 8, kSide};
  screen.draw(state);
  cover(screen, 0.9, kGreen);
  state.depth.cleared_before = false;
  state.scissor = Scissor{4, 0, 8, kSide};
  screen.draw(state);
  cover(screen, 0.95, kBlue);
  return with_pieces(of("depth_clear", "what follows a clear of the depth buffer is in front of all before", screen,
                        picture_of([](int x, int) { return Color(x < 8    ? kGreen
                                                                 : x < 12 ? kBlue
                                                                          : kRed); })));
}

// Beyond the far plane, where the depth of the plane counts; and a backdrop that is painted first and tests no depth.
HardCase depth_clip_off() {
  Screen screen(kSide, kSide);
  DrawState painted;
  painted.depth.test = painted.depth.write = false;
  screen.draw(painted);
  cover(screen, 0.01, kBlue);
  DrawState state;
  state.depth.clip = false;
  state.depth.function = Compare::less_equal;  // the far plane is where depth is cleared to
  state.scissor = Scissor{4, 0, 12, kSide};
  screen.draw(state);
  cover(screen, 1.5, kGreen);
  state.depth.clip = true;
  state.scissor = Scissor{8, 0, 4, kSide};
  screen.draw(state);
  cover(screen, 0.999, kRed);
  state.scissor = Scissor{12, 0, 4, kSide};
  screen.draw(state);
  cover(screen, 1.5, kRed);
  return with_pieces(of("depth_clip_off", "beyond the far plane, clipped and not, over a backdrop without depth",
                        screen, picture_of([](int x, int) {
                          return Color(x < 4 ? kBlue : x < 8 ? kGreen : x < 12 ? kRed : kGreen);
                        })));
}

}  // namespace

std::vector<HardCase> state_cases() {
  return {scissor(),    viewport(false),   viewport(true), culling(),       depth_ranges(),
          depth_bias(), depth_functions(), depth_clear(),  depth_clip_off()};
}

}  // namespace beampipe
