// The sort of the A-buffer. It is a merge sort of our own, so that the number of comparisons does not depend on a
// library.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace beampipe {

// Does a record with this depth precede the other one?
template <class Float>
bool comes_first(Float depth, Float other) {
  return depth < other;
}

// So many records are compared each with each. The lists of most pixels are not longer.
inline constexpr std::size_t kSortedRun = 8;

// Sorts list[0, count) with count <= kSortedRun: a record's place is the number of records that precede it. Returns
// the number of comparisons. No branch depends on a depth, because no processor could predict such a branch.
template <class Record, class Depth>
std::uint64_t rank_sort(Record* list, std::size_t count, Depth&& depth_of) {
  std::array<Record, kSortedRun> from;
  std::array<std::uint32_t, kSortedRun> rank{};
  for (std::size_t i = 0; i < count; ++i) {
    from[i] = list[i];
    for (std::size_t j = 0; j < i; ++j) {
      const bool before = comes_first(depth_of(from[i]), depth_of(from[j]));
      rank[j] += before, rank[i] += !before;
    }
  }
  for (std::size_t i = 0; i < count; ++i) list[rank[i]] = from[i];
  return count * (count - 1) / 2;
}

// Sorts list[0, count) by depth_of(record), from near to far; equal depths keep their order. Sorts short runs and
// merges them. Returns the number of comparisons, which depends on the depths alone.
template <class Record, class Depth>
std::uint64_t merge_sort(Record* list, std::size_t count, std::vector<Record>& scratch, Depth&& depth_of) {
  std::uint64_t comparisons = 0;
  for (std::size_t begin = 0; begin < count; begin += kSortedRun)
    comparisons += rank_sort(list + begin, std::min(kSortedRun, count - begin), depth_of);
  if (count <= kSortedRun) return comparisons;
  if (scratch.size() < count) scratch.resize(count);
  Record *from = list, *to = scratch.data();
  for (std::size_t run = kSortedRun; run < count; run *= 2, std::swap(from, to)) {
    for (std::size_t begin = 0; begin < count; begin += 2 * run) {
      const std::size_t middle = std::min(begin + run, count), end = std::min(begin + 2 * run, count);
      std::size_t near = begin, far = middle, place = begin;
      while (near < middle && far < end) {
        ++comparisons;
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
