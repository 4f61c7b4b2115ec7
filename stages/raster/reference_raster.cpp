#include "stages/raster/reference_raster.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "simd/depth_span.h"
#include "simd/sample_pattern.h"
#include "stages/data/mix_bits.h"
#include "stages/raster/cutout_cells.h"
#include "stages/raster/reference_raster_cost.h"

namespace beampipe {
namespace {

// A cell has 16 rows of one sample each.
constexpr std::int32_t kRowsPerCell = 16;

// Sample positions are integers in ReferencePattern::units(), 1/8192 px: x = 512 i + 2 reverse(row) + 1,
// y = 32 row + 16.
struct Steps {
  explicit Steps(const ReferencePattern& pattern)
      : units(pattern.units()), x(units / pattern.columns), y(units / pattern.rows()), scale(units / kSubpixelUnits) {}

  std::int64_t units;  // per pixel
  std::int64_t x, y;   // between samples of a row, and between rows
  std::int64_t scale;  // per 1/256 px
};

std::int64_t floor_quotient(std::int64_t dividend, std::int64_t divisor) {  // divisor > 0
  const std::int64_t quotient = dividend / divisor;
  return quotient - (dividend % divisor < 0);
}

// Samples [first, end) of a sample row, in frame coordinates.
struct Span {
  std::int64_t first, end;
};

// Keeps the samples i at which a (step i + offset) + rest >= 0.
void cut(Span& span, std::int64_t a, std::int64_t step, std::int64_t offset, std::int64_t rest) {
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

// Lists the samples of a run that a translucent triangle may be seen at. Returns how many.
std::uint64_t list_layers(const DepthSpan& span, std::uint32_t triangle, const SampleRun& run, ReferenceTile& surface) {
  std::uint64_t found = 0;
  for (std::size_t i = 0; i < run.count; ++i) {
    const auto at = static_cast<std::uint32_t>(run.at + i);
    double depth = 0;
    if (!depth_span_sample(span, static_cast<double>(i), surface.depth[at], depth)) continue;
    ++found;
    surface.layers.push_back({at, triangle, depth});
  }
  return found;
}

// Takes the samples of a run at which a cutout is there. Returns how many.
std::uint64_t take_cutout(const DepthSpan span, std::uint32_t triangle, const SampleRun& run, const TileShader& shader,
                          CutoutCells& cells, ReferenceTile& surface) {
  const float unit = 1.0f / static_cast<float>(run.pattern.units());
  const int log_columns = std::countr_zero(static_cast<std::uint32_t>(run.pattern.columns));
  const std::int64_t last_column = run.pattern.columns - 1, step = run.pattern.units() / run.pattern.columns;
  const auto pixel_y = static_cast<std::int32_t>(floor_quotient(run.row, run.pattern.rows()));
  const auto cell_row = static_cast<std::int32_t>((run.row & (run.pattern.rows() - 1)) / kRowsPerCell);
  const float v = static_cast<float>(run.y) * unit, cutoff = shader.alpha_cutoff(triangle);
  double* const depths = surface.depth.data() + run.at;
  std::uint64_t* const owners = surface.owner.data() + run.at;
  std::uint64_t found = 0;
  for (std::size_t i = 0; i < run.count;) {
    const std::int64_t first = run.column + static_cast<std::int64_t>(i);
    const auto pixel =
        static_cast<std::uint32_t>(run.tile.index(static_cast<std::int32_t>(first >> log_columns), pixel_y));
    const std::size_t end = std::min(run.count, i + static_cast<std::size_t>(last_column - (first & last_column)) + 1);
    const CutoutCover of_pixel = cells.of_pixel(pixel);
    if (of_pixel == CutoutCover::none) i = end;
    for (; i < end; ++i) {
      double depth = 0;
      if (!depth_span_sample(span, static_cast<double>(i), depths[i], depth)) continue;
      if (of_pixel == CutoutCover::mixed) {
        const std::int64_t column = (run.column + static_cast<std::int64_t>(i)) & last_column;
        const CutoutCover cover = cells.of_cell(pixel, static_cast<std::int32_t>(column), cell_row);
        if (cover == CutoutCover::none) continue;
        const float u = static_cast<float>(run.x + step * column) * unit;
        if (cover == CutoutCover::mixed && shader.alpha(triangle, pixel, u, v, 0.0f) < cutoff) continue;
      }
      ++found;
      depths[i] = depth;
      owners[i] = triangle;
    }
  }
  return found;
}

}  // namespace

ReferencePattern::Place ReferencePattern::first_in_row(std::int64_t row) const {
  const int bits = std::countr_zero(static_cast<std::uint32_t>(rows()));
  const auto in_pixel = static_cast<std::uint32_t>(row & (rows() - 1));
  const std::int64_t height = units() / rows();
  std::int64_t shift = 0;
  for (int bit = 0; bit < bits; ++bit) {
    std::uint32_t digit = in_pixel >> bit & 1;
    // Each digit is turned over by a random choice that depends on the digits before it.
    if (set > 1)
      digit ^= mix_bits(static_cast<std::uint32_t>(set) << 20 | 1u << bit | (in_pixel & ((1u << bit) - 1))) & 1;
    shift |= std::int64_t{digit} << (bits - 1 - bit);
  }
  std::int64_t y = height / 2;
  if (set > 1) y = mix_bits(static_cast<std::uint32_t>(set) << 20 | 1u << 16 | in_pixel) % (height / 2) * 2 + 1;
  return {2 * shift + 1, height * (row & (rows() - 1)) + y};
}

ReferenceTile::ReferenceTile(const Tile& tile, const ReferencePattern& of)
    : row_samples(static_cast<std::size_t>(tile.width() * of.columns)), pattern(of) {
  const std::size_t samples = row_samples * static_cast<std::size_t>(tile.height() * of.rows());
  depth.assign(samples, std::numeric_limits<double>::infinity());
  owner.assign(samples, kNoOwner);
}

void reference_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                      StageCounters& counters, ReferenceTile& surface, const TileShader* shader) {
  const ReferencePattern& pattern = surface.pattern;
  const Steps steps(pattern);
  const std::int64_t left = std::int64_t{tile.x0} * pattern.columns, right = std::int64_t{tile.x1} * pattern.columns;
  const std::int64_t top = std::int64_t{tile.y0} * pattern.rows(), bottom = std::int64_t{tile.y1} * pattern.rows();
  std::vector<ReferencePattern::Place> places;  // of each row's first sample, in the frame's first column of pixels
  for (std::int64_t row = top; row < bottom; ++row) {
    places.push_back(pattern.first_in_row(row));
    places.back().y += floor_quotient(row, pattern.rows()) * steps.units;
  }
  std::optional<CutoutCells> cells;
  std::uint64_t covered = 0, nearer = 0;  // samples
  for (const std::uint32_t index : list) {
    const SetupTriangle& t = triangles.triangles[index];
    const auto [y_low, y_high] = std::minmax({t.y[0], t.y[1], t.y[2]});
    if (shader && shader->is_cutout(index)) {
      if (!cells) cells.emplace(*shader, tile, pattern.columns);
      cells->start(index);
    }
    const Edge edges[3] = {edge_of(t, 0), edge_of(t, 1), edge_of(t, 2)};
    const std::int64_t first_row = std::max(top, floor_quotient(y_low * steps.scale, steps.y));
    const std::int64_t end_row = std::min(bottom, floor_quotient(y_high * steps.scale, steps.y) + 1);
    for (std::int64_t row = first_row; row < end_row; ++row) {
      const auto [offset, y] = places[static_cast<std::size_t>(row - top)];
      Span span{left, right};
      for (const Edge& edge : edges)
        cut(span, edge.a, steps.x, offset, edge.b * y + edge.c * steps.scale - (edge.owns ? 0 : 1));
      if (span.first >= span.end) continue;
      const double unit = 1.0 / static_cast<double>(steps.units);
      const DepthSpan depths{t.depth.z, t.depth.dzdx, t.depth.dzdy * (static_cast<double>(y) * unit - t.depth.anchor_y),
                             static_cast<double>(span.first * steps.x + offset) * unit - t.depth.anchor_x,
                             static_cast<double>(steps.x) * unit};
      const std::size_t at =
          static_cast<std::size_t>(row - top) * surface.row_samples + static_cast<std::size_t>(span.first - left);
      const auto count = static_cast<std::size_t>(span.end - span.first);
      covered += count;
      if (triangles.is_opaque(index)) {
        nearer += depth_span(depths, count, index, surface.depth.data() + at, surface.owner.data() + at);
        continue;
      }
      const SampleRun run{tile, pattern, row, span.first, offset, y & (steps.units - 1), static_cast<std::uint32_t>(at),
                          count};
      nearer += cells && shader->is_cutout(index) ? take_cutout(depths, index, run, *shader, *cells, surface)
                                                  : list_layers(depths, index, run, surface);
    }
  }
  charge_reference(covered, nearer, counters);
}

namespace {

// Adds the colours of the samples of one pixel. `owner`: of its first sample.
class PixelSum {
 public:
  PixelSum(const TileShader& shader, const glm::vec3& background, const ReferenceTile& surface)
      : shader_(shader),
        clear_(background),
        row_samples_(surface.row_samples),
        rows_(surface.pattern.rows()),
        columns_(surface.pattern.columns),
        steps_(surface.pattern) {
    for (std::int32_t row = 0; row < rows_; ++row) places_.push_back(surface.pattern.first_in_row(row));
  }

