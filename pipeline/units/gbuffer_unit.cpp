#include "pipeline/units/gbuffer_unit.h"

#include <cmath>

#include "pipeline/units/sample_places.h"
#include "stages/samples/material_sort.h"
#include "stages/samples/material_sort_cost.h"

namespace beampipe {
namespace {

std::vector<std::uint32_t> shown_samples(const std::vector<std::uint32_t>& triangles) {
  std::vector<std::uint32_t> samples;
  for (std::uint32_t sample = 0; sample < triangles.size(); ++sample)
    if (triangles[sample] != kNoTriangle) samples.push_back(sample);
  return samples;
}

std::vector<std::uint32_t> picked(const std::vector<std::uint32_t>& triangles,
                                  const std::vector<std::uint32_t>& samples) {
  std::vector<std::uint32_t> some;
  some.reserve(samples.size());
  for (const std::uint32_t sample : samples) some.push_back(triangles[sample]);
  return some;
}

}  // namespace

std::vector<std::uint32_t> sort_materials(Bin& bin, const std::vector<std::uint32_t>& triangles,
                                          const Materials& materials) {
  constexpr std::uint64_t kPlaceBytes = 4;  // of a sample, in the sorted list
  const BinStage sorting = bin.stage(StageId::material_sort), shading = bin.stage(StageId::shade);
  std::vector<std::uint32_t> order = material_sort(triangles, materials.ids, materials.digits, sorting.timed());
  const auto passes = static_cast<std::uint64_t>(materials.digits);
  sorting.streams(sort_item_bytes(order.size(), passes));
  sorting.moves_in_l2("sort_counts", sort_count_bytes(passes));
  shading.counters.bytes_read += order.size() * kPlaceBytes;
  shading.streams(order.size() * kPlaceBytes);
  return order;
}

GBufferUnit::GBufferUnit(Bin& bin, const Sampling& sampling)
    : bin_(bin),
      pattern_(sampling.pattern),
      samples_(static_cast<std::uint32_t>(sampling.pattern.count)),
      shading_(bin.stage(StageId::shade)),
      lighting_(bin.stage(StageId::light)),
      attributes_(bin.memory(), bin.surface_fetches()),
      gbuffer_(bin.memory(), "gbuffer", bin.z_order(), {.parts = samples_, .part_bytes = kGBufferBytes}) {}

// A sample stands for its share of the pixel's area.
CellPlace GBufferUnit::place_of(std::size_t sample) const {
  const std::size_t s = sample % samples_;
  return {static_cast<float>(pattern_.x[s]) / kSubpixelUnits, static_cast<float>(pattern_.y[s]) / kSubpixelUnits,
          1.0f / std::sqrt(static_cast<float>(samples_))};
}

// Writes each of the samples once, and ends the pass.
void GBufferUnit::write_samples(const std::vector<std::uint32_t>& samples, TileSurface& to,
                                StageCounters& counters) const {
  for (const std::uint32_t sample : samples) to.access(0, sample / samples_, 0, 1u << sample % samples_, counters);
  to.flush(counters);
}

void GBufferUnit::write_fragments(const std::vector<SampleFragment>& fragments, const DepthTestUnit& depth_test) {
  write_gbuffer(bin_.shader(), fragments, shading_.timed());
  if (TexelRequests* const texels = bin_.texels())
    SamplePlaces(bin_, depth_test.sampling(), ShadeAt::sample).add_quad_texels(fragments, *texels);
  bin_.charge_texels(shading_);
  attributes_.read(fragments, shading_.counters);
  for (const SampleAccess& access : depth_test.accesses())
    gbuffer_.access(access.triangle, access.cell, 0, access.passed, shading_.counters);
}

void GBufferUnit::write_visible(DepthTestUnit& visibility, const Materials& materials) {
  const std::vector<std::uint32_t> triangles = triangles_of(visibility.surface(), bin_.tile);
  visibility.read_colors(bin_.stage(StageId::material_sort));
  const std::vector<std::uint32_t> shown = sort_materials(bin_, triangles, materials);
  write_gbuffer(bin_.shader(), picked(triangles, shown), shading_.timed());
  if (TexelRequests* const texels = bin_.texels())
    for (const std::uint32_t sample : shown) {
      const CellPlace place = place_of(sample);
      bin_.shader().add_texels(triangles[sample], sample / samples_, place.u, place.v, place.width, *texels);
      texels->end_request();
    }
  bin_.charge_texels(shading_);
  visibility.read_colors(shading_);
  for (const std::uint32_t sample : shown) bin_.triangle_fetches().attributes(triangles[sample], shading_.counters);
  bin_.triangle_fetches().flush(shading_.counters);
  write_samples(shown, gbuffer_, shading_.counters);
}

std::vector<glm::vec4> GBufferUnit::light_and_resolve(DepthTestUnit& surface) {
  gbuffer_.flush(shading_.counters);  // the pass that wrote it ends
  const BinStage resolving = bin_.stage(StageId::resolve);
  const std::vector<std::uint32_t> triangles = triangles_of(surface.surface(), bin_.tile);
  const std::vector<std::uint32_t> shown = shown_samples(triangles);
  light(bin_.shader(), picked(triangles, shown), lighting_.timed());
  TileSurface color(bin_.memory(), "color", bin_.z_order(), {.parts = samples_, .part_bytes = kSampleColorBytes});
  gbuffer_.read_all(lighting_.counters);
  write_samples(shown, color, lighting_.counters);
  color.read_all(resolving.counters);
  if (bin_.models_memory()) {
    gbuffer_.add_bytes(bin_.pixel_counter("bytes"));
    color.add_bytes(bin_.pixel_counter("bytes"));
  }
  surface.add_color(kSampleColorBytes);
  return resolve(surface.surface(), bin_.tile.pixels(), bin_.shader(), bin_.background(), resolving.timed(),
                 {samples_, [&](std::uint32_t, std::size_t sample) { return place_of(sample); }});
}

}  // namespace beampipe
