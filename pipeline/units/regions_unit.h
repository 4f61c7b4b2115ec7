// Composition of regions, where draws keep the API's order.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "pipeline/units/fragment_units.h"
#include "pipeline/units/pooled_unit.h"
#include "stages/beam/compose_regions.h"
#include "stages/cost/charge_resolve.h"

namespace beampipe {

class ComposeRegionsUnit {
 public:
  // The frame must need the API's order. `pool_bytes`: for each pixel of the bin.
  ComposeRegionsUnit(Bin& bin, const PositionSet& positions, int pool_bytes)
      : bin_(bin),
        stage_(bin.stage(StageId::compose)),
        fragments_(bin.pixel_counter("fragments")),
        shadings_(bin.context.shader.is_flat() ? nullptr : &bin.pixel_counter("shadings")),
        maps_{bin.pixel_counter("merges"), bin.pixel_counter("memory_chunks"), bin.pixel_counter("record_bytes")},
        regions_{bin.triangles(), *bin.context.rop, positions, bin.models_memory(), bin.observers()},
        pixels_(bin.tile.pixels(), ChunkPool(bin.tile.pixels() * static_cast<std::size_t>(pool_bytes)),
                positions.patterns.size(), bin.context.rop->clear_depth, bin.context.rop->clear_color),
        words_(bin, pooled_pixel_surfaces(0)),
        records_(bin.memory(), kRecordPool, bin.tile.pixels(),
                 {kMostRegionChunks, kChunkBytes + pixels_.pool.link_bytes()}) {}

  // Each fragment is shaded once, at its centroid, for an area of its size, if some of it passes.
  void operator()(const std::vector<Fragment>& fragments, ShadeUnit& shade) {
    count_by_pixel(fragments, fragments_);
    const std::vector<Invocation> invocations = invocations_of(fragments);
    const std::vector<glm::vec4> colors = bin_.context.shader.colors_and_alphas(invocations);
    RegionsResult result;
    compose_regions(regions_, {fragments, colors}, stage_.timed(), pixels_, maps_, result);
    words_.merge(fragments);
    finish(result);
    charge_shading(result.shaded, fragments, invocations, shade);
  }

  // The picture.
  std::vector<glm::vec4> resolve_regions() {
    RegionsResult result;
    words_.finish();
    std::vector<glm::vec4> picture =
        finish_regions(regions_, bin_.background(), stage_.timed(), pixels_, maps_, result);
    finish(result);
    records_.flush(stage_.counters);
    charge_spills(bin_, stage_, pixels_.pool, spills_);
    if (bin_.models_memory() && !bin_.keeps_pixels_on_chip()) records_.add_bytes(bin_.pixel_counter("bytes"));
    bin_.triangle_fetches().flush(stage_.counters);
    const float of_pool = static_cast<float>(pixels_.pool.peak() * (kChunkBytes + pixels_.pool.link_bytes())) /
                          static_cast<float>(bin_.tile.pixels());
    std::ranges::fill(bin_.pixel_counter("pool_bytes"), of_pool);
    charge_resolve(picture.size(), kColorBytes + sizeof(std::uint16_t), picture.size(), {},
                   bin_.stage(StageId::resolve).counters);
    return picture;
  }

 private:
  std::vector<Invocation> invocations_of(const std::vector<Fragment>& fragments) const {
    std::vector<Invocation> invocations;
    invocations.reserve(fragments.size());
    for (const Fragment& fragment : fragments)
      invocations.push_back({fragment.triangle,
                             bin_.shader().place(fragment.pixel, fragment.centroid_u, fragment.centroid_v),
                             std::sqrt(fragment.alpha)});
    return invocations;
  }

  void charge_shading(const std::vector<std::size_t>& numbers, const std::vector<Fragment>& fragments,
                      const std::vector<Invocation>& invocations, ShadeUnit& shade) {
    std::vector<ShadedTriangle> shaded;
    std::vector<Invocation> of_programs;
    const SurfaceShader& shader = bin_.context.shader;
    for (const std::size_t i : numbers) {
      const Invocation& invocation = invocations[i];
      shaded.push_back({invocation.triangle});
      if (shader.is_flat(invocation.triangle)) continue;
      ++(*shadings_)[fragments[i].pixel];
      if (!bin_.texels()) continue;
      if (shader.is_program(invocation.triangle)) {
        of_programs.push_back(invocation);
      } else {
        shader.add_texels(invocation.triangle, invocation.place, invocation.footprint, *bin_.texels());
        bin_.texels()->end_request();
      }
    }
    if (!of_programs.empty()) shader.add_program_texels(of_programs, *bin_.texels());
    shade.visible(shaded, {});
  }

  void finish(const RegionsResult& result) {
    charge_requests(bin_, stage_, result.fetched, result.visits, records_);
    spills_ += result.spills;
  }

  Bin& bin_;
  BinStage stage_;
  std::vector<float>& fragments_;
  std::vector<float>* shadings_;
  RegionsMaps maps_;
  RegionsBin regions_;
  RegionPixels pixels_;
  OpenPixelStore words_;
  RecordMemory records_;
  ChunkRequests spills_;
};

}  // namespace beampipe
