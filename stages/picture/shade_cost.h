// What shading is charged.
#pragma once

#include <vector>

#include "stages/cost/counting.h"
#include "stages/data/pair.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/setup_triangle.h"
#include "stages/picture/picture_formulas.h"

namespace beampipe {

inline OperationCounts lambert_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), in[3] = {one, one, one};
    Counted<float> color[3];
    lambert(in, in, in, color);
  });
}

// Six components, of Kd and of the normal, become integers of the G-buffer.
inline OperationCounts material_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> value(1.0f, counts), scale(1.0f), offset(1.0f);
    for (int component = 0; component < 6; ++component) to_integer(value * scale + offset);
  });
}

// What the shader runs on.
struct Invocations {
  std::uint64_t items;        // fragments or samples
  std::uint64_t invocations;  // with the helper invocations of 2x2 quads
  std::uint64_t computed;     // invocations that are charged operations
};

template <class Items>
bool starts_quad(const Items& fragments, std::size_t i) {
  return i == 0 || fragments[i].quad != fragments[i - 1].quad;
}

// `attributes`: of the triangles; only quads of lit triangles compute. Null: all compute.
template <class Items>
Invocations in_quads(const Items& fragments, const std::vector<FlatAttributes>* attributes) {
  std::uint64_t quads = 0, lit = 0;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    if (!starts_quad(fragments, i)) continue;
    ++quads;
    lit += !attributes || (*attributes)[fragments[i].triangle].lit;
  }
  return {fragments.size(), 4 * quads, 4 * lit};
}

// The same for items that are shaded one by one.
template <class Items>
Invocations one_by_one(const Items& items, const std::vector<FlatAttributes>* attributes) {
  std::uint64_t lit = 0;
  for (const auto& item : items) lit += !attributes || (*attributes)[item.triangle].lit;
  return {items.size(), items.size(), lit};
}

// `cost`: per invocation that computes; bytes: per item.
inline void charge(const Invocations& shaded, const OperationCounts& cost, std::uint64_t bytes_read,
                   std::uint64_t bytes_written, StageCounters& counters) {
  counters.items_in += shaded.items;
  counters.items_out += shaded.items;
  counters.ops += cost * shaded.computed;
  counters.bytes_read += shaded.items * bytes_read;
  counters.bytes_written += shaded.items * bytes_written;
  counters.lanes_used += shaded.items;
  counters.lanes_issued += shaded.invocations;
}

}  // namespace beampipe
