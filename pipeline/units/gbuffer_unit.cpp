#include "pipeline/units/gbuffer_unit.h"

#include "pipeline/units/sample_places.h"

namespace beampipe {
namespace {

// Writes each of the pixels once, and ends the pass.
void write_pixels(const std::vector<std::uint32_t>& pixels, TileSurface& to, StageCounters& counters) {
  for (const std::uint32_t pixel : pixels) to.write(0, pixel, counters);
  to.flush(counters);
}

std::vector<std::uint32_t> triangles_at(const std::vector<std::uint32_t>& pixels, const SampleTile& surface) {
  std::vector<std::uint32_t> triangles;
  triangles.reserve(pixels.size());
  for (const std::uint32_t pixel : pixels) triangles.push_back(surface.triangle[pixel]);
  return triangles;
}

}  // namespace

GBufferUnit::GBufferUnit(Bin& bin)
    : bin_(bin),
      shading_(bin.stage("shade")),
      lighting_(bin.stage("light")),
      attributes_(bin.memory(), bin.surface_fetches()),
      gbuffer_(bin.memory(), "gbuffer", bin.z_order(), 1, kGBufferBytes) {}

void GBufferUnit::write_fragments(const std::vector<SampleFragment>& fragments, const DepthTestUnit& depth_test) {
  write_gbuffer(bin_.shader(), fragments, shading_.timed());
  if (TexelRequests* const texels = bin_.texels())
    SamplePlaces(bin_, depth_test.sampling(), ShadeAt::sample).add_quad_texels(fragments, *texels);
  bin_.charge_texels(shading_);
  attributes_.read(fragments, shading_.counters);
  for (const SampleAccess& access : depth_test.accesses())
    gbuffer_.access(access.triangle, access.cell, 0, access.passed, shading_.counters);
}

void GBufferUnit::write_visible(DepthTestUnit& visibility) {
  const std::vector<std::uint32_t> shown = shown_pixels(visibility.surface(), bin_.tile);
  write_gbuffer(bin_.shader(), triangles_at(shown, visibility.surface()), shading_.timed());
  if (TexelRequests* const texels = bin_.texels()) {
    const SamplePlaces places(bin_, visibility.sampling(), ShadeAt::sample);
    for (const std::uint32_t pixel : shown) places.add_texels(visibility.surface().triangle[pixel], pixel, *texels);
  }
  bin_.charge_texels(shading_);
  visibility.read_colors(shading_);
  for (const std::uint32_t pixel : shown)
    bin_.triangle_fetches().attributes(visibility.surface().triangle[pixel], shading_.counters);
  bin_.triangle_fetches().flush(shading_.counters);
  write_pixels(shown, gbuffer_, shading_.counters);
}

std::vector<glm::vec4> GBufferUnit::light_and_resolve(DepthTestUnit& surface) {
  const BinStage resolving = bin_.stage("resolve");
  const std::vector<std::uint32_t> shown = shown_pixels(surface.surface(), bin_.tile);
  light(bin_.shader(), triangles_at(shown, surface.surface()), lighting_.timed());
  TileSurface color(bin_.memory(), "color", bin_.z_order(), 1, kSampleColorBytes);
  gbuffer_.read_all(lighting_.counters);
  write_pixels(shown, color, lighting_.counters);
  color.read_all(resolving.counters);
  if (bin_.models_memory()) {
    gbuffer_.add_bytes(bin_.pixel_counter("bytes"));
    color.add_bytes(bin_.pixel_counter("bytes"));
  }
  surface.add_color(kSampleColorBytes);
  return surface.resolve_samples(ShadeAt::sample, resolving);
}

}  // namespace beampipe
