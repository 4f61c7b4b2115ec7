#include "pipeline/techniques/beam_paper.h"

#include <algorithm>
#include <string>

#include "pipeline/bins/bin_weights.h"
#include "pipeline/bins/render_bins.h"
#include "pipeline/units/a_buffer_unit.h"
#include "pipeline/units/compose_units.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"
#include "stages/beam/compose_paper.h"

namespace beampipe {
namespace {

struct RecordBytes {
  std::uint32_t fragment, aggregate;
};

RecordBytes record_bytes(const PublishedOptions& options) {
  if (options.rules == Rules::over) return {kOverFragmentBytes, kOverBytes};
  return {paper_aggregate_bytes(options.storage), paper_aggregate_bytes(options.storage)};
}

BeamFragmentOptions fragment_options(const PublishedOptions& options, const SamplePattern& pattern,
                                     const MaskTable& table) {
  BeamFragmentOptions made;
  made.mask = options.mask;
  if (options.mask != MaskSource::none) made.positions = {pattern};
  made.table = &table;
  made.fragment_bytes = record_bytes(options).fragment;
  made.tiny_positions = options.tiny_positions;
  return made;
}

// Per pixel: does it have records?
std::vector<bool> pixels_with(const std::vector<float>& records) {
  std::vector<bool> with;
  for (const float count : records) with.push_back(count > 0);
  return with;
}

// Per pixel: does nothing show through it?
std::vector<bool> full_pixels(const std::vector<PixelColor>& aggregates) {
  std::vector<bool> full;
  for (const PixelColor& aggregate : aggregates) full.push_back(aggregate.alpha == 1.0f);
  return full;
}

std::vector<PixelColor> compose_lists(const PublishedOptions& options, PaperStorage storage,
                                      const SamplePattern& pattern, const std::vector<Fragment>& fragments,
                                      const ABuffer& lists, StageCounters& counters) {
  return pixel_colors(options.rules == Rules::paper
                          ? compose(fragments, lists, pattern, options.merge, storage, counters)
                          : compose_over(fragments, lists, counters));
}

// Composition is linear in colour: a fragment that alone has a channel, as 1, leaves its weight there. So three
// fragments of each pixel are weighed at a time. Weights are those of unpacked aggregates.
void add_weights(const PublishedOptions& options, const SamplePattern& pattern, std::vector<Fragment> fragments,
                 const ABuffer& lists, BinWeights& weights) {
  StageCounters unused;
  const std::size_t pixels = lists.first.size() - 1;
  std::uint32_t deepest = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) deepest = std::max(deepest, lists.depth_of(pixel));
  for (std::uint32_t first = 0; first < deepest; first += 3) {
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      for (std::uint32_t k = 0; k < lists.depth_of(pixel); ++k) {
        Fragment& fragment = fragments[lists.records[lists.first[pixel] + k]];
        fragment.color = glm::vec3(0.0f);
        if (k >= first && k < first + 3) fragment.color[static_cast<int>(k - first)] = fragment.alpha;
      }
    }
    const std::vector<PixelColor> composed =
        compose_lists(options, PaperStorage::float32, pattern, fragments, lists, unused);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      for (std::uint32_t k = first; k < std::min(first + 3, lists.depth_of(pixel)); ++k) {
        const Fragment& fragment = fragments[lists.records[lists.first[pixel] + k]];
        const float weight = composed[pixel].color[static_cast<int>(k - first)];
        weights.at(pixel).push_back({fragment.triangle, weight, k, fragment.tiny});
      }
    }
  }
}

}  // namespace

FrameResult render_published(const Trace& trace, const Frame& frame, const PublishedOptions& beam,
                             const RunOptions& run) {
  const FrameContext context(trace, frame, run);
  const SamplePattern pattern = hammersley_pattern();
  const MaskTable table(pattern);
  const RecordBytes bytes = record_bytes(beam);
  const BeamFragmentOptions options = fragment_options(beam, pattern, table);
  const BinPlan plan{.stages = {"conservative_raster", "beam_fragment", "shade", "a_buffer", "compose", "resolve"},
                     .pair_bytes = kPairBytes + kSortBytes};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "bin_pairs", PairDepths::none, ConservativeRasterUnit::Hidden::kept);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    ABufferUnit a_buffer(bin, bytes.fragment, bytes.fragment);
    const BinStage composition = bin.stage("compose");
    BinWeights weights(bin);

    std::vector<Fragment>& fragments = make_fragments(raster(), "bin_fragments");
    shade(fragments);
    const ABuffer& lists = a_buffer(sort_records(fragments, beam.sort));
    const std::vector<PixelColor> aggregates =
        compose_lists(beam, beam.storage, pattern, fragments, lists, composition.timed());
    const std::vector<float>& merges = bin.pixel_counter("merges") = depths_of(lists);
    a_buffer.charge_memory(merges, composition);
    charge_aggregates(bin, published_framebuffer(beam), pixels_with(merges), full_pixels(aggregates));
    count_specks(fragments, bin.pixel_counter("tiny_triangles"));
    bin.finish(resolve(aggregates, bin.background(), bytes.aggregate, bin.stage("resolve").timed()));
    if (weights) add_weights(beam, pattern, fragments, lists, weights);
    weights.finish();
  });
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
