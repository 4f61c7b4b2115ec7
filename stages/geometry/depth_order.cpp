#include "stages/geometry/depth_order.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <unordered_set>

#include "stages/geometry/depth_ends.h"
#include "stages/rop/draw_effect.h"
#include "stages/rop/rop_rules.h"
#include "stages/surface/program_alpha.h"

namespace beampipe {
namespace {

// At equal depth, does the draw hide earlier ones?
bool wins_ties(Compare function) { return passes_equal(function) || function == Compare::always; }

enum class Part { behind, tested, in_front };

struct Group {
  std::vector<std::uint32_t> parts[3];  // draws, by Part
  std::uint64_t triangles[3] = {};
};

class DepthOrder {
 public:
  DepthOrder(const Trace& trace, const Frame& frame, const std::vector<std::uint32_t>& geometry,
             std::vector<DrawPlacement>& placements, std::vector<DrawNote>& notes)
      : trace_(trace),
        frame_(frame),
        geometry_(geometry),
        placements_(placements),
        notes_(notes),
        clear_depth_(window_clear_depth(trace, frame)),
        is_reversed_(clear_depth_ == 0),
        repeats_earlier_(frame.draws.size()) {}

  void find_groups() {
    std::uint32_t first = 0;
    for (std::uint32_t i = 1; i <= frame_.draws.size(); ++i) {
      if (i < frame_.draws.size() && !depth_of(i).cleared_before) continue;
      find_parts(first, i);
      first = i;
    }
  }

  void place() {
    // The parts that are not empty, from far to near. The one that tests most triangles keeps its depths.
    struct Slab {
      Group* group;
      std::size_t part;
    };
    std::vector<Slab> slabs;
    std::size_t kept = 0;
    std::uint64_t most = 0;
    for (Group& group : groups_) {
      for (std::size_t part = 0; part < 3; ++part) {
        if (group.parts[part].empty()) continue;
        if (part == static_cast<std::size_t>(Part::tested) && (kept == 0 || group.triangles[part] > most)) {
          most = group.triangles[part];
          kept = slabs.size() + 1;
        }
        slabs.push_back({&group, part});
      }
    }
    const std::size_t behind = kept > 0 ? kept - 1 : 0, in_front = slabs.size() - kept;
    for (std::size_t i = 0; i < slabs.size(); ++i) {
      const auto& [group, part] = slabs[i];
      Interval interval{-1, 1, true};
      if (i < behind) {
        interval = share_of(1, behind, i);
      } else if (i >= kept) {
        interval = share_of(-1, in_front, i - kept);
      }
      if (part == static_cast<std::size_t>(Part::tested)) {
        place_tested(*group, interval);
      } else {
        paint(*group, part, interval);
      }
    }
  }

 private:
  // nearest .. nearest + width
  struct Interval {
    double nearest, width;
    bool is_kept = false;
  };

  static Interval share_of(double farthest, std::size_t shares, std::size_t index) {
    const double width = 1.0 / static_cast<double>(std::bit_ceil(shares));
    return {farthest - static_cast<double>(index + 1) * width, width};
  }

  const DepthState& depth_of(std::uint32_t draw) const { return frame_.draws[draw].state.depth; }
  std::uint64_t triangles_of(std::uint32_t draw) const {
    return trace_.meshes[frame_.draws[draw].mesh].triangles.size();
  }
  bool is_opaque(std::uint32_t draw) const {
    return placements_[draw].is_opaque || !is_translucent(trace_, frame_.draws[draw]);
  }

  void note(std::uint32_t draw, const char* reason) { add_note(notes_, reason, false, 1, triangles_of(draw)); }

