#include "traces/files/unique_names.h"

#include "tests/test.h"
#include "traces/trace.h"

namespace beampipe::unique_names_test {

TEST(UniqueNames, NumbersWhatHasTheSameName) {
  std::vector<Material> items(8);
  const char* const names[] = {"wood", "", "wood 2", "wood", "", "wood", "caf\xe9", "caf\xc3\xa9"};
  for (std::size_t i = 0; i < items.size(); ++i) items[i].name = names[i];
  make_names_unique(items, "thing");
  const char* const expected[] = {"wood", "thing", "wood 2", "wood 3", "thing 2", "wood 4", "caf?", "caf\xc3\xa9"};
  for (std::size_t i = 0; i < items.size(); ++i) EXPECT_EQ(items[i].name, expected[i]);
}

}  // namespace beampipe::unique_names_test
