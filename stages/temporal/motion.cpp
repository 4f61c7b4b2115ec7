#include "stages/temporal/motion.h"

#include <half.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "simd/scalar.h"
#include "stages/cost/counting.h"
#include "stages/picture/shade.h"
#include "stages/samples/mix_bits.h"

namespace beampipe {
namespace {

// A position in pixels, in the last frame, of a point at (x, y) in normalized device coordinates and depth z. `m`:
// to_last_frame's, column-major.
template <class Real>
void reproject(const Real m[16], Real x, Real y, Real z, Real width, Real height, Real& last_x, Real& last_y, Real& w) {
  const auto row = [&](int r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]; };
  const Real one(1.0f), half(0.5f);
  w = row(3);
  const Real inverse = one / w;
  last_x = (row(0) * inverse + one) * half * width;
  last_y = (one - row(1) * inverse) * half * height;
}

// From a pixel's centre, in pixels, to where that was, and in front of the eye or not.
template <class Real>
bool move(const Real m[16], Real center_x, Real center_y, Real depth, Real width, Real height, Real& dx, Real& dy) {
  const Real zero(0.0), one(1.0), two(2.0);
  Real x, y, w;
  reproject(m, two * center_x / width - one, one - two * center_y / height, two * lesser(depth, zero) + one, width,
            height, x, y, w);
  dx = x - center_x, dy = y - center_y;
  return w > zero;
}

template <class Real>
Real square_length(Real x, Real y) {
  return x * x + y * y;
}

OperationCounts pixel_cost(std::size_t samples) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<double> one(1.0, counts);
    Counted<double> m[16], dx, dy;
    for (Counted<double>& element : m) element = one;
    for (std::size_t s = 1; s < samples; ++s) select(one < one, one, one);  // the nearest
    const std::uint32_t table[1] = {};
    const Counted<std::int32_t> index(0, counts);
    fetch(table, index), fetch(table, index);  // its draw; the draw's matrix
    move(m, one, one, one, one, one, dx, dy);
    converted(to_float(dx)), converted(to_float(dy));
  });
}

// Of a pixel: its samples' draws, each compared with those before it; the root of the greatest square, to fp16.
OperationCounts contents_cost(std::size_t samples) {
  return count_operations([&](OperationCounts& counts) {
    const std::uint32_t table[1] = {};
    const Counted<std::int32_t> index(0, counts);
    for (std::size_t s = 0; s < samples; ++s) fetch(table, index);
    for (std::size_t pair = 0; pair < samples * (samples - 1) / 2; ++pair) static_cast<void>(index == index);
    converted(square_root(Counted<float>(1.0f, counts)));
  });
}

// Of a draw in a pixel: its look and its matrix; where it was; the greater of two squares.
OperationCounts draw_cost() {
  return count_operations([](OperationCounts& counts) {
    const std::uint32_t table[1] = {};
    const Counted<std::int32_t> index(0, counts);
    fetch(table, index), fetch(table, index);
    static_cast<void>(Counted<std::uint32_t>(0, counts) ^
                      Counted<std::uint32_t>(0, counts));  // the look, into the others
    const Counted<double> one(1.0, counts);
    Counted<double> m[16], dx, dy;
    for (Counted<double>& element : m) element = one;
    move(m, one, one, one, one, one, dx, dy);
    const Counted<float> x(converted(to_float(dx))), y(converted(to_float(dy)));
    greater(x, square_length(x, y));
  });
}

constexpr std::uint32_t kHashStart = 0x9e3779b9u;  // not 0, which mix_bits leaves as it is

std::uint32_t hash(std::uint32_t state, const glm::vec3& color) {
  for (int c = 0; c < 3; ++c) state = mix_bits(state ^ std::bit_cast<std::uint32_t>(color[c]));
  return state;
}

// Whose sample i is: behind the draws, the background.
std::size_t draw_at(const SampleTile& surface, std::size_t i, const std::vector<std::uint32_t>& draws,
                    const Frame& frame) {
  const std::uint32_t triangle = surface.triangle[i];
  return triangle == kNoTriangle ? frame.draws.size() : draws[triangle];
}

glm::vec2 pixel_motion(const glm::dmat4& to_last, double center_x, double center_y, float depth, const Frame& frame) {
  double m[16];
  for (int i = 0; i < 16; ++i) m[i] = to_last[i / 4][i % 4];
  const double width = frame.width, height = frame.height;
  double dx = 0, dy = 0;
  if (!move<double>(m, center_x, center_y, depth, width, height, dx, dy))
    return glm::vec2(std::numeric_limits<float>::infinity());
  return {half(static_cast<float>(dx)), half(static_cast<float>(dy))};
}

}  // namespace

