#include "stages/surface/sheets.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <tuple>

#include "simd/sample_pattern.h"
#include "stages/surface/sheets_cost.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kNone = ~0u;
constexpr std::uint32_t kMostInCell = 64;  // triangles of a sheet

// A side of a triangle. The triangle lies to the same hand of all sides that face the same way, going from `from` to
// `to`. Vertices of different draws have different numbers.
struct Side {
  std::uint32_t from, to;
  bool front;
  std::uint32_t triangle, number;

  auto edge() const { return std::tuple(std::min(from, to), std::max(from, to), front); }
};

// Of a triangle: those across its sides, and the parts before and after it, if it was clipped.
using Neighbors = std::array<std::uint32_t, 5>;

// Clipping may turn one triangle into several in a row.
bool is_part_of_same(const SetupTriangles& triangles, std::uint32_t a, std::uint32_t b) {
  return !triangles.is_opaque(a) && !triangles.is_opaque(b) && triangles.draws[a] == triangles.draws[b] &&
         triangles.surfaces[a].trace_triangle == triangles.surfaces[b].trace_triangle;
}

// Of all triangles that are not opaque. Of the parts of a clipped triangle, the first one has the sides.
std::vector<Neighbors> neighbors_of(const SetupTriangles& triangles, SheetsWork& work) {
  std::vector<Neighbors> neighbors(triangles.surfaces.size(), Neighbors{kNone, kNone, kNone, kNone, kNone});
  std::vector<Side> sides;
  for (std::uint32_t i = 0; i < triangles.surfaces.size(); ++i) {
    if (triangles.is_opaque(i)) continue;
    if (i > 0 && is_part_of_same(triangles, i - 1, i)) {
      neighbors[i - 1][4] = i, neighbors[i][3] = i - 1;
      continue;
    }
    const auto& vertices = triangles.surfaces[i].vertices;
    for (std::uint32_t k = 0; k < 3; ++k)
      sides.push_back({vertices[k], vertices[(k + 1) % 3], triangles.triangles[i].front, i, k});
  }
  work.sides = sides.size();
  tbb::parallel_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tuple(a.edge(), a.triangle, a.number) < std::tuple(b.edge(), b.triangle, b.number);
  });
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    while (end < sides.size() && sides[end].edge() == sides[first].edge()) ++end;
    if (end != first + 2 || sides[first].from != sides[first + 1].to) continue;
    neighbors[sides[first].triangle][sides[first].number] = sides[first + 1].triangle;
    neighbors[sides[first + 1].triangle][sides[first + 1].number] = sides[first].triangle;
  }
  return neighbors;
}

// Inclusive, in 1/256 px or in cells.
struct Box {
  std::int32_t x0, y0, x1, y1;

  bool is_empty() const { return x0 > x1 || y0 > y1; }
};

Box box_of(const SetupTriangle& triangle) {
  const auto [x0, x1] = std::ranges::minmax(triangle.x);
  const auto [y0, y1] = std::ranges::minmax(triangle.y);
  return {x0, y0, x1, y1};
}

// Does a side of `a` have all of `b` on its other side?
bool is_beside(const SetupTriangle& a, const SetupTriangle& b, SheetsWork& work) {
  for (int k = 0; k < 3; ++k) {
    ++work.edge_tests;
    const Edge edge = edge_of(a, k);
    if (edge.at(b.x[0], b.y[0]) <= 0 && edge.at(b.x[1], b.y[1]) <= 0 && edge.at(b.x[2], b.y[2]) <= 0) return true;
  }
  return false;
}

// In an area, not only in points of their sides.
bool overlap(const SetupTriangle& a, const SetupTriangle& b, SheetsWork& work) {
  ++work.pairs;
  const Box p = box_of(a), q = box_of(b);
  if (p.x1 <= q.x0 || q.x1 <= p.x0 || p.y1 <= q.y0 || q.y1 <= p.y0) return false;
  return !is_beside(a, b, work) && !is_beside(b, a, work);
}

// The part of a triangle's box that lies in the frame, without the right and lower sides.
Box in_frame(const SetupTriangle& triangle, const Frame& frame) {
  const Box box = box_of(triangle);
  return {std::max(box.x0, 0), std::max(box.y0, 0),
          std::min(box.x1, static_cast<std::int32_t>(frame.width) * kSubpixelUnits) - 1,
          std::min(box.y1, static_cast<std::int32_t>(frame.height) * kSubpixelUnits) - 1};
}

// Cells that cover the frame.
class ScreenGrid {
 public:
  // There are about as many cells as triangles that are not opaque, or fewer, and one triangle touches up to four on
  // average.
  ScreenGrid(const SetupTriangles& triangles, const Frame& frame, SheetsWork& work) : frame_(frame) {
    double area = 0, extent = 0;
    for (std::uint32_t i = 0; i < triangles.surfaces.size(); ++i) {
      if (triangles.is_opaque(i)) continue;
      ++work.triangles;
      const Box box = in_frame(triangles.triangles[i], frame);
      if (box.is_empty()) continue;
      const double width = box.x1 - box.x0 + 1, height = box.y1 - box.y0 + 1;
      area += width * height, extent += width + height;
    }
    const double count = std::max<double>(static_cast<double>(work.triangles), 1), units = kSubpixelUnits;
    const double of_frame = frame.width * units * (frame.height * units);
    size_ = static_cast<std::int32_t>(
        std::ceil(std::max({std::sqrt(area / count), extent / (2 * count), std::sqrt(of_frame / count)})));
    columns_ = cell(static_cast<std::int32_t>(frame.width) * kSubpixelUnits - 1) + 1;
    rows_ = cell(static_cast<std::int32_t>(frame.height) * kSubpixelUnits - 1) + 1;
  }

