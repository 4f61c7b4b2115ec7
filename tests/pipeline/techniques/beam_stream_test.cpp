// The beam in streaming order.
#include <gtest/gtest.h>

#include "pipeline/technique.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/pipeline/test_traces.h"

namespace beampipe {
namespace {

// A triangle counts once, however many passes there are.
TEST(BeamStream, FragmentsOfAPixelAreThoseOfTheFirstPass) {
  const Trace trace = random_trace(40, 30, 400, 2);
  const FrameResult all = parse_technique("beam:order=stream,passes=0,layers=1").render(trace, 0, {2});
  const FrameResult first = parse_technique("beam:order=stream,passes=2,layers=1").render(trace, 0, {2});
  EXPECT_EQ(all.pixel_counters.at("fragments"), first.pixel_counters.at("fragments"));
  EXPECT_GT(sum_of(all, "passes"), sum_of(first, "passes"));
}

// With fewer layers a pixel is settled in more passes. Each pass stores area and colour in 16 bits, so the pictures
// differ a little: here by 6.8e-4.
TEST(BeamStream, LayersOnlyDecideHowManyPassesThereAre) {
  const Trace trace = random_trace(40, 30, 200, 4);
  const FrameResult one = render("beam:order=stream,passes=0,bits=64,layers=1", trace);
  const FrameResult five = render("beam:order=stream,passes=0,bits=64,layers=5", trace);
  EXPECT_GT(sum_of(one, "passes"), sum_of(five, "passes"));
  EXPECT_LT(rmse(one.image, five.image), 1e-3);
}

}  // namespace
}  // namespace beampipe
