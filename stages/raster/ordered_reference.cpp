#include "stages/raster/ordered_reference.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <span>

#include "stages/raster/reference_raster_cost.h"
#include "stages/raster/reference_spans.h"
#include "stages/rop/stored_color.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kWholeCell = (1u << kRowsPerCell) - 1;

class OrderedSamples {
 public:
  OrderedSamples(const SetupTriangles& triangles, const RopRules& rules, const TileShader& shader, const Tile& tile,
                 ReferenceTile& surface)
      : triangles_(triangles),
        rules_(rules),
        shader_(shader),
        tile_(tile),
        surface_(surface),
        places_(tile, surface.pattern),
        passed_(surface.owner.size() / kRowsPerCell, 0) {
    std::fill(surface.depth.begin(), surface.depth.end(), double{rules.clear_depth});
    surface.color.resize(surface.owner.size());
    surface.stencil.assign(surface.owner.size(), 0);
    surface.is_uniform.assign(passed_.size(), true);
  }

  void draw(std::uint32_t index) {
    rules_.clear_before(triangles_.draws[index], next_clear_, [this](const RopClear& clear) { clear_all(clear); });
    const RopRule& rule = rules_.of(triangles_, index);
    test(index, rule);
    if (!rule.writes_color()) {
      for (const std::uint32_t cell : cells_) passed_[cell] = 0;
    } else if (rule.blend || rule.color_mask != kAllChannels) {
      blend(index, rule);
    } else {
      cover(index);
    }
    cells_.clear();
  }

  std::uint64_t covered = 0, nearer = 0;  // samples that were tested, and that passed

 private:
  void clear_all(const RopClear& clear) {
    if (clear.depth) std::fill(surface_.depth.begin(), surface_.depth.end(), double{rules_.clear_depth});
    if (clear.stencil)
      std::fill(surface_.stencil.begin(), surface_.stencil.end(), static_cast<std::uint8_t>(*clear.stencil));
  }

  // Sets passed_ of cells_.
  void test(std::uint32_t index, const RopRule& rule) {
    const SetupTriangle& triangle = triangles_.triangles[index];
    const Stencil& stencil = rule.stencil_of(triangle);
    const bool has_verdicts = shader_.has_verdict(index), is_cutout = !has_verdicts && shader_.is_cutout(index);
    const bool is_early = shader_.tests_early(index);
    if (has_verdicts) find_verdicts(index);
    if (is_cutout) {
      if (!cutouts_) cutouts_.emplace(shader_, tile_, surface_.pattern.columns);
      cutouts_->start(index);
    }
    places_.for_each_run(triangle, [&](const SampleRun& run, const DepthSpan& span) {
      covered += run.count;
      const std::size_t row = run.at / surface_.row_samples, first_cell = cell_of(run.at, surface_.row_samples);
      const std::uint32_t bit = 1u << row % kRowsPerCell;
      const auto test_sample = [&](std::size_t i, const auto& is_there) {
        if (!is_early && !is_there()) return;
        double depth = 0;
        depth_span_sample(span, static_cast<double>(i), 0.0, depth);
        if (has_verdicts && verdicts_[first_cell + i].depth) depth = double{*verdicts_[first_cell + i].depth};
        depth = std::clamp(depth, rule.nearest, rule.farthest);
        if (!passes_tests(rule, stencil, depth, run.at + i) || (is_early && !is_there())) return;
        std::uint32_t& passed = passed_[first_cell + i];
        if (passed == 0) cells_.push_back(static_cast<std::uint32_t>(first_cell + i));
        passed |= bit;
        ++nearer;
      };
      if (is_cutout) {
        for_each_sample(run, index, shader_, *cutouts_, test_sample);
      } else {
        for (std::size_t i = 0; i < run.count; ++i)
          test_sample(i, [&] { return !has_verdicts || is_taken_[first_cell + i]; });
      }
    });
  }