  // Sorts the draws [first, end), which no depth clear divides, into parts.
  void find_parts(std::uint32_t first, std::uint32_t end) {
    std::vector<std::uint32_t> draws;
    for (std::uint32_t i = first; i < end; ++i)
      if (placements_[i].is_drawn) draws.push_back(i);
    find_repetitions(first, end);
    const auto writes = [&](std::uint32_t i) { return acts_as_writer(i); };
    const auto needs_depth = [&](std::uint32_t i) { return writes(i) || !passes_always(depth_of(i)); };
    const auto first_writer = std::find_if(draws.begin(), draws.end(), writes);
    const auto tested_end =
        first_writer == draws.end() ? draws.end() : std::find_if(draws.rbegin(), draws.rend(), needs_depth).base();
    Group group;
    const auto put = [&](std::uint32_t draw, Part part) {
      group.parts[static_cast<std::size_t>(part)].push_back(draw);
      group.triangles[static_cast<std::size_t>(part)] += triangles_of(draw);
    };
    const bool is_painted = first_writer == draws.end();
    for (auto at = draws.begin(); at != first_writer; ++at) put(*at, is_painted ? Part::in_front : Part::behind);
    const std::vector<std::uint32_t> tested(first_writer, tested_end);
    std::uint64_t left = 0, done = 0;  // triangles that test depth after and before a draw
    for (const std::uint32_t draw : tested)
      if (needs_depth(draw)) left += triangles_of(draw);
    for (const std::uint32_t draw : tested) {
      if (needs_depth(draw)) {
        put(draw, Part::tested);
        done += triangles_of(draw), left -= triangles_of(draw);
      } else {
        put(draw, left > done ? Part::behind : Part::in_front);
        note(draw, "no depth test, between draws that have one");
      }
    }
    for (auto at = tested_end; at != draws.end(); ++at) put(*at, Part::in_front);
    note_functions(group);
    if (!draws.empty()) groups_.push_back(std::move(group));
  }

  // What depths may express wrongly is noted.
  void note_functions(const Group& group) {
    const std::vector<std::uint32_t>& tested = group.parts[static_cast<std::size_t>(Part::tested)];
    for (const Part part : {Part::behind, Part::in_front})
      for (const std::uint32_t draw : group.parts[static_cast<std::size_t>(part)]) note_beyond_clear(draw);
    std::size_t opaque_left =
        static_cast<std::size_t>(std::ranges::count_if(tested, [&](std::uint32_t draw) { return is_opaque(draw); }));
    for (const std::uint32_t draw : tested) {
      const DepthState& depth = depth_of(draw);
      if (depth.function == Compare::always) note(draw, "depth function always, with depth writes");
      if (depth.function == Compare::not_equal) note(draw, "depth function not_equal");
      if (depth.function == Compare::equal && !repeats_earlier_[draw])
        note(draw, "depth function equal, without an earlier draw of the same triangles");
      if (is_less(depth.function) || is_greater(depth.function)) note_beyond_clear(draw);
      if (is_opaque(draw)) {
        --opaque_left;
        if (!acts_as_writer(draw)) note(draw, "depth is tested but not written");
      } else if (opaque_left > 0) {
        note(draw, "translucent, before opaque draws");
      } else if (wins_ties(depth.function)) {
        note(draw, "translucent, and visible where it is as far as what lies behind");
      }
    }
  }

  // Draws of whose depths some may not pass where the buffer is cleared.
  void note_beyond_clear(std::uint32_t draw) {
    const DepthState& depth = depth_of(draw);
    if (passes_always(depth)) return;
    if (is_reversed_ ? is_less(depth.function) : is_greater(depth.function))
      return note(draw, "depth functions less and greater are mixed");
    const bool passes_between =
        (is_less(depth.function) && clear_depth_ == 1) || (is_greater(depth.function) && clear_depth_ == 0);
    const bool passes_ends = passes_equal(depth.function) && depth.bias == DepthBias{};
    if (!passes_between || (!passes_ends && reaches_ends(trace_, frame_, frame_.draws[draw])))
      note(draw, "depth that may not pass where the depth buffer was cleared");
  }

  // A pre-pass says nothing if it keeps the nearest depth.
  void note_pre_pass(std::uint32_t draw) {
    const Compare function = depth_of(draw).function;
    if (is_less(function) || is_greater(function)) return note_beyond_clear(draw);
    note(draw, "depth without colour, by a function other than less and greater");
  }

  // Does the draw's depth count for later draws? It may have been written by a pre-pass of the same triangles.
  bool acts_as_writer(std::uint32_t draw) const {
    const DepthState& depth = depth_of(draw);
    return writes_depth(depth) || (depth.test && passes_equal(depth.function) && repeats_earlier_[draw]);
  }

