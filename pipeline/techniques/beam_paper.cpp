#include "pipeline/techniques/beam_paper.h"

#include <algorithm>
#include <string>

#include "pipeline/memory/beam_memory.h"
#include "pipeline/memory/geometry_memory.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/beam/a_buffer.h"
#include "stages/beam/compose_paper.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/resolve.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"

namespace beampipe {
namespace {

using PixelCounters = std::vector<std::pair<std::string, std::vector<float>>>;

PixelCounters count_per_pixel(const Tile& tile, const ABuffer& buffer, const std::vector<Fragment>& fragments) {
  std::vector<float> count(tile.pixels()), tiny(tile.pixels());
  for (std::size_t pixel = 0; pixel < tile.pixels(); ++pixel) count[pixel] = static_cast<float>(buffer.depth_of(pixel));
  for (const Fragment& fragment : fragments)
    if (fragment.tiny) ++tiny[fragment.pixel];
  return {{"fragments", count}, {"tiny_triangles", std::move(tiny)}, {"merges", std::move(count)}};
}

struct RecordBytes {
  std::uint32_t fragment, aggregate;
};

RecordBytes record_bytes(const PublishedOptions& beam) {
  switch (beam.rules) {
    case Rules::over:
      return {kOverFragmentBytes, kOverBytes};
    case Rules::paper:
      break;
  }
  return {paper_aggregate_bytes(beam.storage), paper_aggregate_bytes(beam.storage)};
}

// What the stages of a frame have in common.
struct PublishedFrame {
  const PublishedOptions& beam;
  StageCounters setup;
  SetupTriangles triangles;
  std::vector<glm::vec3> colors;
  SamplePattern pattern;
  MaskTable table;
  RecordBytes bytes;
  BeamFragmentOptions options;

