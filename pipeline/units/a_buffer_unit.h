// The A-buffer of a bin: what is sorted, and what filling and emptying it moves. It is kept in memory from the pass
// over the frame that fills it to the pass that empties it.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "stages/beam/a_buffer.h"

namespace beampipe {

class ABufferUnit {
 public:
  // `item_bytes`: what comes in; `record_bytes`: what is stored of it, without the link.
  ABufferUnit(Bin& bin, std::uint32_t item_bytes, std::uint32_t record_bytes);

  // Sorts each pixel's records by depth. The lists stay valid as long as the unit.
  const ABuffer& operator()(std::vector<SortRecord> records);

  // Charges memory traffic once the bin is composed. `read`: how many records of each pixel were read in order, by
  // stage `reader`.
  void charge_memory(const std::vector<float>& read, const BinStage& reader);

 private:
  Bin& bin_;
  BinStage stage_;
  std::uint32_t item_bytes_, record_bytes_;
  std::vector<SortRecord> records_;
  ABuffer lists_;
};

}  // namespace beampipe
