// Composition with records in a pool: a bin's triangles near to far, and pixels that pay for the edges that they have.
#pragma once

#include <vector>

#include "pipeline/units/owner_units.h"
#include "stages/beam/compose_pooled.h"

namespace beampipe {

// A word for each pixel, and so many bytes for each in a pool of records.
inline std::vector<Surface> pooled_pixel_surfaces(int pool_bytes) {
  const auto bytes = static_cast<std::uint32_t>(pool_bytes);
  std::vector<Surface> surfaces = {{"pixel_words", times("R16UI", kPixelWordBytes / 2), kPixelWordBytes}};
  if (bytes > 0) surfaces.push_back({"record_pool", times("R8UI", bytes), bytes});
  return surfaces;
}

template <std::size_t Words>
class ComposePooledUnit {
 public:
  // `list`: the triangles in the order in which they are taken. `surfaces`: of pooled pixels; `pool_bytes`: for each of
  // them. All but the surfaces must outlive the unit.
  ComposePooledUnit(Bin& bin, const PositionSet& positions, const OrderedList& list,
                    const std::vector<Surface>& surfaces, int pool_bytes, OwnerPlace shade_at)
      : bin_(bin),
        stage_(bin.stage(StageId::compose)),
        owners_(owners_bin(bin, positions, list.triangles, &list.watermarks, shade_at)),
        maps_{bin.pixel_counter("fragments"), bin.pixel_counter("merges")},
        memory_chunks_(bin.pixel_counter("memory_chunks")),
        pixels_(bin.tile.pixels(), bin.tile.pixels() * static_cast<std::size_t>(pool_bytes)),
        store_(bin, surfaces) {}

  // `first`: as in OwnersBatch.
  void operator()(const std::vector<Fragment>& fragments, std::size_t first, ClosedDepth& closed, ShadeUnit& shade) {
    PooledResult result(memory_chunks_);
    result.texels = bin_.texels();
    compose_pooled(owners_, {fragments, first}, stage_.timed(), PooledTile<Words>{pixels_, closed, maps_, result});
    charge(closed, stage_.counters);
    store_.merge(fragments);
    finish(result, shade);
  }

  // The picture.
  std::vector<glm::vec4> resolve_owners(ShadeUnit& shade) {
    PooledResult result(memory_chunks_);
    result.texels = bin_.texels();
    store_.finish();
    const std::vector<PixelColor> colors = finish_pooled(owners_, stage_.timed(), pixels_, result);
    finish(result, shade);
    bin_.triangle_fetches().flush(stage_.counters);
    return resolve(colors, bin_.background(), kColorBytes + sizeof(std::uint16_t), bin_.stage(StageId::resolve).timed(),
                   bin_.observers());
  }

 private:
  void finish(const PooledResult& result, ShadeUnit& shade) {
    for (const std::uint32_t triangle : result.fetched) bin_.triangle_fetches().depth(triangle, stage_.counters);
    // A chunk in memory is a request of a sector, which L2 holds.
    if (bin_.models_memory()) stage_.moves_in_l2(result.chunks_in_memory * bin_.memory().sector_bytes);
    shade.visible(result.shaded);
  }

  Bin& bin_;
  BinStage stage_;
  OwnersBin owners_;
  OwnersMaps maps_;
  std::vector<float>& memory_chunks_;
  PooledPixels<Words> pixels_;
  OpenPixelStore store_;
};

}  // namespace beampipe
