#include "pipeline/units/temporal_units.h"

#include "pipeline/bins/render_bins.h"

namespace beampipe {

TemporalFrame::TemporalFrame(const FrameContext& context)
    : current(context.frame.width, context.frame.height),
      context_(context),
      history_(context.run.history ? *context.run.history : first_),
      poses_(poses_of(context.frame, context.triangles.placements)),
      to_last_(to_last_frame(poses_, history_.frames > 0 ? history_.poses : poses_)),
      picture_(current.color.size()) {}

void TemporalFrame::find_motion(Bin& bin, DepthTestUnit& visibility) {
  const BinStage stage = bin.stage("motion");
  copy_to_frame(motion(visibility.surface(), bin.tile, context_.frame, bin.triangles().draws, to_last_, stage.timed()),
                bin.tile, context_.frame, current.motion);
  visibility.read_depths(stage);
  visibility.read_colors(stage);
  stage.streams(bin.tile.pixels() * kMotionBytes);
}

// What neighbouring pixels share comes from cache: each surface is moved once.
void TemporalFrame::accumulate(const Tile& tile, const TemporalOptions& options, const BinStage& stage) {
  constexpr std::uint64_t kHistoryBytes = 8;  // fp16 RGBA
  temporal(current, options, history_, tile, stage.timed(), picture_);
  stage.streams(tile.pixels() * kMotionBytes);
  if (history_.frames > 0) stage.streams(tile.pixels() * kHistoryBytes);
  stage.streams(tile.pixels() * kHistoryBytes);
}

void TemporalFrame::finish(FrameResult& result) {
  copy_to_image(picture_, result.image);
  history_ = {history_.frames + 1,      current.width,    current.height, std::move(picture_),
              std::move(current.looks), std::move(poses_)};
}

}  // namespace beampipe
