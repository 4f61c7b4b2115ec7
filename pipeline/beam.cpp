#include "pipeline/beam.h"

#include <algorithm>
#include <string>

#include "pipeline/memory/beam_memory.h"
#include "pipeline/tiles.h"
#include "stages/a_buffer.h"
#include "stages/aggregate_format.h"
#include "stages/compose.h"
#include "stages/compose_window.h"
#include "stages/conservative_raster.h"
#include "stages/resolve.h"
#include "stages/shade.h"
#include "stages/vertex_setup.h"

namespace beampipe {
namespace {

using PixelCounters = std::vector<std::pair<std::string, std::vector<float>>>;

PixelCounters count_per_pixel(const Tile& tile, const ABuffer& buffer, const std::vector<Fragment>& fragments) {
  std::vector<float> count(tile.pixels()), tiny(tile.pixels());
  for (std::size_t pixel = 0; pixel < tile.pixels(); ++pixel) count[pixel] = static_cast<float>(buffer.depth_of(pixel));
  for (const Fragment& fragment : fragments)
    if (fragment.tiny) ++tiny[fragment.pixel];
  return {{"fragments", std::move(count)}, {"tiny_triangles", std::move(tiny)}};
}

struct RecordBytes {
  std::uint32_t fragment, aggregate;
};

RecordBytes record_bytes(const BeamOptions& beam) {
  switch (beam.rules) {
    case Rules::conserve:
      return {conserving_fragment_bytes(beam.positions), conserving_aggregate_bytes(beam.positions, beam.storage)};
    case Rules::over:
      return {kOverFragmentBytes, kOverBytes};
    case Rules::paper:
      break;
  }
  return {paper_aggregate_bytes(beam.paper_storage), paper_aggregate_bytes(beam.paper_storage)};
}

}  // namespace

FrameResult render_beam(const Trace& trace, const Frame& frame, const BeamOptions& beam, const RunOptions& run) {
  const bool conserve = beam.rules == Rules::conserve;
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, setup);
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const PositionSet positions(conserve ? cell_patterns(beam.positions) : std::vector{hammersley_pattern()});
  const MaskTable table(positions.patterns.front());
  const RecordBytes bytes = record_bytes(beam);
  const std::vector<Surface> framebuffer = beam_framebuffer(beam);
  const BeamFragmentOptions options{beam.mask,
                                    beam.mask == MaskSource::none ? std::vector<SamplePattern>{} : positions.patterns,
                                    &table, bytes.fragment, beam.tiny_positions};

  FrameResult result =
      render_tiles(frame, triangles, setup, kBinSize, run, [&](const Tile& tile, const TriangleList& list) {
        StageCounters raster{"conservative_raster"}, fragment{"beam_fragment"}, shading{"shade"}, buffering{"a_buffer"},
            composition{"compose"}, resolving{"resolve"};
        std::vector<PixelTriangle> pairs;
        std::vector<Fragment> fragments;
        conservative_raster(triangles, list, tile, raster, pairs);
        beam_fragment(triangles, pairs, tile, options, fragment, fragments);
        shade(colors, fragments, shading, &triangles.attributes);
        const ABuffer buffer = a_buffer(fragments, tile.pixels(), beam.sort, bytes.fragment, buffering);
        PixelCounters counts = count_per_pixel(tile, buffer, fragments);
        std::vector<PixelColor> aggregates;
        switch (beam.rules) {
          case Rules::conserve: {
            PixelWindows windows;
            aggregates = compose_window(fragments, buffer, positions, beam.storage, composition, windows);
            counts.emplace_back("largest_window", std::move(windows.largest));
            counts.emplace_back("merges", std::move(windows.merges));
            break;
          }
          case Rules::paper:
            aggregates = pixel_colors(
                compose(fragments, buffer, positions.patterns.front(), beam.merge, beam.paper_storage, composition));
            counts.emplace_back("merges", counts.front().second);
            break;
          case Rules::over:
            aggregates = pixel_colors(compose_over(fragments, buffer, composition));
            counts.emplace_back("merges", counts.front().second);
            break;
        }
        std::vector<bool> full;
        for (const PixelColor& aggregate : aggregates) full.push_back(aggregate.alpha == 1.0f);
        count_sorted_composition(run.memory, tile, buffer, fragments, bytes.fragment, counts.back().second, full,
                                 framebuffer, buffering, composition, resolving);
        return TileResult{resolve(aggregates, frame.background, bytes.aggregate, resolving),
                          std::move(counts),
                          {raster, fragment, shading, buffering, composition, resolving}};
      });
  const auto buffering = std::find_if(result.stages.begin(), result.stages.end(),
                                      [](const StageCounters& stage) { return stage.stage == "a_buffer"; });
  result.a_buffer_peak_bytes =
      a_buffer_bytes(buffering->items_in, std::uint64_t{frame.width} * frame.height, bytes.fragment);
  return result;
}

std::vector<Surface> beam_framebuffer(const BeamOptions& beam) {
  const Surface color{"color", "RGB16F", kAggregateColorBytes}, float_color{"color", "RGB32F", 12};
  const Surface coverage{"coverage", "R32F", 4};
  const auto mask_bytes = static_cast<std::uint32_t>(beam.positions) / 8;
  const Surface mask{"mask", "R32UI x " + std::to_string(mask_bytes / 4), mask_bytes};
  const Surface plane{"depth_plane", "RGB32F", 12}, thickness{"thickness", "R32F", 4}, range{"depth_range", "RG32F", 8};
  switch (beam.rules) {
    case Rules::conserve:
      return {coverage, mask, beam.storage == Storage::packed ? color : float_color};
    case Rules::over:
      return {coverage, color};
    case Rules::paper:
      break;
  }
  switch (beam.paper_storage) {
    case PaperStorage::slides:
      return {coverage, mask, {"depth_plane", "RGBA32F", 16}, thickness, range, color};
    case PaperStorage::text:
      return {coverage, mask, {"depth_plane", "R32F + RG16", 8}, {"thickness", "R16", 2}, range, color};
    case PaperStorage::float32:
      break;
  }
  return {coverage, mask, plane, thickness, range, float_color};
}

}  // namespace beampipe
