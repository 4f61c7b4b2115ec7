#include "stages/geometry/draw_geometry.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <tuple>

namespace beampipe {
namespace {

template <class Item>
int compare_bytes(const std::vector<Item>& one, const std::vector<Item>& other) {
  if (one.size() != other.size()) return one.size() < other.size() ? -1 : 1;
  return one.empty() ? 0 : std::memcmp(one.data(), other.data(), one.size() * sizeof(Item));
}

// Any order in which only meshes with the same positions and triangles are equal.
struct MeshOrder {
  const std::vector<Mesh>& meshes;
  bool operator()(std::uint32_t one, std::uint32_t other) const {
    if (one == other) return false;
    const Mesh &a = meshes[one], &b = meshes[other];
    if (const int order = compare_bytes(a.triangles, b.triangles)) return order < 0;
    if (const int order = compare_bytes(a.positions, b.positions)) return order < 0;
    return compare_bytes(a.ws, b.ws) < 0;
  }
};

// Any order in which only draws that put one mesh at the same place are equal.
struct PlaceOrder {
  bool operator()(const Draw* one, const Draw* other) const { return compare(*one, *other) < 0; }

  static int compare(const Draw& one, const Draw& other) {
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row)
        if (const double a = one.transform[column][row], b = other.transform[column][row]; a != b)
          return a < b ? -1 : 1;
    const auto rest = [](const Draw& draw) {
      const Viewport viewport = draw.state.viewport.value_or(Viewport{});  // the width of none is 0
      const bool has_scissor = draw.state.scissor.has_value();
      const Scissor scissor = draw.state.scissor.value_or(Scissor{});
      const DepthState& depth = draw.state.depth;
      return std::tuple(depth.near, depth.far, depth.bias.constant, depth.bias.slope, depth.bias.clamp, depth.clip,
                        viewport.x, viewport.y, viewport.width, viewport.height, has_scissor, scissor.x, scissor.y,
                        scissor.width, scissor.height, draw.cull, draw.state.front_is_clockwise,
                        // Materials may be single-sided.
                        draw.material.value_or(kNoMaterial), draw.kd || draw.program);
    };
    return rest(one) < rest(other) ? -1 : rest(other) < rest(one) ? 1 : 0;
  }
};

}  // namespace

std::vector<std::uint32_t> geometry_numbers(const Trace& trace, const Frame& frame) {
  std::set<std::uint32_t, MeshOrder> meshes(MeshOrder{trace.meshes});                 // one of each kind
  std::map<std::uint32_t, std::map<const Draw*, std::uint32_t, PlaceOrder>> numbers;  // by mesh and place
  std::vector<std::uint32_t> number_of_draw;
  std::uint32_t next = 0;
  for (const Draw& draw : frame.draws) {
    const std::uint32_t mesh = *meshes.insert(draw.mesh).first;
    const auto [number, is_new] = numbers[mesh].try_emplace(&draw, next);
    if (is_new) ++next;
    number_of_draw.push_back(number->second);
  }
  return number_of_draw;
}

}  // namespace beampipe
