#include "stages/picture/resolve.h"

#include <algorithm>

#include "simd/scalar.h"
#include "stages/cost/counting.h"
#include "stages/picture/shade.h"

namespace beampipe {
namespace {

inline constexpr std::uint64_t kImageBytes = 3 * 2;  // fp16 RGB

// What is seen of the background beside an aggregate. `color` is stored as fp16.
template <class Real>
void over_background(const Real color[3], Real alpha, const Real background[3], Real pixel[3]) {
  const Real rest = Real(1.0f) - alpha;
  for (int c = 0; c < 3; ++c) pixel[c] = converted(color[c]) + background[c] * rest;
}

OperationCounts over_background_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), color[3] = {one, one, one};
    Counted<float> pixel[3];
    over_background(color, one, color, pixel);
  });
}

// One channel's mean of a pixel's samples, which are stored as fp16: the twin of the sum over runs in resolve().
template <class Real>
Real box_filter(const std::vector<Real>& samples) {
  Real sum(0.0f);
  for (const Real& sample : samples) sum = sum + converted(sample);
  return sum * Real(1.0f / static_cast<float>(samples.size()));
}

OperationCounts box_filter_cost(std::size_t samples) {
  return count_operations([&](OperationCounts& counts) {
    for (int c = 0; c < 3; ++c) box_filter(std::vector<Counted<float>>(samples, Counted<float>(1.0f, counts)));
  });
}

}  // namespace

std::vector<PixelColor> pixel_colors(const std::vector<Aggregate>& aggregates) {
  std::vector<PixelColor> colors;
  colors.reserve(aggregates.size());
  for (const Aggregate& aggregate : aggregates)
    colors.push_back({aggregate.alpha, {aggregate.color[0], aggregate.color[1], aggregate.color[2]}});
  return colors;
}

std::vector<glm::vec4> resolve(const std::vector<PixelColor>& aggregates, const glm::vec3& background,
                               std::uint32_t stored_bytes, StageCounters& counters) {
  std::vector<glm::vec4> image;
  image.reserve(aggregates.size());
  for (std::size_t i = 0; i < aggregates.size(); ++i) {
    const float alpha = aggregates[i].alpha;
    glm::vec4& pixel = image.emplace_back(0.0f, 0.0f, 0.0f, alpha);
    over_background(&aggregates[i].color.x, alpha, &background.x, &pixel.x);
  }
  counters.items_in += aggregates.size();
  counters.items_out += aggregates.size();
  counters.ops += over_background_cost() * aggregates.size();
  counters.bytes_read += aggregates.size() * stored_bytes;
  counters.bytes_written += aggregates.size() * kImageBytes;
  counters.lanes_used += aggregates.size();
  counters.lanes_issued += aggregates.size();
  return image;
}

std::vector<glm::vec4> resolve(const SampleTile& surface, std::size_t pixels, const std::vector<glm::vec3>& colors,
                               const glm::vec3& background, StageCounters& counters) {
  const std::size_t samples = surface.samples_per_pixel;
  const glm::dvec3 clear = background;
  std::vector<glm::vec4> image;
  image.reserve(pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    // Runs of equal samples are added at once: the sum is that of a double-precision box filter either way.
    const std::uint32_t* owner = surface.triangle.data() + pixel * samples;
    glm::dvec3 sum(0.0);
    std::size_t covered = 0;
    for (std::size_t s = 0; s < samples;) {
      const std::uint32_t triangle = owner[s];
      std::size_t end = s + 1;
      while (end < samples && owner[end] == triangle) ++end;
      const auto run = static_cast<double>(end - s);
      sum += run * (triangle == kNoTriangle ? clear : glm::dvec3(colors[triangle]));
      if (triangle != kNoTriangle) covered += end - s;
      s = end;
    }
    const double share = 1.0 / static_cast<double>(samples);
    image.emplace_back(glm::vec3(sum * share), static_cast<float>(static_cast<double>(covered) * share));
  }
  counters.items_in += pixels * samples;
  counters.items_out += pixels;
  counters.ops += box_filter_cost(samples) * pixels;
  counters.bytes_read += pixels * samples * surface.color_bytes;
  counters.bytes_written += pixels * kImageBytes;
  counters.lanes_used += pixels * samples;
  counters.lanes_issued += pixels * samples;
  return image;
}

}  // namespace beampipe
