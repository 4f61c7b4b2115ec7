#include "pipeline/memory/dram_tally.h"

#include <algorithm>

namespace beampipe {

std::uint16_t DramTally::array(std::string_view name) {
  const auto found = std::ranges::find(arrays_, name, &Array::name);
  const auto number = static_cast<std::uint16_t>(found - arrays_.begin());
  if (found == arrays_.end()) arrays_.push_back({std::string(name)});
  return number;
}

void DramTally::add(const DramTally& other) {
  for (const Array& from : other.arrays_) {
    std::array<Sums, kStageNumbers>& to = arrays_[array(from.name)].stages;
    for (std::size_t stage = 0; stage < kStageNumbers; ++stage) to[stage] += from.stages[stage];
  }
}

void DramTally::add(const DramTally& other, Pass pass, std::uint64_t times) {
  for (const Array& from : other.arrays_) {
    std::array<Sums, kStageNumbers>& to = arrays_[array(from.name)].stages;
    for (std::uint8_t number = 0; number < kStageNumbers; ++number)
      for (std::uint64_t i = 0; i < times; ++i)
        to[Stage(Stage::of_number(number).id, pass).number()] += from.stages[number];
  }
}

std::vector<ArrayBytes> DramTally::sums() const {
  std::vector<ArrayBytes> all;
  for (std::uint8_t number = 0; number < kStageNumbers; ++number) {
    const Stage stage = Stage::of_number(number);
    if (stage.id == StageId::none) continue;
    const auto first = static_cast<std::ptrdiff_t>(all.size());
    for (const Array& array : arrays_)
      if (const Sums& sums = array.stages[number]; sums.read + sums.written + sums.l2 > 0)
        all.push_back({stage, array.name, sums.read, sums.written, sums.compressed, sums.l2});
    std::ranges::sort(all.begin() + first, all.end(), {}, &ArrayBytes::array);
  }
  return all;
}

}  // namespace beampipe