  void add_flat(const std::uint64_t* owner, glm::dvec3& sum) const {
    for (std::int32_t row = 0; row < rows_; ++row, owner += row_samples_)
      for (std::int32_t s = 0; s < columns_; ++s)
        sum += owner[s] == kNoOwner ? clear_ : glm::dvec3(shader_.color(triangle_of(owner[s]), 0, 0, 0));
  }

  // All surfaces of the pixel are shaded side by side, which takes less time.
  void add_varying(const std::uint64_t* owner, std::uint32_t pixel, glm::dvec3& sum) const {
    std::vector<Part> parts;
    for (std::int32_t row = 0; row < rows_; row += kRowsPerCell)
      for (std::int32_t column = 0; column < columns_; ++column)
        add_cell(owner + static_cast<std::size_t>(row) * row_samples_ + column, row, column, parts);
    std::vector<Invocation> invocations;
    const auto is_varying = [&](const Part& part) {
      return part.owner != kNoOwner && !shader_.is_flat(triangle_of(part.owner));
    };
    for (const Part& part : parts)
      if (is_varying(part))
        invocations.push_back(
            {triangle_of(part.owner), shader_.place(pixel, part.u, part.v), 1.0f / static_cast<float>(columns_)});
    const std::vector<glm::vec3> colors = shader_.colors(invocations);
    auto next = colors.begin();
    for (const Part& part : parts)
      sum += part.count * (part.owner == kNoOwner ? clear_
                           : is_varying(part)     ? glm::dvec3(*next++)
                                                  : glm::dvec3(shader_.color(triangle_of(part.owner), 0, 0, 0)));
  }

