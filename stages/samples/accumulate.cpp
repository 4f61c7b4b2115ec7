#include "stages/samples/accumulate.h"

#include <algorithm>

#include "simd/population_count.h"
#include "stages/cost/charge_resolve.h"
#include "stages/samples/accumulate_cost.h"
#include "stages/samples/sample_formulas.h"

namespace beampipe {
namespace {

// Adds a triangle's colour for the samples in `mask`.
void add(Accumulator& accumulator, std::size_t pixel, std::uint32_t triangle, const glm::vec3& rgb,
         std::uint32_t mask) {
  const float color[4] = {rgb.r, rgb.g, rgb.b, 1.0f};
  glm::vec4& sum = accumulator.color[pixel];
  const float before = sum.a;
  add_weighted(color, bit_count(mask) * accumulator.sample_share,
               accumulator.double_counting == DoubleCounting::saturate, accumulator.limit, &sum.x);
  for (int c = 0; c < 4; ++c) sum[c] = rounded_to(accumulator.format, sum[c]);
  if (PixelObserver* const observer = observer_at(accumulator.observers, pixel)) {
    const bool saturates = accumulator.double_counting == DoubleCounting::saturate;
    observer->adds(triangle, saturates ? sum.a - before : bit_count(mask) * accumulator.sample_share, rgb);
  }
}

std::size_t pixel_of(const SampleFragment& fragment, const Tile& tile) { return tile.index(fragment.x, fragment.y); }

}  // namespace

void accumulate_background(const SampleTile& depth, const glm::vec3& background, StageCounters& counters,
                           Accumulator& accumulator) {
  const std::size_t samples = depth.samples_per_pixel;
  std::uint64_t pixels = 0;  // with a clear sample
  for (std::size_t pixel = 0; pixel < accumulator.color.size(); ++pixel) {
    std::uint32_t clear = 0;
    for (std::size_t s = 0; s < samples; ++s)
      clear |= std::uint32_t{depth.depth[pixel * samples + s] == kFarDepth} << s;
    if (clear == 0) continue;
    add(accumulator, pixel, kNobody, background, clear);
    accumulator.background[pixel] += bit_count(clear) * accumulator.sample_share;
    ++pixels;
  }
  charge_background(accumulator.color.size() * samples, pixels, accumulator, counters);
}

void stencil_test(const Tile& tile, StageCounters& counters, Accumulator& accumulator,
                  std::vector<SampleFragment>& fragments) {
  std::uint64_t tested = 0, passed = 0;  // samples
  for (SampleFragment& fragment : fragments) {
    std::uint32_t& taken = accumulator.taken[pixel_of(fragment, tile)];
    tested += population_count(fragment.mask);
    fragment.mask &= ~taken;
    taken |= fragment.mask;
    passed += population_count(fragment.mask);
  }
  std::erase_if(fragments, [](const SampleFragment& fragment) { return fragment.mask == 0; });
  charge_stencil_test(tested, passed, counters);
}

void accumulate(const std::vector<SampleFragment>& fragments, const TileShader& shader,
                const std::vector<glm::vec2>& places, const Tile& tile, StageCounters& counters,
                Accumulator& accumulator) {
  std::vector<Invocation> invocations;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const glm::vec2 place = places.empty() ? glm::vec2(0.5f) : places[i];
    invocations.push_back({fragments[i].triangle,
                           shader.place(static_cast<std::uint32_t>(pixel_of(fragments[i], tile)), place.x, place.y)});
  }
  const std::vector<glm::vec4> colors = shader.colors_alone(invocations);
  for (std::size_t i = 0; i < fragments.size(); ++i)
    add(accumulator, pixel_of(fragments[i], tile), fragments[i].triangle, glm::vec3(colors[i]), fragments[i].mask);
  charge_accumulate(fragments.size(), accumulator, counters);
}

std::vector<glm::vec4> resolve(const Accumulator& accumulator, const glm::vec3& background, StageCounters& counters) {
  std::vector<glm::vec4> image;
  image.reserve(accumulator.color.size());
  for (std::size_t i = 0; i < accumulator.color.size(); ++i) {
    const glm::vec4& sum = accumulator.color[i];
    glm::vec4& pixel = image.emplace_back(0.0f, 0.0f, 0.0f, std::clamp(sum.a - accumulator.background[i], 0.0f, 1.0f));
    sum_over_background(&sum.x, &background.x, &pixel.x);
    PixelObserver* const observer = observer_at(accumulator.observers, i);
    if (observer && sum.a < 1) observer->adds(kNobody, 1.0f - sum.a, background);
  }
  charge_resolve(image.size(), accumulator_bytes(accumulator.format), image.size(), accumulator_resolve_cost(),
                 counters);
  return image;
}

}  // namespace beampipe
