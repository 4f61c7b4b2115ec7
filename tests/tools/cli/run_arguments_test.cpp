#include "tools/cli/run_arguments.h"

#include "tests/tools/fixtures.h"

namespace beampipe::run_arguments_test {

using Frames = std::vector<std::size_t>;
using Specs = std::vector<std::string>;

TEST(FrameRange, IsAllByDefault) { EXPECT_EQ(parse_frame_range("", 3), (Frames{0, 1, 2})); }

TEST(FrameRange, HasBothEndsIncluded) {
  EXPECT_EQ(parse_frame_range("1-3", 5), (Frames{1, 2, 3}));
  EXPECT_EQ(parse_frame_range("0-4", 5), (Frames{0, 1, 2, 3, 4}));
  EXPECT_EQ(parse_frame_range("2-2", 5), Frames{2});
  EXPECT_EQ(parse_frame_range("2", 5), Frames{2});
}

TEST(FrameRange, RefusesEverythingElse) {
  for (const char* text :
       {"5", "0-5", "3-2", "-", "1-", "-1", "1-2-3", "1x", "a", " 1", "1 - 2", "99999999999999999999"}) {
    EXPECT_THROW(parse_frame_range(text, 5), UsageError) << text;
  }
  EXPECT_THROW(parse_frame_range("", 0), UsageError);
}

TEST(ExpandSpecs, SplitsListsOfMsaaRatesOnly) {
  EXPECT_EQ(expand_specs({"beam", "msaa:1,8,32", "alpha"}), (Specs{"beam", "msaa:1", "msaa:8", "msaa:32", "alpha"}));
  EXPECT_EQ(expand_specs({"casav:layers=8"}), Specs{"casav:layers=8"});
  EXPECT_EQ(expand_specs({"msaa:8,x"}), Specs{"msaa:8,x"});
  EXPECT_EQ(expand_specs({"msaa:1,,2"}), (Specs{"msaa:1", "msaa:", "msaa:2"}));  // the empty rate is rejected later
}

}  // namespace beampipe::run_arguments_test
