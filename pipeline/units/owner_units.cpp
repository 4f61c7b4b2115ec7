#include "pipeline/units/owner_units.h"

#include <stdexcept>
#include <string>

#include "stages/data/owner_slot.h"
#include "stages/raster/bin_sort_cost.h"

namespace beampipe {

void OpenPixelStore::merge(const std::vector<Fragment>& fragments) {
  if (bin_.keeps_pixels_on_chip()) return;
  StageCounters& compose = bin_.stage(StageId::compose).counters;
  for (const Fragment& fragment : fragments) memory_.merge(fragment.triangle, fragment.pixel, compose);
}

void OpenPixelStore::collect(const std::vector<std::uint32_t>& written) {
  if (bin_.keeps_pixels_on_chip()) return;
  StageCounters& compose = bin_.stage(StageId::compose).counters;
  for (std::uint32_t pixel = 0; pixel < bin_.tile.pixels(); ++pixel) memory_.read(pixel, compose);
  for (const std::uint32_t pixel : written) memory_.write(pixel, compose);
}

void OpenPixelStore::finish() {
  memory_.flush({}, bin_.stage(StageId::compose).counters);
  memory_.read_all(bin_.stage(StageId::resolve).counters);
  if (bin_.models_memory()) memory_.add_bytes(bin_.pixel_counter("bytes"));
}

OwnersBin owners_bin(Bin& bin, const PositionSet& positions, const TriangleList& list,
                     const std::vector<float>* watermarks, const OwnerShading& shading) {
  if (list.size() > OwnerSlot::kMostTriangles)
    throw std::runtime_error("a bin has " + std::to_string(list.size()) + " triangles, more than the " +
                             std::to_string(OwnerSlot::kMostTriangles) + " that an owner can name");
  return {.triangles = bin.triangles(),
          .list = list,
          .watermarks = watermarks,
          .tile = bin.tile,
          .positions = positions,
          .shader = bin.shader(),
          .lists_fetches = bin.models_memory(),
          .shading = shading,
          .observers = bin.observers()};
}

OrderedList sort_bin(Bin& bin) {
  const BinStage stage = bin.stage(StageId::bin_sort);
  OrderedList ordered = bin_sort(bin.triangles(), bin.list, bin.tile, stage.timed());
  // Binning writes the keys beside the list. The sort works in L2 if the list and its copy fit there.
  const std::uint64_t entries = bin.list.size() * (sizeof(std::uint32_t) + kKeyBytes);
  stage.writes("bin_keys", bin.list.size() * kKeyBytes);
  bin.memory().reach->add({.l2 = 2 * entries});
  if (2 * entries > bin.memory().l2.bytes) {
    stage.copies("bin_lists", "bin_list_copies", kSortPasses, entries);
  } else {
    stage.reads("bin_keys", bin.list.size() * kKeyBytes);
    stage.moves_in_l2("bin_lists", 2 * kSortPasses * entries - bin.list.size() * kKeyBytes);
  }
  bin.triangle_fetches().read_setup(ordered.triangles, bin.stage(StageId::conservative_raster).counters);
  return ordered;
}

}  // namespace beampipe
