// Composition in bounded memory: a bin's triangles near to far, and the open pixels that own mask positions.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/memory/aggregate_memory.h"
#include "pipeline/units/fragment_units.h"
#include "stages/beam/compose_owners.h"
#include "stages/cost/closed_depth_cost.h"
#include "stages/picture/resolve.h"
#include "stages/raster/bin_sort.h"

namespace beampipe {

// Sorts the bin's list near to far, with the traffic of the keys, of the sort, and of the raster stage, which reads the
// setup triangles in that order. For a plan that sorts_lists.
OrderedList sort_bin(Bin& bin);
inline constexpr const char* kNearFirstOrder = "near to far, by the nearest depth in the bin";  // BinPlan::order

// What open pixels cost in memory. On chip they cost nothing there.
class OpenPixelStore {
 public:
  OpenPixelStore(Bin& bin, const std::vector<Surface>& surfaces)
      : bin_(bin), memory_(bin.memory(), bin.z_order(), surfaces) {}

  // Stage `compose` reads and writes the pixel of each fragment.
  void merge(const std::vector<Fragment>& fragments);

  // After the last fragment: `resolve` reads all pixels.
  void finish();

 private:
  Bin& bin_;
  AggregateMemory memory_;
};

// Of an OpenPixel with so many positions and slots.
std::vector<Surface> open_pixel_surfaces(int positions, int slots);

// What composers take for all fragments of a bin. `list`: the triangles in the order in which they are taken;
// `watermarks` may be null. All must outlive the result. Throws std::runtime_error if the list is longer than an owner
// can name.
OwnersBin owners_bin(Bin& bin, const PositionSet& positions, const TriangleList& list,
                     const std::vector<float>* watermarks, OwnerPlace shade_at);

template <std::size_t Words, std::size_t Slots>
class ComposeOwnersUnit {
 public:
  // `list`: the triangles in the order in which they are taken. `watermarks` may be null. `surfaces`: of open pixels.
  // All but the surfaces must outlive the unit. L2 holds the setup of the triangles.
  ComposeOwnersUnit(Bin& bin, const PositionSet& positions, const TriangleList& list,
                    const std::vector<float>* watermarks, const std::vector<Surface>& surfaces,
                    OwnerPlace shade_at = OwnerPlace::covered)
      : bin_(bin),
        stage_(bin.stage(StageId::compose)),
        owners_(owners_bin(bin, positions, list, watermarks, shade_at)),
        maps_{bin.pixel_counter("fragments"), bin.pixel_counter("merges")},
        pixels_(bin.tile.pixels()),
        store_(bin, surfaces) {}

  // `first`: as in OwnersBatch.
  void operator()(const std::vector<Fragment>& fragments, std::size_t first, ClosedDepth& closed, ShadeUnit& shade) {
    OwnersResult result;
    result.texels = bin_.texels();
    compose_owners(owners_, {fragments, first}, stage_.timed(),
                   OwnersTile<Words, Slots>{pixels_, closed, maps_, result});
    charge(closed, stage_.counters);
    store_.merge(fragments);
    finish(result, shade);
  }

  // The picture.
  std::vector<glm::vec4> resolve_owners(ShadeUnit& shade) {
    OwnersResult result;
    result.texels = bin_.texels();
    store_.finish();
    const std::vector<PixelColor> colors = finish_owners(owners_, stage_.timed(), pixels_, result);
    finish(result, shade);
    bin_.triangle_fetches().flush(stage_.counters);
    return resolve(colors, bin_.background(), kColorBytes + sizeof(std::uint16_t), bin_.stage(StageId::resolve).timed(),
                   bin_.observers());
  }

 private:
  void finish(const OwnersResult& result, ShadeUnit& shade) {
    for (const std::uint32_t triangle : result.fetched) bin_.triangle_fetches().depth(triangle, stage_.counters);
    shade.visible(result.shaded);
  }

  Bin& bin_;
  BinStage stage_;
  OwnersBin owners_;
  OwnersMaps maps_;
  OpenPixels<Words, Slots> pixels_;
  OpenPixelStore store_;
};

}  // namespace beampipe