  // Finds the draws of the group [first, end) whose triangles' depths an earlier one, drawn or not, has written.
  void find_repetitions(std::uint32_t first, std::uint32_t end) {
    std::unordered_set<std::uint32_t> written;
    for (std::uint32_t i = first; i < end; ++i) {
      if (!writes_color(frame_.draws[i].state) && writes_depth(depth_of(i))) note_pre_pass(i);
      if (may_be_cut_out(trace_, frame_.draws[i])) continue;
      repeats_earlier_[i] = written.contains(geometry_[i]);
      if (writes_depth(depth_of(i)) && is_opaque(i)) written.insert(geometry_[i]);
    }
  }

  void place_tested(const Group& group, const Interval& interval) {
    for (const std::uint32_t draw : group.parts[static_cast<std::size_t>(Part::tested)]) {
      const DepthState& depth = depth_of(draw);
      DrawPlacement& placement = placements_[draw];
      // Near is at window depth 0, or at 1 if reversed. An eighth of the interval stays free at both ends, so that
      // neighbours do not touch; nothing does if depths are kept.
      const double width = interval.is_kept ? 1 : 0.75 * interval.width;
      const double nearest = interval.nearest + (interval.is_kept ? 0 : 0.125 * interval.width);
      placement.window_scale = is_reversed_ ? -width : width;
      placement.window_offset = is_reversed_ ? nearest + width : nearest;
      const double near = depth.near, far = depth.far;  // window depths at -1 and 0
      placement.depth_scale = placement.window_scale * (far - near);
      placement.depth_offset = placement.window_scale * far + placement.window_offset;
      placement.bias_constant = depth.bias.constant, placement.bias_slope = depth.bias.slope;
      placement.bias_clamp = depth.bias.clamp;
      placement.last_wins = wins_ties(depth.function);
    }
  }

  // Later triangles lie in front of earlier ones. If there are so many that floats cannot tell neighbours apart, the
  // last one wins.
  void paint(const Group& group, std::size_t part, const Interval& interval) {
    const double steps = static_cast<double>(group.triangles[part] + 1);
    const double step = std::exp2(std::floor(std::log2(interval.width / steps)));
    std::uint64_t first = 1;
    for (const std::uint32_t draw : group.parts[part]) {
      DrawPlacement& placement = placements_[draw];
      placement.depth_scale = 0;
      placement.depth_offset = interval.nearest + interval.width - static_cast<double>(first) * step;
      placement.layer_step = step;
      placement.last_wins = true;
      first += triangles_of(draw);
    }
  }

  const Trace& trace_;
  const Frame& frame_;
  const std::vector<std::uint32_t>& geometry_;
  std::vector<DrawPlacement>& placements_;
  std::vector<DrawNote>& notes_;
  const float clear_depth_;            // window depth
  const bool is_reversed_;             // near is at window depth 1
  std::vector<bool> repeats_earlier_;  // by draw
  std::vector<Group> groups_;          // in the order of painting
};

// Of materials, not of programs.
bool has_material(const Trace& trace, const Draw& draw, AlphaMode mode) {
  const auto has_mode = [&](std::uint32_t material) {
    return material != kNoMaterial && trace.materials[material].alpha_mode == mode;
  };
  if (draw.kd) return false;
  return draw.material ? has_mode(*draw.material) : std::ranges::any_of(trace.meshes[draw.mesh].materials, has_mode);
}

}  // namespace

bool is_translucent(const Trace& trace, const Draw& draw) {
  if (!draw.program) return has_material(trace, draw, AlphaMode::blend);
  return program_alpha_mode(trace, draw, DrawOrder::by_depth) == AlphaMode::blend;
}

bool may_be_cut_out(const Trace& trace, const Draw& draw) {
  if (!draw.program) return has_material(trace, draw, AlphaMode::mask);
  return program_alpha_mode(trace, draw, DrawOrder::of_api) == AlphaMode::mask;
}

void order_depths(const Trace& trace, const Frame& frame, const std::vector<std::uint32_t>& geometry,
                  std::vector<DrawPlacement>& placements, std::vector<DrawNote>& notes) {
  DepthOrder order(trace, frame, geometry, placements, notes);
  order.find_groups();
  order.place();
}

}  // namespace beampipe
