// Calls of a bin in an order that would give wrong results are errors.
#include "pipeline/bins/bin.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "pipeline/bins/render_bins.h"
#include "tests/pipeline/surface_traces.h"

namespace beampipe::bin_test {

void render(const BinRenderer& renderer) {
  const Trace trace = random_surfaces(8, 8, 4, 1);
  const FrameInput run{.threads = 1};
  const FrameSinks sinks;
  const FrameContext context({trace, trace.frames[0], run, sinks});
  render_bins(context, {.stages = {StageId::sample_raster, StageId::resolve}, .framebuffer = {}}, renderer);
}

TEST(Bin, TakesOnePicture) {
  const auto finish = [](Bin& bin) { bin.finish(std::vector<glm::vec4>(bin.tile.pixels())); };
  EXPECT_NO_THROW(render(finish));
  EXPECT_THROW(render([&](Bin& bin) { finish(bin), finish(bin); }), std::logic_error);
}

TEST(Bin, TexelsAreCharged) {
  const auto read = [](Bin& bin) { bin.texels()->count(1); };
  EXPECT_NO_THROW(render([&](Bin& bin) { read(bin), bin.charge_texels(bin.stage(StageId::resolve)); }));
  EXPECT_THROW(render(read), std::logic_error);
}

}  // namespace beampipe::bin_test
