// What units share that compose a bin's triangles near to far, or in primitive order.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/memory/aggregate_memory.h"
#include "pipeline/units/fragment_units.h"
#include "stages/beam/owners_bin.h"
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

  // Stage `compose` reads all pixels, and writes these.
  void collect(const std::vector<std::uint32_t>& written);

  // After the last fragment: `resolve` reads all pixels.
  void finish();

 private:
  Bin& bin_;
  AggregateMemory memory_;
};

// What composers take for all fragments of a bin. `list`: the triangles in the order in which they are taken;
// `watermarks` may be null. All must outlive the result. Throws std::runtime_error if the list is longer than an owner
// can name.
OwnersBin owners_bin(Bin& bin, const PositionSet& positions, const TriangleList& list,
                     const std::vector<float>* watermarks, const OwnerShading& shading = {});

}  // namespace beampipe
