#include "traces/closest_name.h"

#include "tests/test.h"

namespace beampipe::closest_name_test {

const std::vector<std::string> kNames = {"compare", "run", "report", "check-capture", "msaa", "order"};

TEST(ClosestName, OneChangeForThreeLetters) {
  EXPECT_EQ(closest_name("compre", kNames), "compare");    // dropped
  EXPECT_EQ(closest_name("comparee", kNames), "compare");  // added
  EXPECT_EQ(closest_name("conpare", kNames), "compare");   // replaced
  EXPECT_EQ(closest_name("mssa", kNames), "msaa");         // replaced
  EXPECT_EQ(closest_name("oredr", kNames), "order");       // changed places
  EXPECT_EQ(closest_name("nru", kNames), "");              // two changes
  EXPECT_EQ(closest_name("rnu", kNames), "run");           // one
  EXPECT_EQ(closest_name("chek-captrue", kNames), "check-capture");
}

TEST(ClosestName, NothingIsCloseToEverything) {
  EXPECT_EQ(closest_name("", kNames), "");
  EXPECT_EQ(closest_name("x", kNames), "");
  EXPECT_EQ(closest_name("wireframe", kNames), "");
  EXPECT_EQ(closest_name(std::string(1'000'000, 'r'), kNames), "");
  EXPECT_EQ(closest_name("run", {}), "");
}

TEST(ClosestName, OfSeveralTheClosestOrTheFirst) {
  EXPECT_EQ(closest_name("cart", {"card", "cart", "carp"}), "cart");
  EXPECT_EQ(closest_name("carx", {"card", "cart", "carp"}), "card");
}

TEST(ClosestName, AQuestion) {
  EXPECT_EQ(did_you_mean("rn", kNames), " (did you mean 'run'?)");
  EXPECT_EQ(did_you_mean("paint", kNames), "");
}

}  // namespace beampipe::closest_name_test
