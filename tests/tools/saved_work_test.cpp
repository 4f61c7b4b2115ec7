#include "tools/saved_work.h"

#include <gtest/gtest.h>

namespace beampipe {
namespace {

// 20 pixels touched, 15 of them maybe visible and sorted; 9 pairs became 7 fragments, 2 covered their pixel as a whole.
TEST(SavedWork, IsFoundFromTheStages) {
  StageCounters raster{"conservative_raster"}, buffer{"a_buffer"}, fragment{"beam_fragment"}, composition{"compose"};
  raster.lanes_used = 20, raster.items_out = 15;
  buffer.items_out = 15;
  fragment.items_in = 9, fragment.items_out = 7;
  composition.items_in = 7 + 2;
  const std::vector<SavedWork> saved = saved_work({raster, buffer, fragment, composition});
  ASSERT_EQ(saved.size(), 3u);
  EXPECT_EQ(saved[0].amount, 5u);
  EXPECT_EQ(saved[1].amount, 2u);
  EXPECT_EQ(saved[2].amount, 15u - 9 - 2);
  EXPECT_EQ(saved_work({raster, fragment, buffer, composition}).size(), 1u) << "as published: fragments are sorted";
  EXPECT_TRUE(saved_work({{"sample_raster"}}).empty());
}

}  // namespace
}  // namespace beampipe
