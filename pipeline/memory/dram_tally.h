// Bytes of DRAM and L2 by the array that they belong to: why a stage reads and writes what it does.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "stages/cost/stage.h"

namespace beampipe {

enum class DramAccess : std::uint8_t { read, write };

// What a stage moves to and from DRAM of one array, and asks L2 for. An array is one of the frame, or the parts that
// bins have of it.
struct ArrayBytes {
  Stage stage;
  std::string array;
  std::uint64_t read = 0, written = 0;
  std::uint64_t compressed = 0;  // of both: of blocks that are compressed
  std::uint64_t l2 = 0;

  bool operator==(const ArrayBytes&) const = default;
};

class DramTally {
 public:
  // The number of the array of that name.
  std::uint16_t array(std::string_view name);

  // Bytes of StageId::none are left out, because nobody adds its counters up.
  void add(std::uint16_t array, DramAccess access, Stage stage, std::uint64_t bytes, bool compressed = false) {
    Sums& sums = arrays_[array].stages[stage.number()];
    (access == DramAccess::read ? sums.read : sums.written) += bytes;
    if (compressed) sums.compressed += bytes;
  }
  void add_l2(std::uint16_t array, Stage stage, std::uint64_t bytes) {
    arrays_[array].stages[stage.number()].l2 += bytes;
  }
  void add(const DramTally& other);

  // So many times what other stages have moved, as stages in this pass.
  void add(const DramTally& other, Pass pass, std::uint64_t times);

  // All that are not 0, by stage and then by the array's name.
  std::vector<ArrayBytes> sums() const;

 private:
  struct Sums {
    std::uint64_t read = 0, written = 0, compressed = 0, l2 = 0;

    void operator+=(const Sums& other) {
      read += other.read, written += other.written, compressed += other.compressed, l2 += other.l2;
    }
  };
  struct Array {
    std::string name;
    std::array<Sums, kStageNumbers> stages = {};
  };
  std::vector<Array> arrays_;
};

}  // namespace beampipe
