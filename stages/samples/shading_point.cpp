#include "stages/samples/shading_point.h"

#include "stages/samples/sample_formulas.h"
#include "stages/samples/shading_point_cost.h"

namespace beampipe {

std::uint32_t covered_samples(const SetupTriangle& triangle, const SampleFragment& fragment, const Sampling& sampling) {
  const std::int64_t left = std::int64_t{fragment.x} * sampling.grid.cell_width(),
                     top = std::int64_t{fragment.y} * sampling.grid.cell_height();
  std::uint32_t mask = (1u << sampling.pattern.count) - 1;
  for (int k = 0; k < 3; ++k) {
    const Edge edge = edge_of(triangle, k);
    for (int s = 0; s < sampling.pattern.count; ++s)
      if (!is_inside<std::int64_t>({edge.a, edge.b, edge.c}, left + sampling.pattern.x[s], top + sampling.pattern.y[s],
                                   edge.owns ? 0 : 1))
        mask &= ~(1u << s);
  }
  return mask;
}

ShadingPoint shading_point(const SetupTriangle& triangle, const SampleFragment& fragment, const Sampling& sampling,
                           ShadeAt at) {
  const std::int64_t left = std::int64_t{fragment.x} * sampling.grid.cell_width(),
                     top = std::int64_t{fragment.y} * sampling.grid.cell_height();
  if (at == ShadeAt::sample)
    return {glm::dvec2(left + sampling.pattern.x[0], top + sampling.pattern.y[0]) / double{kSubpixelUnits}, true};
  const CellGrid& grid = sampling.grid;
  const std::int64_t x = left + grid.cell_width() / 2, y = top + grid.cell_height() / 2;
  bool covered = true;
  for (int k = 0; k < 3; ++k) {
    const Edge edge = edge_of(triangle, k);
    covered &= is_inside<std::int64_t>({edge.a, edge.b, edge.c}, x, y, edge.owns ? 0 : 1);
  }
  if (covered || at == ShadeAt::centre)
    return {glm::dvec2(grid.pixel_x(fragment.x), grid.pixel_y(fragment.y)) +
                glm::dvec2(middle_in_pixel(grid, fragment.x, fragment.y)),
            true};

  std::uint32_t bits[kMaxMaskSamples];
  float xs[kMaxMaskSamples], ys[kMaxMaskSamples];
  for (std::size_t s = 0; s < kMaxMaskSamples; ++s) {
    bits[s] = 1u << s;
    xs[s] = static_cast<float>(sampling.pattern.x[s]), ys[s] = static_cast<float>(sampling.pattern.y[s]);
  }
  const Position<float> mean = mean_position(fragment.mask, bits, xs, ys, sampling.pattern.count);
  return {(glm::dvec2(left, top) + glm::dvec2(mean.x, mean.y)) / double{kSubpixelUnits}, false};
}

void count_centroids(const SetupTriangles& triangles, const std::vector<SampleFragment>& fragments, const Tile& tile,
                     const Sampling& sampling, StageCounters& counters, std::vector<float>& centroids) {
  std::uint64_t moved = 0;
  for (const SampleFragment& fragment : fragments) {
    if (shading_point(triangles.triangles[fragment.triangle], fragment, sampling, ShadeAt::centroid).is_centre)
      continue;
    ++centroids[tile.index(sampling.grid.pixel_x(fragment.x), sampling.grid.pixel_y(fragment.y))];
    ++moved;
  }
  charge_shading_points(fragments.size(), moved, sampling.pattern.count, counters);
}

}  // namespace beampipe