  std::size_t cells() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }

  // Calls visit(cell) for the cells of the triangle's box until it returns false. Returns whether it never did.
  template <class Visit>
  bool for_each_cell(const SetupTriangle& triangle, Visit&& visit) const {
    const Box box = in_frame(triangle, frame_);
    if (box.is_empty()) return true;
    for (std::int32_t y = cell(box.y0); y <= cell(box.y1); ++y)
      for (std::int32_t x = cell(box.x0); x <= cell(box.x1); ++x)
        if (!visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)))
          return false;
    return true;
  }

 private:
  std::int32_t cell(std::int32_t at) const { return at / size_; }

  const Frame& frame_;
  std::int32_t size_, columns_, rows_;
};

// Numbers 0..255.
class NumberSet {
 public:
  void add(const NumberSet& other) {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= other.words_[i];
  }
  void add(std::uint32_t number) { words_[number / 64] |= std::uint64_t{1} << number % 64; }

  std::optional<std::uint32_t> least_free() const {
    for (std::uint32_t i = 0; i < words_.size(); ++i)
      if (~words_[i] != 0) return 64 * i + static_cast<std::uint32_t>(std::countr_one(words_[i]));
    return std::nullopt;
  }

  static constexpr std::uint32_t kSize = 256;

 private:
  std::array<std::uint64_t, kSize / 64> words_{};
};

// The sheet that grows.
class Sheet {
 public:
  Sheet(const SetupTriangles& triangles, const ScreenGrid& grid, SheetsWork& work)
      : triangles_(triangles.triangles), grid_(grid), work_(work), first_(grid.cells(), kNone), used_(grid.cells()) {}

  bool has_room_for(std::uint32_t triangle) const {
    return grid_.for_each_cell(triangles_[triangle], [&](std::size_t cell) {
      std::uint32_t count = 0;
      for (std::uint32_t i = first_[cell]; i != kNone; i = entries_[i].next)
        if (++count == kMostInCell || overlap(triangles_[triangle], triangles_[entries_[i].triangle], work_))
          return false;
      return true;
    });
  }

  void add(std::uint32_t triangle) {
    grid_.for_each_cell(triangles_[triangle], [&](std::size_t cell) {
      entries_.push_back({cell, triangle, first_[cell]});
      first_[cell] = static_cast<std::uint32_t>(entries_.size() - 1);
      return true;
    });
  }

  // Its number. The next sheet begins.
  std::uint32_t finish() {
    NumberSet used;
    for (const Entry& entry : entries_) used.add(used_[entry.cell]);
    const std::optional<std::uint32_t> free = used.least_free();
    const std::uint32_t number = free ? *free : NumberSet::kSize + beyond_++;
    for (const Entry& entry : entries_) {
      if (free) used_[entry.cell].add(number);
      first_[entry.cell] = kNone;
    }
    work_.cells += entries_.size();
    entries_.clear();
    return number;
  }

 private:
  struct Entry {
    std::size_t cell;
    std::uint32_t triangle, next;  // in the same cell
  };

  const std::vector<SetupTriangle>& triangles_;
  const ScreenGrid& grid_;
  SheetsWork& work_;
  std::vector<std::uint32_t> first_;  // entry of each cell
  std::vector<Entry> entries_;
  std::vector<NumberSet> used_;  // in each cell, by earlier sheets
  std::uint32_t beyond_ = 0;     // sheets for which no number was free
};

}  // namespace

std::vector<std::uint32_t> number_sheets(const SetupTriangles& triangles, const Frame& frame, StageCounters& counters) {
  SheetsWork work;
  const std::size_t count = triangles.surfaces.size();
  const std::vector<Neighbors> neighbors = neighbors_of(triangles, work);
  const ScreenGrid grid(triangles, frame, work);
  Sheet sheet(triangles, grid, work);
  std::vector<std::uint32_t> numbers(count, kNone), refused_by(count, kNone), members;
  for (std::uint32_t first = 0; first < count; ++first) {
    if (triangles.is_opaque(first) || numbers[first] != kNone) continue;
    members = {first};
    numbers[first] = 0;  // until the sheet is finished
    sheet.add(first);
    for (std::size_t m = 0; m < members.size(); ++m)
      for (const std::uint32_t next : neighbors[members[m]]) {
        if (next == kNone || numbers[next] != kNone || refused_by[next] == first) continue;
        if (!sheet.has_room_for(next)) {
          refused_by[next] = first;
          continue;
        }
        numbers[next] = 0;
        sheet.add(next);
        members.push_back(next);
      }
    const std::uint32_t number = sheet.finish();
    for (const std::uint32_t member : members) numbers[member] = number;
  }
  charge(work, counters);
  return numbers;
}

}  // namespace beampipe
