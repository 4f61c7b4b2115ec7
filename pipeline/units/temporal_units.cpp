#include "pipeline/units/temporal_units.h"

#include "pipeline/bins/render_bins.h"

namespace beampipe {

FrameMotion::FrameMotion(const FrameContext& context, const History& history)
    : context_(context),
      poses_(poses_of(context.frame, context.triangles.placements)),
      to_last_(to_last_frame(poses_, last_poses(history))),
      deformations_(deformations(context.trace, poses_, last_poses(history), context.triangles.trace_triangles)) {}

const Poses& FrameMotion::last_poses(const History& history) const {
  return history.frames > 0 ? history.poses : poses_;
}

MovingTile FrameMotion::of(const Bin& bin) const {
  return {bin.tile, context_.frame, bin.triangles().draws, to_last_, &deformations_};
}

std::vector<glm::vec2> FrameMotion::find(Bin& bin, DepthTestUnit& surface, MotionFrom from) const {
  const BinStage stage = bin.stage(StageId::motion);
  const MovingTile moving = of(bin);
  std::vector<glm::vec2> vectors = motion(surface.surface(), moving, stage.timed(), from);
  surface.read_depths(stage);
  stage.streams(deformed_pixels(surface.surface(), moving) * kMovedTriangleBytes);
  if (from == MotionFrom::ids) surface.read_colors(stage);
  stage.streams(bin.tile.pixels() * kMotionBytes);
  return vectors;
}

TemporalFrame::TemporalFrame(const FrameContext& context, const TemporalOptions& options)
    : current(context.frame.width, context.frame.height),
      context_(context),
      history_(context.run.history ? *context.run.history : first_),
      motion_(context, history_),
      options_(options),
      picture_(current.color.size(), options.clamp) {}

void TemporalFrame::find_motion(Bin& bin, DepthTestUnit& surface, MotionFrom from) {
  copy_to_frame(motion_.find(bin, surface, from), bin.tile, context_.frame, current.motion);
}

// What neighbouring pixels share comes from cache: each surface is moved once.
void TemporalFrame::accumulate(const Tile& tile, const BinStage& stage) {
  const bool has_speed = options_.clamp == Clamp::rest || options_.clamp == Clamp::camera;
  const std::uint64_t look = options_.clamp == Clamp::rest ? kLookBytes : 0,
                      past = 8 + (options_.clamp == Clamp::variance ? kDeviationBytes : 0);  // 8: fp16 RGBA
  temporal(current, options_, history_, tile, stage.timed(), picture_);
  stage.streams(tile.pixels() * (kMotionBytes + (has_speed ? kSpeedBytes : 0) + look));
  if (history_.frames > 0) stage.streams(tile.pixels() * (past + look));
  stage.streams(tile.pixels() * past);
}

void TemporalFrame::finish(FrameResult& result) {
  copy_to_image(picture_.color, result.image);
  history_ = {.frames = history_.frames + 1,
              .width = current.width,
              .height = current.height,
              .color = std::move(picture_.color),
              .deviation = std::move(picture_.deviation),
              .looks = std::move(current.looks),
              .poses = motion_.take_poses()};
}

}  // namespace beampipe
