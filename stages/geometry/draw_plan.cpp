#include "stages/geometry/draw_plan.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "simd/vertex_transform.h"
#include "stages/geometry/depth_order.h"
#include "stages/geometry/draw_geometry.h"
#include "stages/rop/draw_effect.h"
#include "stages/rop/rop_rules.h"
#include "stages/surface/program_alpha.h"

namespace beampipe {
namespace {

// A side in 1/256 px, at most as far away as the frame's. `end`: of the frame, in pixels.
std::int32_t on_grid(double pixels, double end) {
  return static_cast<std::int32_t>(std::floor(to_grid(std::clamp(pixels, 0.0, end))));
}

// Sets the placement on the screen. Draws without pixels are not drawn.
void place_on_screen(const DrawState& state, double width, double height, DrawPlacement& placement) {
  double left = 0, top = 0, right = width, bottom = height;
  if (state.viewport) {
    const double x = state.viewport->x, y = state.viewport->y;
    const double w = state.viewport->width, h = state.viewport->height;
    placement.x_scale = w / width, placement.x_offset = 2 * x / width + w / width - 1;
    placement.y_scale = h / height, placement.y_offset = 1 - 2 * y / height - h / height;
    left = x, right = x + w;
    top = std::min(y, y + h), bottom = std::max(y, y + h);
  }
  if (state.scissor) {
    const double x = state.scissor->x, y = state.scissor->y;
    left = std::max(left, x), right = std::min(right, x + state.scissor->width);
    top = std::max(top, y), bottom = std::min(bottom, y + state.scissor->height);
  }
  const std::int32_t sides[4] = {on_grid(left, width), on_grid(top, height), on_grid(right, width),
                                 on_grid(bottom, height)};
  if (sides[0] >= sides[2] || sides[1] >= sides[3]) placement.is_drawn = false;
  if (left > 0) placement.left = sides[0];
  if (top > 0) placement.top = sides[1];
  if (right < width) placement.right = sides[2];
  if (bottom < height) placement.bottom = sides[3];
}

// The frame's depth is window depth minus 1.
void keep_depths(const DepthState& depth, DrawPlacement& placement) {
  placement.depth_scale = double{depth.far} - double{depth.near};
  placement.depth_offset = double{depth.far} - 1;
  placement.bias_constant = depth.bias.constant, placement.bias_slope = depth.bias.slope;
  placement.bias_clamp = depth.bias.clamp;
}

class Planner {
 public:
  Planner(const Trace& trace, const Frame& frame) : trace_(trace), frame_(frame), is_pre_pass_(frame.draws.size()) {}

  void run(DrawOrder draw_order) {
    plan.placements.resize(frame_.draws.size());
    for (std::uint32_t i = 0; i < frame_.draws.size(); ++i) {
      const Draw& draw = frame_.draws[i];
      DrawPlacement& placement = plan.placements[i];
      placement.clips_depth = draw.state.depth.clip;
      place_on_screen(draw.state, frame_.width, frame_.height, placement);
      if (draw_order == DrawOrder::of_api) {
        keep_depths(draw.state.depth, placement);
        continue;
      }
      if (!placement.is_drawn) continue;
      placement.is_drawn = can_draw(draw, placement);
      is_pre_pass_[i] = is_pre_pass(draw.state);
    }
    if (draw_order == DrawOrder::of_api) return;
    const std::vector<std::uint32_t> geometry = geometry_numbers(trace_, frame_);
    note_lone_pre_passes(geometry);
    order_depths(trace_, frame_, geometry, plan.placements, plan.notes);
  }

  void note_requests() {
    for (const Draw& draw : frame_.draws)
      for (const std::string& request : fragment_requests(trace_, draw)) note(draw, request, false);
  }

  DrawPlan plan;

 private:
  void leave_out(const Draw& draw, const char* reason) { note(draw, reason, true); }

  void note(const Draw& draw, const std::string& reason, bool left_out) {
    add_note(plan.notes, reason, left_out, 1, trace_.meshes[draw.mesh].triangles.size());
  }

  static bool is_pre_pass(const DrawState& state) {
    return !writes_color(state) && state.depth.test && state.depth.write && state.depth.function != Compare::never &&
           !has_stencil_test(state);
  }

  // Notes what is left out, except for pre-passes.
  bool can_draw(const Draw& draw, DrawPlacement& placement) {
    const DrawState& state = draw.state;
    if (state.depth.test && state.depth.function == Compare::never) return false;
    if (has_stencil_test(state)) {
      leave_out(draw, "stencil test");
      return false;
    }
    if (!writes_color(state)) {
      if (!is_pre_pass(state) && rop_rule(state).writes_stencil()) leave_out(draw, "stencil without colour");
      return false;
    }
    if (state.blend) {
      const bool translucent = is_translucent(trace_, draw);
      const BlendEquation& equation = state.blend->color;
      if (equation != kAlphaBlending && equation != kReplacing && (translucent || !replaces_where_opaque(equation))) {
        leave_out(draw, equation == kPremultipliedBlending ? "blending of premultiplied colours"
                                                           : "a blend function other than alpha blending");
        return false;
      }
      placement.is_opaque = translucent && equation == kReplacing;
    }
    if ((state.color_mask & kColorChannels) != kColorChannels)
      note(draw, "only some colour channels are written", false);
    return true;
  }

  // Notes the pre-passes whose triangles no later draw of the same group draws.
  void note_lone_pre_passes(const std::vector<std::uint32_t>& geometry) {
    std::unordered_set<std::uint32_t> drawn_again;
    for (std::size_t i = frame_.draws.size(); i-- > 0;) {
      const DepthState& depth = frame_.draws[i].state.depth;
      if (is_pre_pass_[i] && (!drawn_again.contains(geometry[i]) || may_be_cut_out(trace_, frame_.draws[i])))
        leave_out(frame_.draws[i], "depth without colour");
      if (plan.placements[i].is_drawn && depth.test && passes_equal(depth.function) &&
          !may_be_cut_out(trace_, frame_.draws[i]))
        drawn_again.insert(geometry[i]);
      if (depth.cleared_before) drawn_again.clear();
    }
  }

  const Trace& trace_;
  const Frame& frame_;
  std::vector<bool> is_pre_pass_;  // by draw; of those that have pixels
};

}  // namespace

DrawPlan plan_draws(const Trace& trace, const Frame& frame, DrawOrder order) {
  Planner planner(trace, frame);
  if (order == DrawOrder::by_depth) planner.note_requests();
  if (std::ranges::any_of(frame.draws, [](const Draw& draw) { return draw.state != DrawState{} || draw.program; }))
    planner.run(order);
  return std::move(planner.plan);
}

bool needs_api_order(const Trace& trace, const Frame& frame) {
  const auto is_blended = [&](const Draw& draw) {
    return draw.state.blend && draw.state.blend->color != kReplacing && is_translucent(trace, draw);
  };
  if (std::ranges::any_of(frame.draws, is_blended)) return true;
  const DrawPlan plan = plan_draws(trace, frame);
  const auto is_coarse = [](const DrawPlacement& placement) {
    return placement.is_drawn && placement.layer_step == 0 && std::abs(placement.window_scale) < 1;
  };
  return !plan.notes.empty() || std::ranges::any_of(plan.placements, is_coarse);
}

}  // namespace beampipe
