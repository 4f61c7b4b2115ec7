#include "stages/samples/blend.h"

#include "simd/depth_compare.h"
#include "stages/data/pixel_depth.h"
#include "stages/samples/blend_cost.h"

namespace beampipe {
namespace {

// RGB, not premultiplied, and alpha.
void put_over(const glm::vec4& color, glm::vec4& there) {
  const glm::vec4 source(glm::vec3(color) * color.a, color.a);
  for (int c = 0; c < 4; ++c) there[c] = blended(source[c], there[c], source.a);
}

}  // namespace

void blend(const SampledTriangles& in, const TileShader& shader, const PlacedFragments& fragments,
           StageCounters& counters, SampleTile& surface, std::vector<SampleAccess>& accesses) {
  const auto& [triangles, tile, sampling] = in;
  const CellGrid& grid = sampling.grid;
  const double cell_width = 1.0 / grid.columns, cell_height = 1.0 / grid.rows;
  const auto samples = static_cast<std::size_t>(sampling.pattern.count);
  const auto pixel_of = [&](const SampleFragment& fragment) {
    return in.tile.index(grid.pixel_x(fragment.x), grid.pixel_y(fragment.y));
  };
  std::vector<Invocation> invocations;
  for (std::size_t i = 0; i < fragments.list.size(); ++i)
    invocations.push_back({fragments.list[i].triangle,
                           shader.place(static_cast<std::uint32_t>(pixel_of(fragments.list[i])), fragments.places[i].x,
                                        fragments.places[i].y),
                           grid.shading_width()});
  const std::vector<glm::vec4> colors = shader.colors_alone(invocations);
  SampleCounts counts{};
  accesses.clear();
  for (std::size_t i = 0; i < fragments.list.size(); ++i) {
    const SampleFragment& fragment = fragments.list[i];
    const std::size_t pixel = pixel_of(fragment);
    const std::uint32_t cell = cell_number(fragment, tile, grid);
    const CellPlane<float> plane =
        cell_plane(triangles.triangles[fragment.triangle].depth, fragment.x * cell_width, fragment.y * cell_height);
    const glm::vec4& color = colors[i];
    SampleAccess access{cell, fragment.triangle, fragment.mask, 0};
    PixelObserver* const observer = observer_at(surface.observers, pixel);
    const std::size_t first = surface.first_observed + cell * samples - pixel * surface.samples_per_pixel;
    for (std::size_t s = 0; s < samples; ++s) {
      if (!(fragment.mask >> s & 1)) continue;
      ++counts.tested;
      const std::size_t at = cell * samples + s;
      float depth;
      if (!depth_test_scalar(plane, static_cast<float>(sampling.pattern.x[s]),
                             static_cast<float>(sampling.pattern.y[s]), surface.depth[at], depth))
        continue;
      access.passed |= 1u << s;
      ++counts.passed;
      if (observer) observer->blends(fragment.triangle, first + s, color.a, glm::vec3(color));
      put_over(color, surface.over[at]);
    }
    if (observer) observer->contends(fragment.triangle, first, access.tested & ~access.passed, 0);
    accesses.push_back(access);
  }
  const std::uint32_t channels = surface.color_bytes == kSampleColorBytes ? 3 : 4;
  charge_blend(fragments.list.size(), counts, channels, surface.color_bytes, sampling.pattern, counters);
}

void blend(const SampledTriangles& in, const TileShader& shader, const PlacedFragments& fragments,
           const DepthsOfOneSample& tested, StageCounters& counters, Accumulator& accumulator) {
  const auto& [depth, sample, accesses] = tested;
  const SamplePattern& pattern = in.sampling.pattern;
  const std::uint32_t bit = 1u << sample;
  SampleCounts counts{fragments.list.size(), 0};
  accesses.clear();
  for (std::size_t i = 0; i < fragments.list.size(); ++i) {
    const auto& [triangle, quad, x, y, mask, own_depth] = fragments.list[i];
    const std::size_t pixel = in.tile.index(x, y);
    const CellPlane<float> plane = cell_plane(in.triangles.triangles[triangle].depth, double(x), double(y));
    float ignored;
    const bool passes = depth_test_scalar(plane, static_cast<float>(pattern.x[0]), static_cast<float>(pattern.y[0]),
                                          depth.depth[pixel * depth.samples_per_pixel + sample], ignored);
    accesses.push_back({static_cast<std::uint32_t>(pixel), triangle, bit, passes ? bit : 0});
    PixelObserver* const observer = observer_at(depth.observers, pixel);
    if (!passes) {
      if (observer) observer->contends(triangle, depth.first_observed, bit, 0);
      continue;
    }
    ++counts.passed;
    const glm::vec2& place = fragments.places[i];
    const glm::vec4 color = shader.color_and_alpha(triangle, static_cast<std::uint32_t>(pixel), place.x, place.y, 1.0f);
    glm::vec4& sum = accumulator.color[pixel];
    put_over(color, sum);
    for (int c = 0; c < 4; ++c) sum[c] = rounded_to(accumulator.format, sum[c]);
    accumulator.background[pixel] *= 1 - color.a;
    if (observer) observer->goes_over(triangle, depth.first_observed + sample, color.a, glm::vec3(color));
  }
  constexpr std::uint32_t kChannels = 4;
  charge_blend(fragments.list.size(), counts, kChannels, accumulator_bytes(accumulator.format), pattern, counters);
}

}  // namespace beampipe
