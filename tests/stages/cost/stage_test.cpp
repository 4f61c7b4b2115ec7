// The table of stages: each is found by its name and by its number.
#include "stages/cost/stage.h"

#include "tests/test.h"

namespace beampipe::stage_test {

TEST(Stages, AreFoundByNameAndNumber) {
  std::set<std::string_view> names;
  std::set<int> numbers;
  for (const StageInfo& info : stage_list())
    for (const Pass pass : {Pass::prepass, Pass::main}) {
      const Stage stage(info.id, pass);
      EXPECT_EQ(find_stage(name_of(stage)), stage) << stage;
      EXPECT_EQ(Stage::of_number(stage.number()), stage) << stage;
      EXPECT_LT(stage.number(), kStageNumbers);
      names.insert(name_of(stage));
      numbers.insert(stage.number());
    }
  EXPECT_EQ(names.size(), 2 * kStageCount);
  EXPECT_EQ(numbers.size(), 2 * kStageCount);
  EXPECT_EQ(name_of({StageId::depth_test, Pass::prepass}), "prepass_depth_test");
}

TEST(Stages, WithAnotherNameAreNone) {
  for (const char* const name : {"", "prepass_", "composer", "prepass_prepass_shade", "Shade"})
    EXPECT_FALSE(find_stage(name)) << name;
  EXPECT_EQ(name_of(Stage{}), "");
}

}  // namespace beampipe::stage_test
