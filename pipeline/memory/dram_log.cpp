#include "pipeline/memory/dram_log.h"

#include <algorithm>

namespace beampipe {

std::uint16_t DramLog::array(std::string_view name, bool of_bins) {
  const auto found =
      std::find_if(arrays_.begin(), arrays_.end(), [&](const DramArray& array) { return array.name == name; });
  const auto number = static_cast<std::uint16_t>(found - arrays_.begin());
  if (found == arrays_.end()) arrays_.push_back({std::string(name), of_bins});
  return number;
}

void DramLog::reserve(std::uint16_t array, std::uint64_t sectors) {
  arrays_[array].sectors = std::max(arrays_[array].sectors, sectors);
}

void DramLog::add(std::uint16_t array, DramAccess access, std::uint64_t first, std::uint32_t sectors, Stage stage) {
  if (sectors == 0 || stage.id == StageId::none) return;
  arrays_[array].sectors = std::max(arrays_[array].sectors, first + sectors);
  std::vector<DramRun>& runs = passes_.back();
  if (!runs.empty()) {
    DramRun& last = runs.back();
    if (last.array == array && last.access == access && last.stage == stage.number() &&
        last.first + last.sectors == first && last.sectors <= ~std::uint32_t{0} - sectors) {
      last.sectors += sectors;
      return;
    }
  }
  runs.push_back({first, sectors, array, stage.number(), access});
}

}  // namespace beampipe
