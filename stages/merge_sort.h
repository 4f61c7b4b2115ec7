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

// Sorts list[0, count) by depth, near to far, equal depths as they are: merges runs of 1, 2, 4, ... records. Returns
// the comparisons, which depend on the depths alone.
template <class Depth>
std::uint64_t merge_sort(std::uint32_t* list, std::size_t count, std::vector<std::uint32_t>& scratch, Depth&& depth) {
  std::uint64_t comparisons = 0;
  scratch.resize(count);
  for (std::size_t run = 1; run < count; run *= 2) {
    for (std::size_t begin = 0; begin + run < count; begin += 2 * run) {
      const std::size_t middle = begin + run, end = std::min(begin + 2 * run, count);
      std::size_t near = begin, far = middle, to = begin;
      while (near < middle && far < end) {
        ++comparisons;
        scratch[to++] = comes_first(depth(list[far]), depth(list[near])) ? list[far++] : list[near++];
      }
      to = static_cast<std::size_t>(std::copy(list + near, list + middle, scratch.data() + to) - scratch.data());
      std::copy(list + far, list + end, scratch.data() + to);
      std::copy(scratch.data() + begin, scratch.data() + end, list + begin);
    }
  }
  return comparisons;
}

}  // namespace beampipe
