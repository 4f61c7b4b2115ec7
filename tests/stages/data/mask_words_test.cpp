#include "stages/data/mask_words.h"

#include <gtest/gtest.h>

namespace beampipe {
namespace {

TEST(MaskWords, AreThoseOfThePositions) {
  const auto words_of = [](int positions) {
    return with_words<1, 2, 8>(positions, []<std::size_t Words>() { return Words; });
  };
  EXPECT_EQ(words_of(32), 1u);
  EXPECT_EQ(words_of(64), 2u);
  EXPECT_EQ(words_of(256), 8u);
  EXPECT_THROW(words_of(128), std::invalid_argument);
}

}  // namespace
}  // namespace beampipe
