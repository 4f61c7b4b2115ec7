#include "stages/resolve.h"

#include <algorithm>

#include "stages/counting.h"
#include "stages/shade.h"

namespace beampipe {
namespace {

inline constexpr std::uint64_t kImageBytes = 3 * 2;  // fp16 RGB

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
  std::vector<glm::vec3> colors;
  colors.reserve(aggregates.size());
  for (const PixelColor& aggregate : aggregates) colors.push_back(aggregate.color);
  colors = round_to_half(std::move(colors));
  std::vector<glm::vec4> image;
  image.reserve(aggregates.size());
  for (std::size_t i = 0; i < aggregates.size(); ++i)
    image.emplace_back(colors[i] + background * (1.0f - aggregates[i].alpha), aggregates[i].alpha);
  counters.items_in += aggregates.size();
  counters.items_out += aggregates.size();
  counters.ops +=
      OperationCounts{3, 1, 0, 0, 0, 3} * aggregates.size();  // colour + background x (1 - alpha), from fp16
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
  counters.ops += OperationCounts{0, 3, 0, 0, 0, 3} * (pixels * samples);  // add each sample's colour, from fp16
  counters.ops += OperationCounts{3, 0, 0, 0, 0, 0} * pixels;              // times 1 / samples
  counters.bytes_read += pixels * samples * surface.color_bytes;
  counters.bytes_written += pixels * kImageBytes;
  counters.lanes_used += pixels * samples;
  counters.lanes_issued += pixels * samples;
  return image;
}

}  // namespace beampipe
