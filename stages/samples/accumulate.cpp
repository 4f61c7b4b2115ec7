#include "stages/samples/accumulate.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "simd/scalar.h"
#include "stages/cost/counting.h"
#include "stages/data/half_bits.h"
#include "stages/raster/raster_cost.h"

namespace beampipe {
namespace {

constexpr std::uint64_t kStencilBytes = 1;  // per sample

float round_to(AccumulatorFormat format, float value) {
  switch (format) {
    case AccumulatorFormat::unorm8:
      return std::floor(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f) / 255.0f;
    case AccumulatorFormat::fp16:
      return HalfBits(value);
    default:
      return value;
  }
}

// dst + color x share, where saturated no more share than is missing. `color` and `sum`: R, G, B, A.
template <class Real>
void add_weighted(const Real color[4], Real share, bool saturate, Real limit, Real sum[4]) {
  if (saturate) share = greater(lesser(share, limit - sum[3]), Real(0.0f));
  for (int c = 0; c < 4; ++c) sum[c] = sum[c] + color[c] * share;
}

// From the accumulator's format and back, four channels.
template <class Real>
void convert_sum(Real sum[4]) {
  for (int c = 0; c < 4; ++c) sum[c] = converted(sum[c]);
}

// Sums over the background, by what alpha leaves of it.
template <class Real>
void over_background(const Real sum[4], const Real background[3], Real pixel[3]) {
  const Real left = greater(Real(1.0f) - sum[3], Real(0.0f));
  for (int c = 0; c < 3; ++c) pixel[c] = sum[c] + background[c] * left;
}

OperationCounts resolve_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> sum[4] = {one, one, one, one}, pixel[3];
    convert_sum(sum);
    over_background(sum, sum, pixel);
  });
}

OperationCounts fragment_cost(bool saturate) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), color[4] = {one, one, one, one};
    Counted<float> sum[4] = {one, one, one, one};
    convert_sum(sum);
    add_weighted(color, bit_count(Counted<std::uint32_t>(1, counts)) * one, saturate, one, sum);
    convert_sum(sum);
  });
}

void add(Accumulator& accumulator, std::size_t pixel, const glm::vec3& rgb, std::uint32_t mask) {
  const float color[4] = {rgb.r, rgb.g, rgb.b, 1.0f};
  glm::vec4& sum = accumulator.color[pixel];
  add_weighted(color, bit_count(mask) * accumulator.sample_share,
               accumulator.double_counting == DoubleCounting::saturate, accumulator.limit, &sum.x);
  for (int c = 0; c < 4; ++c) sum[c] = round_to(accumulator.format, sum[c]);
}

void count(std::uint64_t fragments, const Accumulator& accumulator, StageCounters& counters) {
  const std::uint64_t bytes = accumulator_bytes(accumulator.format);
  counters.items_in += fragments;
  counters.items_out += fragments;
  counters.ops += fragment_cost(accumulator.double_counting == DoubleCounting::saturate) * fragments;
  counters.bytes_read += fragments * bytes;
  counters.bytes_written += fragments * bytes;
  counters.lanes_used += fragments;
  counters.lanes_issued += fragments;
}

std::size_t pixel_of(const SampleFragment& fragment, const Tile& tile) { return tile.index(fragment.x, fragment.y); }

}  // namespace

std::uint32_t accumulator_bytes(AccumulatorFormat format) {
  return format == AccumulatorFormat::unorm8 ? 4 : format == AccumulatorFormat::fp16 ? 8 : 16;
}

Accumulator::Accumulator(const Tile& tile, int samples, AccumulatorFormat accumulator_format, DoubleCounting counting)
    : format(accumulator_format),
      double_counting(counting),
      sample_share(1.0f / static_cast<float>(samples)),
      color(tile.pixels(), glm::vec4(0.0f)),
      background(tile.pixels(), 0.0f),
      taken(tile.pixels(), 0) {}

void accumulate_background(const SampleTile& depth, const glm::vec3& background, StageCounters& counters,
                           Accumulator& accumulator) {
  const std::size_t samples = depth.samples_per_pixel;
  std::uint64_t fragments = 0;
  for (std::size_t pixel = 0; pixel < accumulator.color.size(); ++pixel) {
    std::uint32_t clear = 0;
    for (std::size_t s = 0; s < samples; ++s)
      clear |= std::uint32_t{depth.depth[pixel * samples + s] == kFarDepth} << s;
    if (clear == 0) continue;
    add(accumulator, pixel, background, clear);
    accumulator.background[pixel] += bit_count(clear) * accumulator.sample_share;
    ++fragments;
  }
  counters.bytes_read += accumulator.color.size() * samples * kSampleDepthBytes;
  counters.ops.add += accumulator.color.size() * samples;  // comparisons
  count(fragments, accumulator, counters);
}

void stencil_test(const Tile& tile, StageCounters& counters, Accumulator& accumulator,
                  std::vector<SampleFragment>& fragments) {
  for (SampleFragment& fragment : fragments) {
    std::uint32_t& taken = accumulator.taken[pixel_of(fragment, tile)];
    const auto tested = static_cast<std::uint64_t>(std::popcount(fragment.mask));
    fragment.mask &= ~taken;
    taken |= fragment.mask;
    const auto passed = static_cast<std::uint64_t>(std::popcount(fragment.mask));
    counters.items_in += tested;
    counters.items_out += passed;
    counters.ops.add += tested;  // comparisons
    counters.bytes_read += tested * kStencilBytes;
    counters.bytes_written += passed * kStencilBytes;
    counters.lanes_used += tested;
    counters.lanes_issued += tested;
  }
  std::erase_if(fragments, [](const SampleFragment& fragment) { return fragment.mask == 0; });
}

void accumulate(const std::vector<SampleFragment>& fragments, const std::vector<glm::vec3>& colors, const Tile& tile,
                StageCounters& counters, Accumulator& accumulator) {
  for (const SampleFragment& fragment : fragments)
    add(accumulator, pixel_of(fragment, tile), colors[fragment.triangle], fragment.mask);
  counters.bytes_read += fragments.size() * (kSampleFragmentBytes + 6);  // and the shader's fp16 RGB
  count(fragments.size(), accumulator, counters);
}

std::vector<glm::vec4> resolve(const Accumulator& accumulator, const glm::vec3& background, StageCounters& counters) {
  std::vector<glm::vec4> image;
  image.reserve(accumulator.color.size());
  for (std::size_t i = 0; i < accumulator.color.size(); ++i) {
    const glm::vec4& sum = accumulator.color[i];
    glm::vec4& pixel = image.emplace_back(0.0f, 0.0f, 0.0f, std::clamp(sum.a - accumulator.background[i], 0.0f, 1.0f));
    over_background(&sum.x, &background.x, &pixel.x);
  }
  const std::size_t pixels = image.size();
  counters.items_in += pixels;
  counters.items_out += pixels;
  counters.ops += resolve_cost() * pixels;
  counters.bytes_read += pixels * accumulator_bytes(accumulator.format);
  counters.bytes_written += pixels * 6;  // fp16 RGB
  counters.lanes_used += pixels;
  counters.lanes_issued += pixels;
  return image;
}

}  // namespace beampipe