  // Sets verdicts_ and is_taken_ of the cells that the triangle covers in part.
  void find_verdicts(std::uint32_t index) {
    std::vector<std::uint32_t> cells;
    verdicts_.resize(passed_.size());
    is_taken_.resize(passed_.size());
    places_.for_each_run(triangles_.triangles[index], [&](const SampleRun& run, const DepthSpan&) {
      const std::size_t first = cell_of(run.at, surface_.row_samples);
      for (std::size_t i = 0; i < run.count; ++i) cells.push_back(static_cast<std::uint32_t>(first + i));
    });
    std::ranges::sort(cells);
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    invocations_.clear();
    for (const std::uint32_t cell : cells) invocations_.push_back(invocation(index, cell));
    const std::vector<FragmentVerdict> found = shader_.verdicts(index, invocations_);
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const ShadingPlace& place = invocations_[k].place;
      const auto columns = static_cast<std::uint32_t>(surface_.pattern.columns);
      const std::uint32_t in_pixel =
          cells[k] / static_cast<std::uint32_t>(surface_.row_samples) % columns * columns + cells[k] % columns;
      verdicts_[cells[k]] = found[k];
      is_taken_[cells[k]] = TakenPositions(found[k], place.x, place.y, columns * columns).takes(in_pixel);
    }
  }

  // Of sample number `at`. Changes its stencil value and its depth.
  bool passes_tests(const RopRule& rule, const Stencil& stencil, double depth, std::size_t at) {
    std::uint8_t& stored = surface_.stencil[at];
    const auto update = [&](StencilOperation operation) {
      if (rule.has_stencil)
        stored = static_cast<std::uint8_t>(stencil_after(operation, stencil, std::uint32_t{stored}));
    };
    if (rule.has_stencil && !stencil_passes(stencil, std::uint32_t{stored})) {
      update(stencil.fail);
      return false;
    }
    if (!passes(rule.depth, depth, surface_.depth[at])) {
      update(stencil.depth_fail);
      return false;
    }
    update(stencil.pass);
    if (rule.writes_depth) surface_.depth[at] = depth;
    return true;
  }

  std::size_t first_sample(std::uint32_t cell) const {
    return cell / surface_.row_samples * kRowsPerCell * surface_.row_samples + cell % surface_.row_samples;
  }

  // The samples of a cell have colours of their own from here on.
  void divide(std::uint32_t cell, std::size_t first) {
    if (!surface_.is_uniform[cell]) return;
    surface_.is_uniform[cell] = false;
    for (std::size_t k = 1; k < kRowsPerCell; ++k)
      surface_.color[first + k * surface_.row_samples] = surface_.color[first];
  }

  void cover(std::uint32_t index) {
    for (const std::uint32_t cell : cells_) {
      const std::size_t first = first_sample(cell);
      if (passed_[cell] == kWholeCell) {
        surface_.is_uniform[cell] = true;
      } else {
        divide(cell, first);
      }
      for (std::uint32_t left = passed_[cell]; left != 0; left &= left - 1)
        surface_.owner[first + static_cast<std::size_t>(std::countr_zero(left)) * surface_.row_samples] = index;
      passed_[cell] = 0;
    }
  }

  Invocation invocation(std::uint32_t triangle, std::uint32_t cell) const {
    const auto columns = static_cast<std::uint32_t>(surface_.pattern.columns);  // of cells, and as many rows
    const auto across = static_cast<std::uint32_t>(surface_.row_samples);
    const std::uint32_t column = cell % across, row = cell / across, width = across / columns;
    const std::uint32_t pixel = row / columns * width + column / columns;
    const float side = 1.0f / static_cast<float>(columns);
    return {triangle,
            shader_.place(pixel, (static_cast<float>(column % columns) + 0.5f) * side,
                          (static_cast<float>(row % columns) + 0.5f) * side),
            side};
  }

  // A triangle whose colour in the cell at hand is wanted, and the number of its invocation.
  struct Wanted {
    std::uint64_t owner;
    std::size_t invocation;
  };

  void blend(std::uint32_t index, const RopRule& rule) {
    invocations_.clear();
    wanted_.clear();
    ends_.clear();
    for (const std::uint32_t cell : cells_) {
      const std::size_t first = first_sample(cell), begin = wanted_.size();
      want(index, cell, begin);
      for (std::uint32_t left = is_one(cell) ? 1u : passed_[cell]; left != 0; left &= left - 1) {
        const std::uint64_t owner =
            surface_.owner[first + static_cast<std::size_t>(std::countr_zero(left)) * surface_.row_samples];
        if (owner < kColoredOwner) want(owner, cell, begin);
      }
      ends_.push_back(wanted_.size());
    }
    const std::vector<glm::vec4> colors = shader_.colors_and_alphas(invocations_);
    for (std::size_t c = 0, begin = 0; c < cells_.size(); begin = ends_[c++])
      blend_cell(rule, cells_[c], std::span(wanted_).subspan(begin, ends_[c] - begin), colors);
  }

  // Do all samples of a cell that is covered have the same state? Owners are equal where colours are.
  bool is_one(std::uint32_t cell) const { return surface_.is_uniform[cell] && passed_[cell] == kWholeCell; }

  void want(std::uint64_t owner, std::uint32_t cell, std::size_t begin) {
    for (std::size_t k = begin; k < wanted_.size(); ++k)
      if (wanted_[k].owner == owner) return;
    wanted_.push_back({owner, invocations_.size()});
    invocations_.push_back(invocation(static_cast<std::uint32_t>(owner), cell));
  }

  // `wanted`: of the cell; the first is the triangle that is blended.
  void blend_cell(const RopRule& rule, std::uint32_t cell, std::span<const Wanted> wanted,
                  const std::vector<glm::vec4>& colors) {
    const std::size_t first = first_sample(cell);
    const glm::vec4& source = colors[wanted[0].invocation];
    const auto stored_at = [&](std::size_t at) -> const glm::vec4& {
      const std::uint64_t owner = surface_.owner[at];
      if (owner == kColoredOwner) return surface_.color[at];
      if (owner == kNoOwner) return rules_.clear_color;
      return colors[std::ranges::find(wanted, owner, &Wanted::owner)->invocation];
    };
    const bool at_once = is_one(cell);
    if (!at_once) divide(cell, first);
    for (std::uint32_t left = at_once ? 1u : passed_[cell]; left != 0; left &= left - 1) {
      const std::size_t at = first + static_cast<std::size_t>(std::countr_zero(left)) * surface_.row_samples;
      surface_.color[at] = stored_color(rules_, rule, source, stored_at(at), [](float channel) { return channel; });
    }
    for (std::uint32_t left = passed_[cell]; left != 0; left &= left - 1)
      surface_.owner[first + static_cast<std::size_t>(std::countr_zero(left)) * surface_.row_samples] = kColoredOwner;
    passed_[cell] = 0;
  }

  const SetupTriangles& triangles_;
  const RopRules& rules_;
  const TileShader& shader_;
  const Tile& tile_;
  ReferenceTile& surface_;
  SpanPlaces places_;
  std::optional<CutoutCells> cutouts_;
  std::size_t next_clear_ = 0;
  std::vector<std::uint32_t> passed_;      // of each cell: the rows whose samples passed
  std::vector<std::uint32_t> cells_;       // of which some passed
  std::vector<FragmentVerdict> verdicts_;  // of cells
  std::vector<bool> is_taken_;             // of cells: by their verdicts
  std::vector<Invocation> invocations_;
  std::vector<Wanted> wanted_;     // cell by cell
  std::vector<std::size_t> ends_;  // of each cell's part of it
};

}  // namespace

void ordered_reference(const ListedTriangles& drawn, const RopRules& rules, const TileShader& shader,
                       StageCounters& counters, ReferenceTile& surface) {
  OrderedSamples samples(drawn.triangles, rules, shader, drawn.tile, surface);
  for (const std::uint32_t index : drawn.list) samples.draw(index);
  charge_reference(samples.covered, samples.nearer, counters);
}

}  // namespace beampipe
