// What techniques that accumulate over frames share: this frame by itself, the history, and how both meet.
#pragma once

#include <utility>
#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/units/depth_test_unit.h"
#include "stages/temporal/motion.h"
#include "stages/temporal/temporal.h"

namespace beampipe {

// How a frame has moved since the last one.
class FrameMotion {
 public:
  // `history`: what earlier frames left. `context` must outlive it.
  FrameMotion(const FrameContext& context, const History& history);

  MovingTile of(const Bin& bin) const;  // it must not outlive the bin

  // Stage `motion` of a bin: how the nearest surface of each pixel moved, row by row.
  std::vector<glm::vec2> find(Bin& bin, DepthTestUnit& surface, MotionFrom from) const;

  Poses take_poses() { return std::move(poses_); }  // for the history

 private:
  const Poses& last_poses(const History& history) const;  // in a first frame, those of this one

  const FrameContext& context_;
  Poses poses_;
  std::vector<glm::dmat4> to_last_;
  Deformations deformations_;
};

class TemporalFrame {
 public:
  // `options`: how the frame meets its history.
  TemporalFrame(const FrameContext& context, const TemporalOptions& options);

  // What earlier frames left.
  const History& history() const { return history_; }

  const FrameMotion& motion() const { return motion_; }

  // FrameMotion::find, for `current`.
  void find_motion(Bin& bin, DepthTestUnit& surface, MotionFrom from = MotionFrom::ids);

  // Stage `temporal` of a tile, on whole frames.
  void accumulate(const Tile& tile, const BinStage& stage);

  // Hands the picture to the result, and leaves the history for the next frame.
  void finish(FrameResult& result);

  CurrentFrame current;

 private:
  const FrameContext& context_;
  History first_;  // of a frame that has no history
  History& history_;
  FrameMotion motion_;
  const TemporalOptions options_;
  Accumulated picture_;
};

}  // namespace beampipe
