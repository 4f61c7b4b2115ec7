#include "pipeline/units/accumulate_unit.h"

#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"
#include "pipeline/units/sample_places.h"
#include "stages/samples/blend.h"

namespace beampipe {

AccumulateUnit::AccumulateUnit(Bin& bin, int samples, AccumulatorFormat format, DoubleCounting double_counting)
    : stage(bin.stage(StageId::accumulate)),
      bin_(bin),
      accumulator_(bin.tile, samples, format, double_counting),
      color_(bin.memory(), "accumulator", bin.z_order(), {.part_bytes = accumulator_bytes(format)}) {
  accumulator_.limit = 0;
  accumulator_.observers = bin.observers();
}

void AccumulateUnit::start_round(const Sampling& sampling, const SampleTile& depth) {
  accumulator_.limit += static_cast<float>(sampling.pattern.count) * accumulator_.sample_share;
  accumulator_.taken.assign(bin_.tile.pixels(), 0);
  if (accumulator_.double_counting == DoubleCounting::stencil)
    stencil_.emplace(
        bin_.memory(), "stencil", bin_.z_order(),
        TileSurface::Element{.parts = static_cast<std::uint32_t>(sampling.pattern.count), .part_bytes = 1});
  if (!blends_background()) return;
  accumulate_background(depth, bin_.background(), stage.timed(), accumulator_);
  if (bin_.models_memory()) blend_background(depth);
}

void AccumulateUnit::test_stencil(std::vector<SampleFragment>& fragments) {
  if (!stencil_) return;
  access_stencil(fragments, false);
  stencil_test(bin_.tile, bin_.stage(StageId::stencil_test).timed(), accumulator_, fragments);
  access_stencil(fragments, true);
}

void AccumulateUnit::operator()(const std::vector<SampleFragment>& fragments, const Sampling& sampling) {
  std::vector<glm::vec2> places;
  if (!bin_.context.shader.is_flat()) places = SamplePlaces(bin_, sampling, ShadeAt::centroid).of(fragments);
  accumulate(fragments, bin_.shader(), places, bin_.tile, stage.timed(), accumulator_);
  for (const SampleFragment& fragment : fragments)
    access_color(fragment.triangle, static_cast<std::uint32_t>(bin_.tile.index(fragment.x, fragment.y)), stage);
}

void AccumulateUnit::blend_translucent(DepthTestUnit& depth_test, const Sampling& central) {
  if (!bin_.context.has_blending()) return;
  const std::size_t sample = nearest_to_centre(depth_test.sampling().pattern);
  if (BinObserver* const observer = bin_.observer()) observer->has_sample_of(central, depth_test.sampling(), sample);
  const BinStage blending = bin_.stage(StageId::blend);
  const SamplePlaces places(bin_, central, ShadeAt::centroid);
  SampleRasterUnit raster(bin_, SampleRasterUnit::Translucent::alone, AlphaCoverage::test);
  SampleShadeUnit shade(bin_, central, ShadeAt::centroid);
  std::vector<SampleAccess> accesses;
  raster.pass(central, ShadeAt::centroid, [&](std::vector<SampleFragment>& fragments) {
    count_by_pixel(fragments, bin_.tile, central.grid, bin_.pixel_counter("fragments"));
    blend({bin_.triangles(), bin_.tile, central}, bin_.shader(), {fragments, places.of(fragments)},
          {depth_test.surface(), sample, accesses}, blending.timed(), accumulator_);
    depth_test.read_depths(accesses, blending);
    std::size_t left = 0;
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      if (accesses[i].passed == 0) continue;
      access_color(accesses[i].triangle, accesses[i].cell, blending);
      fragments[left++] = fragments[i];
    }
    fragments.resize(left);
    shade(fragments);
  });
}

void AccumulateUnit::finish_round() {
  if (stencil_) {
    if (bin_.models_memory()) stencil_->add_bytes(bin_.pixel_counter("bytes"));
    stencil_->flush(bin_.stage(StageId::stencil_test).counters);
  }
  color_.flush(stage.counters);
}

std::vector<glm::vec4> AccumulateUnit::resolve_accumulator() {
  const BinStage resolving = bin_.stage(StageId::resolve);
  if (bin_.models_memory()) color_.add_bytes(bin_.pixel_counter("bytes"));
  color_.read_all(resolving.counters);
  return resolve(accumulator_, bin_.background(), resolving.timed());
}

void AccumulateUnit::access_color(std::uint32_t triangle, std::uint32_t pixel, const BinStage& by) {
  color_.read(triangle, pixel, by.counters);
  color_.write(triangle, pixel, by.counters);
}

// Wherever a sample is still clear.
void AccumulateUnit::blend_background(const SampleTile& depth) {
  const auto samples = static_cast<std::ptrdiff_t>(depth.samples_per_pixel);
  for (std::uint32_t pixel = 0; pixel < bin_.tile.pixels(); ++pixel) {
    const auto first = depth.depth.begin() + pixel * samples;
    if (std::find(first, first + samples, kFarDepth) != first + samples) access_color(kNoTriangle, pixel, stage);
  }
}

void AccumulateUnit::access_stencil(const std::vector<SampleFragment>& fragments, bool write) {
  StageCounters& counters = bin_.stage(StageId::stencil_test).counters;
  for (const SampleFragment& fragment : fragments)
    stencil_->access(fragment.triangle, static_cast<std::uint32_t>(bin_.tile.index(fragment.x, fragment.y)),
                     write ? 0 : fragment.mask, write ? fragment.mask : 0, counters);
}

}  // namespace beampipe
