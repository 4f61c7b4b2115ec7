// The samples of the reference that a triangle covers: runs in rows, found by exact division.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "simd/depth_span.h"
#include "simd/sample_pattern.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"
#include "stages/raster/cutout_cells.h"
#include "stages/raster/reference_raster.h"

namespace beampipe {

// A cell has 16 rows of one sample each.
inline constexpr std::int32_t kRowsPerCell = 16;

// Of a sample of a tile, by its number.
inline std::size_t cell_of(std::size_t sample, std::size_t row_samples) {
  return sample / row_samples / kRowsPerCell * row_samples + sample % row_samples;
}

// Sample positions are integers in ReferencePattern::units(), 1/8192 px: x = 512 i + 2 reverse(row) + 1,
// y = 32 row + 16.
struct Steps {
  explicit Steps(const ReferencePattern& pattern)
      : units(pattern.units()), x(units / pattern.columns), y(units / pattern.rows()), scale(units / kSubpixelUnits) {}

  std::int64_t units;  // per pixel
  std::int64_t x, y;   // between samples of a row, and between rows
  std::int64_t scale;  // per 1/256 px
};

inline std::int64_t floor_quotient(std::int64_t dividend, std::int64_t divisor) {  // divisor > 0
  const std::int64_t quotient = dividend / divisor;
  return quotient - (dividend % divisor < 0);
}

// Samples [first, end) of a sample row, in frame coordinates.
struct Span {
  std::int64_t first, end;
};

// Keeps the samples i at which a (step i + offset) + rest >= 0.
inline void cut(Span& span, std::int64_t a, std::int64_t step, std::int64_t offset, std::int64_t rest) {
  const std::int64_t at_zero = a * offset + rest, per_sample = a * step;
  if (per_sample == 0) {
    if (at_zero < 0) span.end = span.first;
  } else if (per_sample > 0) {
    span.first = std::max(span.first, -floor_quotient(at_zero, per_sample));
  } else {
    span.end = std::min(span.end, floor_quotient(at_zero, -per_sample) + 1);
  }
}

// A run of samples in a row.
struct SampleRun {
  const Tile& tile;
  const ReferencePattern& pattern;
  std::int64_t row, column;  // of the first sample, in the frame
  std::int64_t x, y;         // of its place in the pixel, in units
  std::uint32_t at;          // its index in the tile
  std::size_t count;
};

// Where the samples of a tile are.
class SpanPlaces {
 public:
  // Both must outlive it.
  SpanPlaces(const Tile& tile, const ReferencePattern& pattern)
      : tile_(tile),
        pattern_(pattern),
        steps_(pattern),
        left_(std::int64_t{tile.x0} * pattern.columns),
        right_(std::int64_t{tile.x1} * pattern.columns),
        top_(std::int64_t{tile.y0} * pattern.rows()),
        bottom_(std::int64_t{tile.y1} * pattern.rows()) {
    for (std::int64_t row = top_; row < bottom_; ++row) {
      firsts_.push_back(pattern.first_in_row(row));
      firsts_.back().y += floor_quotient(row, pattern.rows()) * steps_.units;
    }
  }

  // Calls visit(SampleRun, DepthSpan) for each row in which the triangle covers samples.
  template <class Visit>
  void for_each_run(const SetupTriangle& t, Visit&& visit) const {
    const auto [y_low, y_high] = std::minmax({t.y[0], t.y[1], t.y[2]});
    const Edge edges[3] = {edge_of(t, 0), edge_of(t, 1), edge_of(t, 2)};
    const std::int64_t first_row = std::max(top_, floor_quotient(y_low * steps_.scale, steps_.y));
    const std::int64_t end_row = std::min(bottom_, floor_quotient(y_high * steps_.scale, steps_.y) + 1);
    const double unit = 1.0 / static_cast<double>(steps_.units);
    for (std::int64_t row = first_row; row < end_row; ++row) {
      const auto [offset, y] = firsts_[static_cast<std::size_t>(row - top_)];
      Span span{left_, right_};
      for (const Edge& edge : edges)
        cut(span, edge.a, steps_.x, offset, edge.b * y + edge.c * steps_.scale - (edge.owns ? 0 : 1));
      if (span.first >= span.end) continue;
      const DepthSpan depths{t.depth.z, t.depth.dzdx, t.depth.dzdy * (static_cast<double>(y) * unit - t.depth.anchor_y),
                             static_cast<double>(span.first * steps_.x + offset) * unit - t.depth.anchor_x,
                             static_cast<double>(steps_.x) * unit};
      const std::int64_t at = (row - top_) * (right_ - left_) + span.first - left_;
      visit(SampleRun{tile_, pattern_, row, span.first, offset, y & (steps_.units - 1), static_cast<std::uint32_t>(at),
                      static_cast<std::size_t>(span.end - span.first)},
            depths);
    }
  }

 private:
  const Tile& tile_;
  const ReferencePattern& pattern_;
  Steps steps_;
  std::int64_t left_, right_, top_, bottom_;     // in columns and rows of samples
  std::vector<ReferencePattern::Place> firsts_;  // of each row, in the frame's first column of pixels
};

// Calls visit(i, is_there) for the samples of a run where a cutout may be there; is_there() tells whether it is.
template <class Visit>
void for_each_sample(const SampleRun& run, std::uint32_t triangle, const TileShader& shader, CutoutCells& cells,
                     Visit&& visit) {
  const float unit = 1.0f / static_cast<float>(run.pattern.units());
  const int log_columns = std::countr_zero(static_cast<std::uint32_t>(run.pattern.columns));
  const std::int64_t last_column = run.pattern.columns - 1, step = run.pattern.units() / run.pattern.columns;
  const auto pixel_y = static_cast<std::int32_t>(floor_quotient(run.row, run.pattern.rows()));
  const auto cell_row = static_cast<std::int32_t>((run.row & (run.pattern.rows() - 1)) / kRowsPerCell);
  const float v = static_cast<float>(run.y) * unit, cutoff = shader.alpha_cutoff(triangle);
  for (std::size_t i = 0; i < run.count;) {
    const std::int64_t first = run.column + static_cast<std::int64_t>(i);
    const auto pixel =
        static_cast<std::uint32_t>(run.tile.index(static_cast<std::int32_t>(first >> log_columns), pixel_y));
    const std::size_t end = std::min(run.count, i + static_cast<std::size_t>(last_column - (first & last_column)) + 1);
    const CutoutCover of_pixel = cells.of_pixel(pixel);
    if (of_pixel == CutoutCover::none) i = end;
    for (; i < end; ++i) {
      visit(i, [&] {
        if (of_pixel != CutoutCover::mixed) return true;
        const std::int64_t column = (run.column + static_cast<std::int64_t>(i)) & last_column;
        const CutoutCover cover = cells.of_cell(pixel, static_cast<std::int32_t>(column), cell_row);
        if (cover != CutoutCover::mixed) return cover == CutoutCover::all;
        const float u = static_cast<float>(run.x + step * column) * unit;
        return shader.alpha(triangle, pixel, u, v, 0.0f) >= cutoff;
      });
    }
  }
}

}  // namespace beampipe
