#include "stages/picture/resolve.h"

#include "stages/picture/picture_formulas.h"
#include "stages/picture/resolve_cost.h"

namespace beampipe {

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
  for (const PixelColor& aggregate : aggregates) {
    glm::vec4& pixel = image.emplace_back(0.0f, 0.0f, 0.0f, aggregate.alpha);
    over_background(&aggregate.color.x, aggregate.alpha, &background.x, &pixel.x);
  }
  charge_resolve(image.size(), stored_bytes, image.size(), over_background_cost(), counters);
  return image;
}

std::vector<glm::vec4> resolve(const SampleTile& surface, std::size_t pixels, const TileShader& shader,
                               const glm::vec3& background, StageCounters& counters, std::size_t cells,
                               const CellPlaces& place_of, ResolveSpace space) {
  const std::size_t samples = surface.samples_per_pixel, samples_per_cell = samples / cells;
  const glm::dvec3 clear = background;
  std::vector<glm::vec4> image;
  image.reserve(pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    // Runs of equal samples are added at once. The sum is that of a box filter in double precision either way.
    const std::uint32_t* owner = surface.triangle.data() + pixel * samples;
    glm::dvec3 sum(0.0);
    double covered = 0;
    for (std::size_t s = 0; s < samples;) {
      const std::uint32_t triangle = owner[s];
      const bool is_same_everywhere = triangle == kNoTriangle || shader.is_flat(triangle);
      const std::size_t most = is_same_everywhere ? samples : s - s % samples_per_cell + samples_per_cell;
      const glm::vec4* const over = surface.over.empty() ? nullptr : &surface.over[pixel * samples];
      std::size_t end = s + 1;
      while (end < most && owner[end] == triangle && (!over || over[end] == over[s])) ++end;
      const auto run = static_cast<double>(end - s);
      CellPlace place{};
      if (!is_same_everywhere) place = place_of(triangle, pixel * cells + s / samples_per_cell);
      const double seen = over ? 1.0 - double{over[s].a} : 1.0;  // of the opaque surface
      const glm::dvec3 opaque =
          triangle == kNoTriangle
              ? clear
              : glm::dvec3(shader.color(triangle, static_cast<std::uint32_t>(pixel), place.u, place.v, place.width));
      if (space == ResolveSpace::reinhard) {
        glm::dvec3 color = seen * opaque;
        if (over) color += glm::dvec3(over[s]);
        compress(&color.x);
        sum += run * color;
      } else {
        if (over) sum += run * glm::dvec3(over[s]);
        sum += run * seen * opaque;
      }
      if (triangle != kNoTriangle) {
        covered += run;
      } else if (over) {
        covered += run * double{over[s].a};
      }
      s = end;
    }
    const double share = 1.0 / static_cast<double>(samples);
    glm::dvec3 mean = sum * share;
    if (space == ResolveSpace::reinhard) expand(&mean.x);
    image.emplace_back(glm::vec3(mean), static_cast<float>(covered * share));
  }
  OperationCounts cost = box_filter_cost(samples);
  if (space == ResolveSpace::reinhard) cost += reinhard_cost(samples);
  charge_resolve(pixels * samples, surface.color_bytes, pixels, cost, counters);
  return image;
}

}  // namespace beampipe
