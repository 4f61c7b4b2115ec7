// What sample_select is charged.
#pragma once

#include "simd/match.h"
#include "stages/cost/counting.h"
#include "stages/data/mix_bits.h"
#include "stages/data/sample_quad.h"

namespace beampipe {

// How often each operation was done.
struct SelectWork {
  std::uint64_t pixels = 0, quads = 0;
  std::uint64_t picks = 0, skips = 0;  // random choices of a set bit; set bits that were skipped
  std::uint64_t searches = 0;          // for a shading sample that can be switched
  std::uint64_t switched = 0;          // shading samples
  std::uint64_t extras = 0, ends = 0;  // extra samples; quads with room for more
  std::uint64_t groups = 0;            // of shading samples with the same material
  std::uint64_t given = 0;             // visibility samples that were given to a shading sample,
  std::uint64_t given_once = 0;        // and those for which there was only one candidate
  std::uint64_t stored = 0;            // shading samples that have a mask
  std::uint64_t shaded = 0;            // shading samples that show a triangle
};

// To find the samples of one material in a quad.
inline OperationCounts match_cost() {
  return count_operations([](OperationCounts& counts) {
    Counted<std::uint32_t> ids[kQuadSamples];
    for (auto& id : ids) id = Counted<std::uint32_t>(0, counts);
    match_mask_scalar(ids, ids[0]);
    counts.bit += kQuadSamples;  // to gather the comparisons in a mask
  });
}

// Per quad: the state of its random numbers, the samples inside the frame, those whose material has no shading sample,
// which of the four shading samples have the same material, and whether each of them is the first of its material.
inline OperationCounts quad_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<std::uint32_t> x(1, counts);
    mix_bits(mix_bits(mix_bits(x) ^ x) ^ x);
    for (int p = 0; p < 4; ++p) x& x;
    x & ~(x | x | x | x);
    counts += OperationCounts{.add = 4 * (4 * 2 + 1), .bit = 4 * (4 + 1)};
  });
}

inline OperationCounts pick_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<std::uint32_t> x(1, counts);
    mix_bits(x + x) % x;
    counts.bit += 2;  // the number of set bits, and the number of the one that is chosen
  });
}

// Per pixel and group of shading samples: whether each of the four is at this pixel, whether there is any, whether
// there is only one, and the group's visibility samples.
inline OperationCounts group_cost() { return {.add = 4 * (4 + 1), .bit = 4 * (4 * 2 + 2)}; }

inline void charge(const SelectWork& work, StageCounters& counters) {
  // A search looks at 12 pairs of shading samples: is the first one there, are they equal, note it.
  constexpr OperationCounts of_search{.add = 24, .bit = 12};
  constexpr OperationCounts of_switch{.bit = 3};  // its samples within the frame are no longer missing
  constexpr OperationCounts of_skip{.add = 1, .bit = 1};
  constexpr OperationCounts of_given{.add = 2, .bit = 4};  // takes the lowest bit off the list and puts it in a mask
  constexpr OperationCounts of_given_once{.bit = 1};       // the number of the only candidate
  constexpr std::uint64_t kSamples = 8;                    // per pixel
  counters.items_in += work.pixels * kSamples;
  counters.items_out += work.stored + work.extras;
  counters.ops += match_cost() * (4 * work.quads + work.switched + work.extras);
  counters.ops += quad_cost() * work.quads;
  counters.ops += of_search * work.searches;
  counters.ops += of_switch * (work.switched + work.extras);
  counters.ops += pick_cost() * work.picks;
  counters.ops += of_skip * work.skips;
  counters.ops += group_cost() * work.groups;
  counters.ops += of_given * work.given;
  counters.ops += of_given_once * work.given_once;
  counters.bytes_read += work.pixels * kSamples * 4;  // visibility ids
  counters.bytes_written += (work.stored + work.extras) * kShadingSampleBytes + work.ends * kEndOfExtrasBytes;
  counters.lanes_used += work.shaded;
  counters.lanes_issued += 4 * work.quads + work.extras;
}

}  // namespace beampipe
