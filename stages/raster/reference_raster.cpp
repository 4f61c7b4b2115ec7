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
#include "stages/raster/reference_spans.h"

namespace beampipe {
namespace {

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
std::uint64_t take_cutout(const DepthSpan& span, std::uint32_t triangle, const SampleRun& run, const TileShader& shader,
                          CutoutCells& cells, ReferenceTile& surface) {
  std::uint64_t found = 0;
  for_each_sample(run, triangle, shader, cells, [&](std::size_t i, const auto& is_there) {
    double depth = 0;
    if (!depth_span_sample(span, static_cast<double>(i), surface.depth[run.at + i], depth) || !is_there()) return;
    ++found;
    surface.depth[run.at + i] = depth;
    surface.owner[run.at + i] = triangle;
  });
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

void reference_raster(const ListedTriangles& drawn, StageCounters& counters, ReferenceTile& surface,
                      const TileShader* shader) {
  const SetupTriangles& triangles = drawn.triangles;
  const SpanPlaces places(drawn.tile, surface.pattern);
  std::optional<CutoutCells> cells;
  std::uint64_t covered = 0, nearer = 0;  // samples
  for (const std::uint32_t index : drawn.list) {
    if (shader && shader->is_cutout(index)) {
      if (!cells) cells.emplace(*shader, drawn.tile, surface.pattern.columns);
      cells->start(index);
    }
    places.for_each_run(triangles.triangles[index], [&](const SampleRun& run, const DepthSpan& depths) {
      covered += run.count;
      if (triangles.is_opaque(index)) {
        nearer += depth_span(depths, run.count, index, surface.depth.data() + run.at, surface.owner.data() + run.at);
        return;
      }
      nearer += cells && shader->is_cutout(index) ? take_cutout(depths, index, run, *shader, *cells, surface)
                                                  : list_layers(depths, index, run, surface);
    });
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
        if (owner[s] != kColoredOwner)
          sum += owner[s] == kNoOwner ? clear_ : glm::dvec3(shader_.color(triangle_of(owner[s]), 0, 0, 0));
  }

  // The samples that have their colours. `first`: of the pixel's first sample.
  void add_colored(const ReferenceTile& surface, std::size_t first, glm::dvec3& sum) const {
    for (std::int32_t row = 0; row < rows_; row += kRowsPerCell) {
      for (std::int32_t column = 0; column < columns_; ++column) {
        const std::size_t at = first + static_cast<std::size_t>(row) * row_samples_ + static_cast<std::size_t>(column);
        if (surface.is_uniform[cell_of(at, row_samples_)]) {
          if (surface.owner[at] == kColoredOwner) sum += double{kRowsPerCell} * glm::dvec3(surface.color[at]);
          continue;
        }
        for (std::size_t k = 0; k < kRowsPerCell; ++k)
          if (surface.owner[at + k * row_samples_] == kColoredOwner)
            sum += glm::dvec3(surface.color[at + k * row_samples_]);
      }
    }
  }

  // All surfaces of the pixel are shaded side by side, which takes less time.
  void add_varying(const std::uint64_t* owner, std::uint32_t pixel, glm::dvec3& sum) const {
    std::vector<Part> parts;
    for (std::int32_t row = 0; row < rows_; row += kRowsPerCell)
      for (std::int32_t column = 0; column < columns_; ++column)
        add_cell(owner + static_cast<std::size_t>(row) * row_samples_ + column, row, column, parts);
    std::vector<Invocation> invocations;
    const auto is_varying = [&](const Part& part) {
      return part.owner < kColoredOwner && !shader_.is_flat(triangle_of(part.owner));
    };
    for (const Part& part : parts)
      if (is_varying(part))
        invocations.push_back(
            {triangle_of(part.owner), shader_.place(pixel, part.u, part.v), 1.0f / static_cast<float>(columns_)});
    const std::vector<glm::vec3> colors = shader_.colors(invocations);
    auto next = colors.begin();
    for (const Part& part : parts)
      if (part.owner != kColoredOwner)
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
        if (owner[s] < kColoredOwner && !shader_.is_flat(triangle_of(owner[s]))) return false;
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
      if (!surface.color.empty())
        sum_of.add_colored(surface, static_cast<std::size_t>(owner - surface.owner.data()), sum);
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
