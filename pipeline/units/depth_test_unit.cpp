#include "pipeline/units/depth_test_unit.h"

#include "pipeline/units/sample_places.h"
#include "stages/picture/resolve.h"

namespace beampipe {

DepthTestUnit::DepthTestUnit(Bin& bin, const Sampling& sampling, std::uint32_t first_color_bytes,
                             std::uint32_t color_bytes, SampleMemory::SameValue same_color)
    : bin_(bin),
      stage_(bin.stage("depth_test")),
      sampling_(sampling),
      surface_(bin.tile, sampling, first_color_bytes),
      memory_(bin.memory(), bin.tile, sampling, color_bytes, std::move(same_color)),
      fragments_(bin.pixel_counter("fragments")) {}

void DepthTestUnit::test(const std::vector<SampleFragment>& fragments) {
  depth_test(bin_.triangles(), fragments, bin_.tile, sampling_, stage_.timed(), surface_, accesses_);
  surface_.color_bytes > 0 ? memory_.test_and_write(accesses_, stage_.counters)
                           : memory_.test_depth(accesses_, stage_.counters);
  count_by_pixel(fragments, bin_.tile, sampling_.grid, fragments_);
}

void DepthTestUnit::test_equal(std::vector<SampleFragment>& fragments) {
  depth_test_equal(bin_.triangles(), bin_.tile, sampling_, stage_.timed(), surface_, fragments, accesses_);
  memory_.test_equal(accesses_, stage_.counters);
}

std::vector<glm::vec4> DepthTestUnit::resolve_samples(ShadeAt at, const BinStage& resolving) const {
  const SamplePlaces places(bin_, sampling_, at);
  return resolve(surface_, bin_.tile.pixels(), bin_.shader(), bin_.background(), resolving.timed(),
                 static_cast<std::size_t>(sampling_.grid.cells_per_pixel()),
                 [&](std::uint32_t triangle, std::size_t cell) { return places.of(triangle, cell); });
}

void DepthTestUnit::count_bytes() {
  if (bin_.models_memory()) memory_.add_bytes(bin_.pixel_counter("bytes"));
}

void count_by_pixel(const std::vector<SampleFragment>& fragments, const Tile& tile, const CellGrid& grid,
                    std::vector<float>& counts) {
  std::vector<std::uint32_t> last(counts.size(), ~0u);  // the triangle that was counted last
  for (const SampleFragment& fragment : fragments) {
    const std::int32_t x = grid.pixel_x(fragment.x) - tile.x0, y = grid.pixel_y(fragment.y) - tile.y0;
    const auto pixel = static_cast<std::size_t>(y * tile.width() + x);
    counts[pixel] += last[pixel] != fragment.triangle;
    last[pixel] = fragment.triangle;
  }
}

std::vector<std::uint32_t> shown_pixels(const SampleTile& surface, const Tile& tile) {
  std::vector<std::uint32_t> pixels;
  for (std::uint32_t pixel = 0; pixel < tile.pixels(); ++pixel)
    if (surface.triangle[pixel] != kNoTriangle) pixels.push_back(pixel);
  return pixels;
}

}  // namespace beampipe