  // As add_varying, under the translucent layers of the pixel, which are sorted by sample and then by depth. `first`:
  // of the pixel's first sample. Returns how many of the background's samples the layers cover.
  double add_layered(const std::vector<ReferenceTile::Layer>& layers, const std::uint64_t* owner, std::size_t first,
                     std::uint32_t pixel, glm::dvec3& sum) const {
    std::map<std::pair<std::uint64_t, std::int32_t>, glm::dvec4> colors;  // of triangles in cells
    const auto color_at = [&](std::uint64_t triangle, std::int32_t row, std::int32_t column) -> const glm::dvec4& {
      const std::int32_t cell = row / kRowsPerCell * columns_ + column;
      const auto [found, is_new] = colors.try_emplace({triangle, cell});
      if (is_new) {
        const float cells = static_cast<float>(columns_);
        const float u = (static_cast<float>(column) + 0.5f) / cells;
        const float v = (static_cast<float>(row / kRowsPerCell) + 0.5f) / cells;
        found->second = triangle == kNoOwner
                            ? glm::dvec4(clear_, 1.0)
                            : glm::dvec4(shader_.color_and_alpha(triangle_of(triangle), pixel, u, v, 1.0f / cells));
      }
      return found->second;
    };
    double covered = 0;
    std::size_t next = 0;
    for (std::int32_t row = 0; row < rows_; ++row) {
      for (std::int32_t column = 0; column < columns_; ++column) {
        const std::size_t offset = static_cast<std::size_t>(row) * row_samples_ + static_cast<std::size_t>(column);
        double light = 1;
        for (; next < layers.size() && layers[next].sample == first + offset; ++next) {
          const glm::dvec4& color = color_at(layers[next].triangle, row, column);
          sum += light * color.a * glm::dvec3(color);
          light *= 1 - color.a;
        }
        sum += light * glm::dvec3(color_at(owner[offset], row, column));
        if (owner[offset] == kNoOwner) covered += 1 - light;
      }
    }
    return covered;
  }

  // Do all samples show the background or flat triangles?
  bool is_flat(const std::uint64_t* owner) const {
    if (shader_.is_flat()) return true;
    for (std::int32_t row = 0; row < rows_; ++row, owner += row_samples_)
      for (std::int32_t s = 0; s < columns_; ++s)
        if (owner[s] != kNoOwner && !shader_.is_flat(triangle_of(owner[s]))) return false;
    return true;
  }

 private:
  static std::uint32_t triangle_of(std::uint64_t owner) { return static_cast<std::uint32_t>(owner); }

  // The samples that one owner has in a cell, and where they are in the pixel on average.
  struct Part {
    std::uint64_t owner;
    double count;
    float u, v;
  };

