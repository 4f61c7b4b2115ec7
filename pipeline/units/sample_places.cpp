#include "pipeline/units/sample_places.h"

#include <utility>

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
  // Without the triangle's edges: these are most of a picture's fragments.
  if (at_ == ShadeAt::centre) return middle_in_pixel(sampling_.grid, fragment.x, fragment.y);
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

Invocation SamplePlaces::invocation(const SampleFragment& fragment) const {
  const bool is_flat = bin_.context.shader.is_flat(fragment.triangle);
  const glm::vec2 place = is_flat ? glm::vec2(0.5f) : of(fragment);
  const CellGrid& grid = sampling_.grid;
  return {
      fragment.triangle, {grid.pixel_x(fragment.x), grid.pixel_y(fragment.y), place.x, place.y}, grid.shading_width()};
}

void SamplePlaces::add_texels(std::uint32_t triangle, std::size_t cell, TexelRequests& texels) const {
  const auto cells = static_cast<std::size_t>(sampling_.grid.cells_per_pixel());
  const CellPlace place = of(triangle, cell);
  bin_.shader().add_texels(triangle, static_cast<std::uint32_t>(cell / cells), place.u, place.v, place.width, texels);
  texels.end_request();
}

SamplePlaces::OfPrograms SamplePlaces::add_quad_texels_of_materials(const std::vector<SampleFragment>& fragments,
                                                                    TexelRequests& texels) const {
  const SurfaceShader& shader = bin_.context.shader;
  const SamplePlaces helpers(bin_, sampling_, at_ == ShadeAt::centroid ? ShadeAt::centre : at_);
  OfPrograms found;
  std::vector<Invocation> counted;  // whose requests are not kept
  const auto add = [&](const SamplePlaces& places, const SampleFragment& fragment, std::vector<Invocation>& programs) {
    if (shader.is_flat(fragment.triangle)) return;
    const Invocation there = places.invocation(fragment);
    if (shader.is_program(fragment.triangle)) {
      programs.push_back(there);
    } else if (!texels.are_kept()) {
      counted.push_back(there);
    } else {
      shader.add_texels(there.triangle, there.place, there.footprint, texels);
    }
  };
  for (std::size_t first = 0, end = 0; first < fragments.size(); first = end) {
    std::uint32_t covered = 0;  // bit for each cell of the quad
    for (; end < fragments.size() && fragments[end].quad == fragments[first].quad; ++end) {
      covered |= 1u << ((fragments[end].y & 1) * 2 + (fragments[end].x & 1));
      add(*this, fragments[end], found.fragments);
    }
    SampleFragment helper = fragments[first];
    for (std::int32_t cell = 0; cell < 4; ++cell) {
      if (covered >> cell & 1) continue;
      helper.x = (fragments[first].x & ~1) + cell % 2, helper.y = (fragments[first].y & ~1) + cell / 2;
      add(helpers, helper, found.helpers);
    }
    texels.end_request();
  }
  shader.count_texels(counted, texels);
  return found;
}

void SamplePlaces::add_quad_texels(const std::vector<SampleFragment>& fragments, TexelRequests& texels) const {
  OfPrograms programs = add_quad_texels_of_materials(fragments, texels);
  programs.fragments.insert(programs.fragments.end(), programs.helpers.begin(), programs.helpers.end());
  bin_.context.shader.add_program_texels(programs.fragments, texels);
}

std::vector<glm::vec4> SamplePlaces::shade_quads(const std::vector<SampleFragment>& fragments,
                                                 TexelRequests* texels) const {
  const SurfaceShader& shader = bin_.context.shader;
  OfPrograms noted;
  if (texels) noted = add_quad_texels_of_materials(fragments, *texels);
  struct Part {
    std::vector<Invocation> invocations;
    std::vector<std::size_t> numbers;  // of their fragments
  };
  Part programs{std::move(noted.fragments), {}}, others;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const std::uint32_t triangle = fragments[i].triangle;
    const bool is_program = !shader.is_flat(triangle) && shader.is_program(triangle);
    Part& part = is_program ? programs : others;
    part.numbers.push_back(i);
    if (!is_program || !texels) part.invocations.push_back(invocation(fragments[i]));
  }
  // Programs run once for their colours and their texels, and helpers come after what is wanted.
  programs.invocations.insert(programs.invocations.end(), noted.helpers.begin(), noted.helpers.end());
  std::vector<glm::vec4> colors(fragments.size());
  const auto shade = [&](const Part& part, TexelRequests* of_part) {
    const std::vector<glm::vec4> found = shader.colors_and_alphas(part.invocations, of_part);
    for (std::size_t k = 0; k < part.numbers.size(); ++k) colors[part.numbers[k]] = found[k];
  };
  shade(programs, texels);
  shade(others, nullptr);
  return colors;
}

}  // namespace beampipe
