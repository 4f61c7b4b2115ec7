#include "pipeline/units/sample_places.h"

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
  return {place.x, place.y, sampling_.grid.shading_width()};
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

void SamplePlaces::add_texels(const SampleFragment& fragment, TexelRequests& texels,
                              std::vector<Invocation>& of_programs) const {
  const SurfaceShader& shader = bin_.context.shader;
  if (shader.is_flat(fragment.triangle)) return;
  const glm::vec2 place = of(fragment);
  const CellGrid& grid = sampling_.grid;
  const ShadingPlace there{grid.pixel_x(fragment.x), grid.pixel_y(fragment.y), place.x, place.y};
  const float width = sampling_.grid.shading_width();
  if (shader.is_program(fragment.triangle)) {
    of_programs.push_back({fragment.triangle, there, width});
  } else {
    shader.add_texels(fragment.triangle, there, width, texels);
  }
}

void SamplePlaces::add_texels(std::uint32_t triangle, std::size_t cell, TexelRequests& texels) const {
  const auto cells = static_cast<std::size_t>(sampling_.grid.cells_per_pixel());
  const CellPlace place = of(triangle, cell);
  bin_.shader().add_texels(triangle, static_cast<std::uint32_t>(cell / cells), place.u, place.v, place.width, texels);
  texels.end_request();
}

void SamplePlaces::add_quad_texels(const std::vector<SampleFragment>& fragments, TexelRequests& texels) const {
  const SamplePlaces helpers(bin_, sampling_, at_ == ShadeAt::centroid ? ShadeAt::centre : at_);
  std::vector<Invocation> of_programs;
  for (std::size_t first = 0, end = 0; first < fragments.size(); first = end) {
    std::uint32_t covered = 0;  // bit for each cell of the quad
    for (; end < fragments.size() && fragments[end].quad == fragments[first].quad; ++end) {
      covered |= 1u << ((fragments[end].y & 1) * 2 + (fragments[end].x & 1));
      add_texels(fragments[end], texels, of_programs);
    }
    SampleFragment helper = fragments[first];
    for (std::int32_t cell = 0; cell < 4; ++cell) {
      if (covered >> cell & 1) continue;
      helper.x = (fragments[first].x & ~1) + cell % 2, helper.y = (fragments[first].y & ~1) + cell / 2;
      helpers.add_texels(helper, texels, of_programs);
    }
    texels.end_request();
  }
  bin_.context.shader.add_program_texels(of_programs, texels);
}

}  // namespace beampipe