  void add_cell(const std::uint64_t* owner, std::int32_t row, std::int32_t column, std::vector<Part>& parts) const {
    std::int32_t added[kRowsPerCell];  // rows whose samples are added
    std::int32_t left = 0;
    for (std::int32_t i = 0; i < kRowsPerCell; ++i) added[left++] = i;
    const auto owner_at = [&](std::int32_t i) { return owner[static_cast<std::size_t>(i) * row_samples_]; };
    while (left > 0) {
      const std::uint64_t first = owner_at(added[0]);
      std::int64_t count = 0, x = 0, y = 0;  // of this owner's samples, in 1/8192 px
      std::int32_t rest = 0;
      for (std::int32_t k = 0; k < left; ++k) {
        const std::int32_t i = added[k];
        if (owner_at(i) != first) {
          added[rest++] = i;
          continue;
        }
        ++count;
        const ReferencePattern::Place& place = places_[static_cast<std::size_t>(row + i)];
        x += steps_.x * column + place.x;
        y += place.y;
      }
      left = rest;
      const float unit = 1.0f / (static_cast<float>(count) * static_cast<float>(steps_.units));
      parts.push_back({first, static_cast<double>(count), static_cast<float>(x) * unit, static_cast<float>(y) * unit});
    }
  }

  const TileShader& shader_;
  glm::dvec3 clear_;
  std::size_t row_samples_;
  std::int32_t rows_, columns_;  // of a pixel's samples, and `columns_` of its cells
  Steps steps_;
  std::vector<ReferencePattern::Place> places_;
};

}  // namespace

std::vector<std::vector<ReferenceTile::Layer>> layers_of_pixels(const ReferenceTile& surface, const Tile& tile) {
  const auto rows = static_cast<std::size_t>(surface.pattern.rows());
  const auto columns = static_cast<std::size_t>(surface.pattern.columns);
  std::vector<std::vector<ReferenceTile::Layer>> pixels(tile.pixels());
  for (const ReferenceTile::Layer& layer : surface.layers) {
    if (layer.depth >= surface.depth[layer.sample]) continue;
    const std::size_t row = layer.sample / surface.row_samples, column = layer.sample % surface.row_samples;
    pixels[row / rows * static_cast<std::size_t>(tile.width()) + column / columns].push_back(layer);
  }
  for (std::vector<ReferenceTile::Layer>& layers : pixels)
    std::stable_sort(layers.begin(), layers.end(), [](const auto& a, const auto& b) {
      return std::pair(a.sample, a.depth) < std::pair(b.sample, b.depth);
    });
  return pixels;
}

std::vector<glm::vec4> resolve(const ReferenceTile& surface, const Tile& tile, const TileShader& shader,
                               const glm::vec3& background, StageCounters& counters) {
  const ReferencePattern& pattern = surface.pattern;
  const double share = 1.0 / pattern.samples();
  const PixelSum sum_of(shader, background, surface);
  const std::vector<std::vector<ReferenceTile::Layer>> layers = layers_of_pixels(surface, tile);
  std::vector<glm::vec4> image;
  image.reserve(tile.pixels());
  for (std::int32_t y = 0; y < tile.height(); ++y) {
    for (std::int32_t x = 0; x < tile.width(); ++x) {
      const std::uint64_t* const owner = surface.owner.data() +
                                         static_cast<std::size_t>(y * pattern.rows()) * surface.row_samples +
                                         static_cast<std::size_t>(x * pattern.columns);
      glm::dvec3 sum(0.0);
      double covered = 0;
      const std::vector<ReferenceTile::Layer>& layered = layers[static_cast<std::size_t>(tile.width() * y + x)];
      if (!layered.empty()) {
        covered = sum_of.add_layered(layered, owner, static_cast<std::size_t>(owner - surface.owner.data()),
                                     static_cast<std::uint32_t>(tile.width() * y + x), sum);
      } else if (sum_of.is_flat(owner)) {
        sum_of.add_flat(owner, sum);
      } else {
        sum_of.add_varying(owner, static_cast<std::uint32_t>(tile.width() * y + x), sum);
      }
      for (std::int32_t row = 0; row < pattern.rows(); ++row)
        for (std::int32_t s = 0; s < pattern.columns; ++s)
          covered +=
              owner[static_cast<std::size_t>(row) * surface.row_samples + static_cast<std::size_t>(s)] != kNoOwner;
      image.emplace_back(glm::vec3(sum * share), static_cast<float>(covered * share));
    }
  }
  charge_reference_resolve(tile.pixels(), static_cast<std::uint64_t>(pattern.samples()), counters);
  return image;
}

}  // namespace beampipe