  PublishedFrame(const Trace& trace, const Frame& frame, const PublishedOptions& beam_options, const RunOptions& run)
      : beam(beam_options),
        triangles(vertex_setup(trace, frame, StageTimer(run.timeline)(setup))),
        colors(shade_triangles(triangles, frame.light_direction)),
        pattern(hammersley_pattern()),
        table(pattern),
        bytes(record_bytes(beam)),
        options{beam.mask,      beam.mask == MaskSource::none ? std::vector<SamplePattern>{} : std::vector{pattern},
                &table,         nullptr,
                bytes.fragment, beam.tiny_positions} {}
};

std::vector<PixelColor> compose_tile(const PublishedFrame& state, const std::vector<Fragment>& fragments,
                                     const ABuffer& buffer, StageCounters& counters) {
  return pixel_colors(state.beam.rules == Rules::paper
                          ? compose(fragments, buffer, state.pattern, state.beam.merge, state.beam.storage, counters)
                          : compose_over(fragments, buffer, counters));
}

}  // namespace

FrameResult render_published(const Trace& trace, const Frame& frame, const PublishedOptions& beam,
                             const RunOptions& run) {
  const PublishedFrame state(trace, frame, beam, run);
  const std::vector<Surface> framebuffer = published_framebuffer(beam);
  FrameResult result = render_tiles(
      frame, state.triangles, state.setup, kBinSize, run, kPairBytes + kSortBytes,
      [&](const Tile& tile, const TriangleList& list) {
        const StageTimer timed(run.timeline, tile);
        StageCounters raster{"conservative_raster"}, fragment{"beam_fragment"}, shading{"shade"}, buffering{"a_buffer"},
            composition{"compose"}, resolving{"resolve"};
        std::vector<PixelTriangle> pairs;
        std::vector<Fragment> fragments;
        conservative_raster(state.triangles, list, tile, timed(raster), pairs, nullptr, PairDepths::none);
        beam_fragment(state.triangles, pairs, tile, state.options, timed(fragment), fragments);
        BinBuffers held;
        held.holds("bin_pairs", pairs.size() * kPixelTriangleBytes);
        held.holds("bin_fragments", fragments.size() * state.bytes.fragment);
        shade(state.colors, fragments, timed(shading), &state.triangles.attributes);
        AttributesInOrder(run.memory).read(fragments, shading);
        const std::vector<SortRecord> records = sort_records(fragments, beam.sort);
        const ABuffer buffer =
            a_buffer(records, tile.pixels(), state.bytes.fragment, state.bytes.fragment, timed(buffering));
        PixelCounters counts = count_per_pixel(tile, buffer, fragments);
        const std::vector<PixelColor> aggregates = compose_tile(state, fragments, buffer, timed(composition));
        std::vector<bool> full;
        for (const PixelColor& aggregate : aggregates) full.push_back(aggregate.alpha == 1.0f);
        std::vector<float> bytes = count_sorted_composition(
            run.memory, tile, buffer, records, state.bytes.fragment, counts.back().second,
            std::vector<bool>(tile.pixels(), true), full, framebuffer, buffering, composition, composition, resolving);
        counts.emplace_back("bytes", std::move(bytes));
        return TileResult{resolve(aggregates, frame.background, state.bytes.aggregate, timed(resolving)),
                          std::move(counts),
                          {raster, fragment, shading, buffering, composition, resolving},
                          held};
      });
  const auto buffering = std::find_if(result.stages.begin(), result.stages.end(),
                                      [](const StageCounters& stage) { return stage.stage == "a_buffer"; });
  result.a_buffer_peak_bytes =
      a_buffer_bytes(buffering->items_in, std::uint64_t{frame.width} * frame.height, state.bytes.fragment);
  return result;
}

std::vector<PixelWeights> published_weights(const Trace& trace, const Frame& frame, const PublishedOptions& beam,
                                            const RunOptions& run) {
  PublishedOptions exact = beam;  // weights as they are before colours are packed
  exact.storage = PaperStorage::float32;
  const PublishedFrame state(trace, frame, exact, run);
  std::vector<PixelWeights> weights(std::size_t{frame.width} * frame.height);
  render_tiles(frame, state.triangles, state.setup, kBinSize, run, kPairBytes + kSortBytes,
               [&](const Tile& tile, const TriangleList& list) {
                 StageCounters unused{"weights"};
                 std::vector<PixelTriangle> pairs;
                 std::vector<Fragment> fragments;
                 conservative_raster(state.triangles, list, tile, unused, pairs, nullptr, PairDepths::none);
                 beam_fragment(state.triangles, pairs, tile, state.options, unused, fragments);
                 const ABuffer buffer =
                     a_buffer(sort_records(fragments, beam.sort), tile.pixels(), 0, state.bytes.fragment, unused);
                 // Composition is linear in colour. A fragment that alone has a channel, as 1, leaves its weight there:
                 // three fragments of each pixel at a time.
                 std::vector<PixelWeights> found(tile.pixels());
                 std::uint32_t deepest = 0;
                 for (std::size_t pixel = 0; pixel < tile.pixels(); ++pixel)
                   deepest = std::max(deepest, buffer.depth_of(pixel));
                 for (std::uint32_t first = 0; first < deepest; first += 3) {
                   for (std::size_t pixel = 0; pixel < tile.pixels(); ++pixel) {
                     for (std::uint32_t k = 0; k < buffer.depth_of(pixel); ++k) {
                       Fragment& fragment = fragments[buffer.records[buffer.first[pixel] + k]];
                       fragment.color = glm::vec3(0.0f);
                       if (k >= first && k < first + 3) fragment.color[static_cast<int>(k - first)] = fragment.alpha;
                     }
                   }
                   const std::vector<PixelColor> composed = compose_tile(state, fragments, buffer, unused);
                   for (std::size_t pixel = 0; pixel < tile.pixels(); ++pixel) {
                     for (std::uint32_t k = first; k < std::min(first + 3, buffer.depth_of(pixel)); ++k) {
                       const Fragment& fragment = fragments[buffer.records[buffer.first[pixel] + k]];
                       const float weight = composed[pixel].color[static_cast<int>(k - first)];
                       found[pixel].push_back({fragment.triangle, weight, k, fragment.tiny});
                     }
                   }
                 }
                 copy_to_frame(found, tile, frame, weights);
                 return TileResult{{}, {}, {unused}};
               });
  return weights;
}

std::vector<Surface> published_framebuffer(const PublishedOptions& beam) {
  const Surface color{"color", "RGB16F", kAggregateColorBytes}, coverage{"coverage", "R32F", 4};
  if (beam.rules == Rules::over) return {coverage, color};
  const Surface mask{"mask", "R32UI", 4}, thickness{"thickness", "R32F", 4}, range{"depth_range", "RG32F", 8};
  switch (beam.storage) {
    case PaperStorage::slides:
      return {coverage, mask, {"depth_plane", "RGBA32F", 16}, thickness, range, color};
    case PaperStorage::text:
      return {coverage, mask, {"depth_plane", "R32F + RG16", 8}, {"thickness", "R16", 2}, range, color};
    case PaperStorage::float32:
      break;
  }
  return {coverage, mask, {"depth_plane", "RGB32F", 12}, thickness, range, {"color", "RGB32F", 12}};
}

}  // namespace beampipe
