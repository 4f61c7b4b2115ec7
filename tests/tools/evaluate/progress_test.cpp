#include "tools/evaluate/progress.h"

#include "tests/test.h"
#include "traces/scenes.h"

namespace beampipe::progress_test {

TEST(Progress, EstimatesWhatIsLeft) {
  EXPECT_EQ(estimate_text(25, 100, 10), " (25 %, 30 s left)");
  EXPECT_EQ(estimate_text(100, 100, 10), " (100 %, 0 s left)");
  EXPECT_EQ(estimate_text(25, 100, 1), "") << "too early";
  EXPECT_EQ(estimate_text(0, 100, 10), "");
  EXPECT_EQ(estimate_text(0, 0, 10), "");
}

TEST(Progress, RenderingsCountTheirBins) {
  const Trace trace = make_scene("soup", {.triangles = 1000, .width = 40, .height = 24});
  Progress progress(false);
  for (const char* const spec : {"reference", "msaa:4", "beam"}) {
    Completion& completion = progress.show(spec);
    EXPECT_EQ(completion.all, 0u);
    parse_technique(spec).render(trace, 0, {}, {.completion = &completion});
    EXPECT_EQ(completion.finished, completion.all) << spec;
    EXPECT_GT(completion.all, 0u) << spec;
  }
}

}  // namespace beampipe::progress_test
