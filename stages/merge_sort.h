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
  for (std::size_t run = 1; run < count; run *= 2) {
    for (std::size_t begin = 0; begin + run < count; begin += 2 * run) {
      const std::size_t middle = begin + run, end = std::min(begin + 2 * run, count);
      std::size_t near = begin, far = middle, to = begin;
      while (near < middle && far < end) {
        ++comparisons;
        // Without a branch that nobody could predict.
        const bool from_far = comes_first(depth_of(list[far]), depth_of(list[near]));
        scratch[to++] = list[from_far ? far : near];
        far += from_far, near += !from_far;
      }
      // What is left of the nearer run belongs at the end; what is left of the farther one is there already.
      std::copy_backward(list + near, list + middle, list + end);
      std::copy(scratch.data() + begin, scratch.data() + to, list + begin);
    }
  }
  return comparisons;
}

}  // namespace beampipe