Poses poses_of(const Frame& frame) {
  Poses poses{frame.projection * frame.view, {}};
  for (const Draw& draw : frame.draws) poses.draws.push_back({draw.mesh, draw.transform});
  return poses;
}

std::vector<glm::dmat4> to_last_frame(const Poses& now, const Poses& before) {
  const glm::dmat4 to_world = glm::inverse(now.view_projection), still = before.view_projection * to_world;
  std::vector<glm::dmat4> matrices;
  for (std::size_t i = 0; i < now.draws.size(); ++i) {
    const Poses::Pose& pose = now.draws[i];
    const bool moved =
        i < before.draws.size() && before.draws[i].mesh == pose.mesh && before.draws[i].transform != pose.transform;
    matrices.push_back(
        moved ? before.view_projection * before.draws[i].transform * glm::inverse(pose.transform) * to_world : still);
  }
  matrices.push_back(still);
  return matrices;
}

std::vector<glm::vec2> motion(const SampleTile& surface, const Tile& tile, const Frame& frame,
                              const std::vector<std::uint32_t>& draws, const std::vector<glm::dmat4>& to_last,
                              StageCounters& counters) {
  const std::size_t samples = surface.samples_per_pixel;
  std::vector<glm::vec2> vectors;
  vectors.reserve(tile.pixels());
  for (std::int32_t y = tile.y0; y < tile.y1; ++y) {
    for (std::int32_t x = tile.x0; x < tile.x1; ++x) {
      const auto first = surface.depth.begin() + static_cast<std::ptrdiff_t>(vectors.size() * samples);
      const auto nearest = std::min_element(first, first + static_cast<std::ptrdiff_t>(samples));
      const auto at = static_cast<std::size_t>(nearest - surface.depth.begin());
      vectors.push_back(pixel_motion(to_last[draw_at(surface, at, draws, frame)], x + 0.5, y + 0.5, *nearest, frame));
    }
  }
  const std::size_t pixels = vectors.size();
  counters.items_in += pixels * samples;
  counters.items_out += pixels;
  counters.ops += pixel_cost(samples) * pixels;
  counters.bytes_read += pixels * (samples * kSampleDepthBytes + kVisibilityBytes);
  counters.bytes_written += pixels * kMotionBytes;
  counters.lanes_used += pixels;
  counters.lanes_issued += pixels;
  return vectors;
}

std::vector<std::uint32_t> looks_of(const Frame& frame) {
  std::vector<std::uint32_t> looks;
  for (const Draw& draw : frame.draws) {
    std::uint32_t look = mix_bits(mix_bits(kHashStart + static_cast<std::uint32_t>(looks.size())) ^ draw.mesh);
    if (draw.kd) look = hash(look, *draw.kd);
    if (draw.shading == Shading::lambert) {
      look = hash(look, frame.light_direction.value_or(glm::vec3(0.0f)));
      for (int axis = 0; axis < 3; ++axis) look = hash(look, glm::vec3(draw.transform[axis]));
    }
    looks.push_back(look);
  }
  looks.push_back(hash(mix_bits(~kHashStart), frame.background));
  return looks;
}

PixelContents contents(const SampleTile& surface, const Tile& tile, const Frame& frame,
                       const std::vector<std::uint32_t>& draws, const std::vector<glm::dmat4>& to_last,
                       const std::vector<std::uint32_t>& looks, StageCounters& counters) {
  const std::size_t samples = surface.samples_per_pixel;
  PixelContents found;
  std::uint64_t moved = 0;
  std::vector<std::size_t> here;
  for (std::int32_t y = tile.y0; y < tile.y1; ++y) {
    for (std::int32_t x = tile.x0; x < tile.x1; ++x) {
      here.clear();
      std::uint32_t look = 0;
      float fastest = 0;
      for (std::size_t i = found.looks.size() * samples, end = i + samples; i < end; ++i) {
        const std::size_t draw = draw_at(surface, i, draws, frame);
        if (std::find(here.begin(), here.end(), draw) != here.end()) continue;
        here.push_back(draw);
        look ^= looks[draw];
        const glm::vec2 moves = pixel_motion(to_last[draw], x + 0.5, y + 0.5, surface.depth[i], frame);
        fastest = greater(fastest, square_length(moves.x, moves.y));
      }
      found.looks.push_back(look);
      found.speeds.push_back(half(std::sqrt(fastest)));
      moved += here.size();
    }
  }
  const std::size_t pixels = found.looks.size();
  counters.ops += contents_cost(samples) * pixels;
  counters.ops += draw_cost() * moved;
  counters.bytes_read += pixels * samples * kVisibilityBytes;  // the depths are at hand
  counters.bytes_written += pixels * (kLookBytes + kSpeedBytes);
  return found;
}

}  // namespace beampipe
