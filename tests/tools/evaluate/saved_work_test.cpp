#include "tools/evaluate/saved_work.h"

#include "tests/test.h"

namespace beampipe::saved_work_test {

std::map<std::string, std::uint64_t> saved_by(const std::vector<StageCounters>& stages) {
  std::map<std::string, std::uint64_t> amounts;
  for (const SavedWork& saved : saved_work(stages)) amounts[saved.name] = saved.amount;
  return amounts;
}

using Amounts = std::map<std::string, std::uint64_t>;

// 15 pairs are maybe visible and sorted; 9 of them became 7 fragments, 2 covered their pixel as a whole.
TEST(SavedWork, IsFoundFromTheStages) {
  StageCounters raster{StageId::conservative_raster}, buffer{StageId::a_buffer}, fragment{StageId::beam_fragment},
      composition{StageId::compose};
  raster.items_out = 15, raster.hidden_items = 5, raster.hidden_triangles = 4, raster.empty_tiles = 3;
  buffer.items_out = 15;
  fragment.items_in = 9, fragment.items_out = 7;
  composition.items_in = 7 + 2;
  Amounts expected = {{"hidden_pairs", 5}, {"hidden_triangles", 4}, {"empty_tiles", 3}};
  EXPECT_EQ(saved_by({raster, fragment, buffer, composition}), expected) << "published rules: fragments are sorted";
  expected["whole_pixels"] = 2, expected["pairs_behind_closed"] = 15 - 9 - 2;
  EXPECT_EQ(saved_by({raster, buffer, {StageId::windows}, fragment, composition}), expected);
  raster.stage = StageId::sample_raster;
  EXPECT_EQ(saved_by({raster}), (Amounts{{"hidden_cells", 5}, {"hidden_triangles", 4}, {"empty_tiles", 3}}));
  EXPECT_TRUE(saved_work({{StageId::reference_raster}}).empty());
}

}  // namespace beampipe::saved_work_test
