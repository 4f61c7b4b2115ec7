// The sort of the A-buffer: a merge sort, whose comparisons do not depend on a library.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace beampipe {

template <class Float>
bool comes_first(Float depth, Float other) {
  return depth < other;
}

// Sorts list[0, count) by depth_of(record), near to far, equal depths as they are: merges runs of 1, 2, 4, ... records.
// Returns the comparisons, which depend on the depths alone.
template <class Record, class Depth>
std::uint64_t merge_sort(Record* list, std::size_t count, std::vector<Record>& scratch, Depth&& depth_of) {
  std::uint64_t comparisons = 0;
  if (scratch.size() < count) scratch.resize(count);
  Record *from = list, *to = scratch.data();
  for (std::size_t run = 1; run < count; run *= 2, std::swap(from, to)) {
    for (std::size_t begin = 0; begin < count; begin += 2 * run) {
      const std::size_t middle = std::min(begin + run, count), end = std::min(begin + 2 * run, count);
      std::size_t near = begin, far = middle, place = begin;
      while (near < middle && far < end) {
        ++comparisons;
        // Without a branch that nobody could predict.
        const bool from_far = comes_first(depth_of(from[far]), depth_of(from[near]));
        to[place++] = from[from_far ? far : near];
        far += from_far, near += !from_far;
      }
      while (near < middle) to[place++] = from[near++];
      while (far < end) to[place++] = from[far++];
    }
  }
  if (from != list) std::copy(from, from + count, list);
  return comparisons;
}

}  // namespace beampipe
