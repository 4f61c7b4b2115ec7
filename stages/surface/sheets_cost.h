// What numbering sheets is charged.
#pragma once

#include <bit>

#include "stages/cost/counters.h"

namespace beampipe {

// How often each part ran.
struct SheetsWork {
  std::uint64_t triangles = 0;   // that are not opaque
  std::uint64_t sides = 0;       // of these triangles, which are sorted to find the common ones
  std::uint64_t cells = 0;       // of the grid, once for each triangle that touches them
  std::uint64_t pairs = 0;       // of a triangle that was tried and one of the sheet
  std::uint64_t edge_tests = 0;  // of those whose bounding boxes overlap
};

// The bounding box of a triangle, and its cells.
inline OperationCounts box_cost() { return {.mul_add = 4, .add = 2 * 2 * 2 + 2 * 2, .convert = 4}; }

// Comparisons of two bounding boxes.
inline OperationCounts box_test_cost() { return {.add = 4}; }

// The coefficients of an edge, and the other triangle's corners on one side of it.
inline OperationCounts edge_test_cost() { return {.mul_add = 2 + 3 * 2, .add = 2 + 3}; }

// Numbers that are in use in a cell are collected, and later extended: 256 bits each.
inline OperationCounts cell_cost() { return {.bit = 2 * 8}; }

// Sides are sorted by the numbers of their two vertices.
inline OperationCounts sort_cost(std::uint64_t sides) {
  return OperationCounts{.add = 2} * (sides * std::bit_width(sides));
}

inline constexpr std::uint64_t kSheetNumberBytes = 4;  // of a triangle, beside its planes

inline void charge(const SheetsWork& work, StageCounters& counters) {
  constexpr std::uint64_t kSideBytes = 12,
                          kCellBytes = 8 + 32;  // two vertices and a triangle; an entry and the numbers
  counters.ops += box_cost() * work.triangles;
  counters.ops += box_test_cost() * work.pairs;
  counters.ops += edge_test_cost() * work.edge_tests;
  counters.ops += cell_cost() * work.cells;
  counters.ops += sort_cost(work.sides);
  counters.bytes_read += kSideBytes * work.sides + kCellBytes * work.cells + sizeof(std::uint64_t) * 3 * work.pairs;
  counters.bytes_written += kSideBytes * work.sides + kCellBytes * work.cells + kSheetNumberBytes * work.triangles;
}

}  // namespace beampipe
