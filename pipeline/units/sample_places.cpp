#include "pipeline/units/sample_places.h"

#include <algorithm>

namespace beampipe {

CellPlace SamplePlaces::of(std::uint32_t triangle, std::size_t cell) const {
  const CellGrid& grid = sampling_.grid;
  const auto cells = static_cast<std::size_t>(grid.cells_per_pixel());
  const auto pixel = static_cast<std::int32_t>(cell / cells), in_pixel = static_cast<std::int32_t>(cell % cells);
  const std::int32_t width = bin_.tile.width();
  SampleFragment fragment{};
  fragment.triangle = triangle;
  fragment.x = (bin_.tile.x0 + pixel % width) * grid.columns + in_pixel % grid.columns;
  fragment.y = (bin_.tile.y0 + pixel / width) * grid.rows + in_pixel / grid.columns;
  if (at_ == ShadeAt::centroid)
    fragment.mask = covered_samples(bin_.triangles().triangles[triangle], fragment, sampling_);
  const glm::vec2 place = of(fragment);
  return {place.x, place.y, 1.0f / static_cast<float>(std::min(grid.columns, grid.rows))};
}

glm::vec2 SamplePlaces::of(const SampleFragment& fragment) const {
  const glm::dvec2 point =
      shading_point(bin_.triangles().triangles[fragment.triangle], fragment, sampling_, at_).position;
  return glm::vec2(point - glm::dvec2(sampling_.grid.pixel_x(fragment.x), sampling_.grid.pixel_y(fragment.y)));
}

std::vector<glm::vec2> SamplePlaces::of(const std::vector<SampleFragment>& fragments) const {
  std::vector<glm::vec2> places;
  places.reserve(fragments.size());
  for (const SampleFragment& fragment : fragments)
    places.push_back(bin_.context.shader.is_flat(fragment.triangle) ? glm::vec2(0.5f) : of(fragment));
  return places;
}

}  // namespace beampipe
