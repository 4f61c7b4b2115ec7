#include "pipeline/units/depth_test_unit.h"

#include <algorithm>
#include <bit>

#include "pipeline/units/sample_places.h"
#include "stages/samples/blend.h"

namespace beampipe {

DepthTestUnit::DepthTestUnit(Bin& bin, const Sampling& sampling, std::uint32_t first_color_bytes,
                             std::uint32_t color_bytes, SampleMemory::SameValue same_color)
    : bin_(bin),
      pass_(first_color_bytes == 0 ? Pass::prepass : Pass::main),
      sampling_(sampling),
      surface_(bin.tile, sampling, first_color_bytes),
      memory_(bin.memory(), bin.tile, sampling, color_bytes, std::move(same_color)),
      fragments_(bin.pixel_counter("fragments")),
      bytes_(bin.models_memory() ? &bin.pixel_counter("bytes") : nullptr) {
  if (!bin.observer()) return;
  surface_.observers = bin.observers();
  surface_.first_observed = bin.observer()->first_sample(sampling);
}

void DepthTestUnit::shade_translucent_at(ShadeAt at) {
  translucent_at_ = at;
  if (bin_.context.has_blending()) surface_.over.assign(surface_.triangle.size(), glm::vec4(0.0f));
}

bool DepthTestUnit::hides(const SampleFragment& fragment) const {
  return !bin_.context.shader.is_translucent(fragment.triangle);
}

void DepthTestUnit::test(const std::vector<SampleFragment>& fragments) {
  if (surface_.over.empty()) return test_opaque(fragments);
  for (auto first = fragments.begin(), end = first; first != fragments.end(); first = end) {
    const bool opaque = hides(*first);
    while (end != fragments.end() && hides(*end) == opaque) ++end;
    const std::vector<SampleFragment> run(first, end);
    if (opaque) {
      test_opaque(run);
    } else if (surface_.color_bytes > 0) {
      blend_fragments(run);
    }
  }
}

void DepthTestUnit::start_layer(ShadeAt at, std::uint32_t sample_bytes) {
  shade_translucent_at(at);
  add_color(sample_bytes);
}

void DepthTestUnit::blend_into(TileSurface& layer, std::vector<SampleFragment>& fragments) {
  const BinStage blending = bin_.stage(StageId::blend);
  blend_colors(fragments, blending);
  memory_.test(accesses_, blending.counters);
  std::size_t left = 0;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const SampleAccess& access = accesses_[i];
    if (access.passed == 0) continue;
    layer.access(access.triangle, access.cell, access.passed, access.passed, blending.counters);
    fragments[left++] = fragments[i];
  }
  fragments.resize(left);
}

void DepthTestUnit::blend_fragments(const std::vector<SampleFragment>& fragments) {
  const BinStage blending = bin_.stage(StageId::blend);
  blend_colors(fragments, blending);
  memory_.blend(accesses_, blending.counters);
}

void DepthTestUnit::blend_colors(const std::vector<SampleFragment>& fragments, const BinStage& blending) {
  const SamplePlaces places(bin_, sampling_, translucent_at_);
  blend(samples(), bin_.shader(), {fragments, places.of(fragments)}, blending.timed(), surface_, accesses_);
  count_by_pixel(fragments, bin_.tile, sampling_.grid, fragments_);
}

void DepthTestUnit::test_opaque(const std::vector<SampleFragment>& fragments) {
  const BinStage testing = stage();
  depth_test(samples(), fragments, testing.timed(), surface_, accesses_);
  surface_.color_bytes > 0 ? memory_.test_and_write(accesses_, testing.counters)
                           : memory_.test_depth(accesses_, testing.counters);
  count_by_pixel(fragments, bin_.tile, sampling_.grid, fragments_);
  if (surface_.over.empty()) return;
  for (const SampleAccess& access : accesses_)  // an opaque surface hides what was blended there
    for (std::uint32_t left = access.passed; left != 0; left &= left - 1)
      surface_.over[std::size_t{access.cell} * static_cast<std::size_t>(sampling_.pattern.count) +
                    static_cast<std::size_t>(std::countr_zero(left))] = glm::vec4(0.0f);
}

void DepthTestUnit::test_equal(std::vector<SampleFragment>& fragments) {
  std::vector<SampleFragment> translucent;  // depth is final, so they are blended over what is seen
  if (!surface_.over.empty()) {
    const auto rest = std::stable_partition(fragments.begin(), fragments.end(),
                                            [&](const SampleFragment& fragment) { return hides(fragment); });
    translucent.assign(rest, fragments.end());
    fragments.erase(rest, fragments.end());
  }
  const BinStage testing = stage();
  const auto keep_visible = main_stage_ == StageId::shade ? depth_test_in_shader : depth_test_equal;
  keep_visible(samples(), testing.timed(), surface_, fragments, accesses_);
  memory_.test_equal(accesses_, testing.counters);
  if (translucent.empty()) return;
  blend_fragments(translucent);
  for (std::size_t i = 0; i < translucent.size(); ++i)
    if (accesses_[i].passed != 0) fragments.push_back(translucent[i]);
}

std::vector<glm::vec4> DepthTestUnit::resolve_samples(ShadeAt at, StageCounters& resolving, ResolveSpace space) const {
  const SamplePlaces places(bin_, sampling_, at);
  return resolve(surface_, bin_.tile.pixels(), bin_.shader(), bin_.background(), resolving,
                 {static_cast<std::size_t>(sampling_.grid.cells_per_pixel()),
                  [&](std::uint32_t triangle, std::size_t cell) { return places.of(triangle, cell); }, space});
}

void count_by_pixel(const std::vector<SampleFragment>& fragments, const Tile& tile, const CellGrid& grid,
                    std::vector<float>& counts) {
  if (grid.cells_per_pixel() == 1) {  // a cell is a pixel, and a triangle has one fragment in it at most
    for (const SampleFragment& fragment : fragments) ++counts[tile.index(fragment.x, fragment.y)];
    return;
  }
  const auto pixel_of = [grid, tile](const SampleFragment& fragment) {
    return tile.index(grid.pixel_x(fragment.x), grid.pixel_y(fragment.y));
  };
  const bool quads_share_pixels = grid.columns > 1 && grid.rows > 1;
  std::vector<std::uint32_t> last(counts.size(), ~0u);  // the triangle that was counted last
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    if (quads_share_pixels && !starts_quad(fragments, i)) continue;
    const std::size_t pixel = pixel_of(fragments[i]);
    counts[pixel] += last[pixel] != fragments[i].triangle;
    last[pixel] = fragments[i].triangle;
  }
}

std::vector<std::uint32_t> triangles_of(const SampleTile& surface, const Tile& tile) {
  const auto samples = static_cast<std::ptrdiff_t>(tile.pixels() * surface.samples_per_pixel);
  return {surface.triangle.begin(), surface.triangle.begin() + samples};
}

}  // namespace beampipe
