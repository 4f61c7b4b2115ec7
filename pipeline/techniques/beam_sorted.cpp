// The beam in sorted order. An A-buffer sorts the pairs of each pixel by depth. Window by window, near to far, pairs
// become shaded fragments and are composed, until the pixel is closed. Or, as the published pipeline does it, an
// A-buffer sorts the fragments of each pixel, and they are composed one by one.

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/a_buffer_unit.h"
#include "pipeline/units/compose_units.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"
#include "stages/data/beam_aggregate.h"
#include "stages/data/mask_words.h"

namespace beampipe {
namespace {

enum class Window { run, one };  // triangles that are composed at once

struct SortedOptions {
  int positions = 256;  // of the mask
  Window window = Window::run;
};

Framebuffer sorted_framebuffer(const SortedOptions& sorted) {
  const auto mask_bytes = static_cast<std::uint32_t>(sorted.positions) / 8;
  return {.surfaces = {
              {"coverage", "R32F", 4}, {"mask", times("R32UI", mask_bytes / 4), mask_bytes}, {"color", "RGB16F", 6}}};
}

template <std::size_t Words>
FrameResult render_windows(const FrameJob& job, const SortedOptions& sorted) {
  const FrameContext context(job, {.takes_positions = true});
  const PositionSet& positions = cell_positions(sorted.positions);
  const PositionGrid grid(sorted.positions);
  const BeamFragmentOptions fragment_options = grid_options(grid, conserving_fragment_bytes(sorted.positions));
  const BinPlan plan{.stages = {StageId::conservative_raster, StageId::a_buffer, StageId::windows,
                                StageId::beam_fragment, StageId::shade, StageId::compose, StageId::resolve},
                     .framebuffer = sorted_framebuffer(sorted),
                     .pair_bytes = kPairWorkingBytes + kSortBytes,
                     .order = "near to far, in windows whose depths overlap"};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "waiting_pairs", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out);
    ABufferUnit a_buffer(bin, kPairWithDepthBytes, kStoredPairBytes);
    BeamFragmentUnit make_fragments(bin, fragment_options);
    ShadeUnit shade(bin);
    ComposeBeamUnit<Words> compose(bin, positions);
    std::vector<float>& specks = bin.pixel_counter("tiny_triangles");

    const std::vector<Pair>& pairs = raster();
    WindowsUnit windows(bin, pairs, a_buffer(sort_records(pairs, bin.tile)));
    while (windows.next([&](std::uint32_t pixel) { return compose.is_open(pixel); })) {
      std::vector<Fragment>& fragments = make_fragments.fetched(windows.pairs, "window_fragments");
      shade.visible(fragments);
      shade.visible(windows.whole);
      compose(fragments, windows.whole);
      count_specks(fragments, specks);
    }
    a_buffer.charge_memory(windows.finish(), windows.stage);
    bin.finish(compose.resolve_aggregates(plan.framebuffer.surfaces));
  });
}

template <std::size_t Words>
FrameResult render_one_by_one(const FrameJob& job, const SortedOptions& sorted) {
  const FrameContext context(job, {.takes_positions = true});
  const PositionGrid grid(sorted.positions);
  const std::uint32_t fragment_bytes = conserving_fragment_bytes(sorted.positions);
  BeamFragmentOptions fragment_options = grid_options(grid, fragment_bytes);
  fragment_options.clipped_depth = true;
  const BinPlan plan{.stages = {StageId::conservative_raster, StageId::beam_fragment, StageId::a_buffer, StageId::shade,
                                StageId::compose, StageId::resolve},
                     .framebuffer = sorted_framebuffer(sorted),
                     .pair_bytes = kPairWorkingBytes + kSortBytes,
                     .order = "near to far, by the depth at the centroid"};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "pair_queue", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out,
                                  kQueueItems);
    BeamFragmentUnit make_fragments(bin, fragment_options);
    ABufferUnit a_buffer(bin, fragment_bytes, fragment_bytes);
    ShadeUnit shade(bin);
    ComposeBeamUnit<Words> compose(bin, cell_positions(sorted.positions));
    std::vector<float>& merges = bin.pixel_counter("merges");

    const std::vector<Fragment>& fragments = make_fragments.queued(raster());
    count_specks(fragments, bin.pixel_counter("tiny_triangles"));
    const ABuffer& lists = a_buffer(sort_records(fragments, SortKey::centroid));
    std::vector<Fragment> next;  // of each open pixel that has one
    for (std::uint32_t round = 0;; ++round) {
      next.clear();
      for (std::uint32_t pixel = 0; pixel < merges.size(); ++pixel) {
        if (round >= lists.record_count(pixel) || !compose.is_open(pixel)) continue;
        next.push_back(fragments[lists.records[lists.first[pixel] + round]]);
        merges[pixel] += 1;
      }
      if (next.empty()) break;
      shade.visible(next);
      compose(next, {});
    }
    a_buffer.charge_memory(merges, bin.stage(StageId::compose));
    bin.finish(compose.resolve_aggregates(plan.framebuffer.surfaces));
  });
}

FrameResult render_sorted(const FrameJob& job, const SortedOptions& sorted) {
  return with_words<1, 8>(sorted.positions, [&]<std::size_t Words>() {
    return sorted.window == Window::run ? render_windows<Words>(job, sorted) : render_one_by_one<Words>(job, sorted);
  });
}

std::vector<ErrorSource> error_sources(const SortedOptions& sorted) {
  std::vector<ErrorSource> sources = {ErrorSource::estimated_areas};
  if (sorted.window == Window::one) sources.push_back(ErrorSource::merges_one_by_one);
  return sources;
}

}  // namespace

TechniqueKind beam_sorted_kind() {
  return {.name = "beam",
          .variant = {"order", "sorted"},
          .description =
              "an A-buffer sorts the triangles of a pixel by depth; their fragments are composed near to far into one "
              "aggregate that conserves area, until the pixel is closed",
          .source = "ours, after Crassin et al. 2018",
          .examples = {"beam:order=sorted", "beam:order=sorted,window=one"},
          .texture_taps = 16,
          .stressed = {"beam:order=sorted", "beam:order=sorted,bits=32", "beam:order=sorted,window=one"},
          .counters = {"merges", "tiny_triangles", "largest_window"},
          .make = make_from(
              SortedOptions{},
              [](SortedOptions& o) -> SpecOptions {
                return {choice("bits", o.positions, {{"32", 32}, {"256", 256}}, "positions of the mask"),
                        choice("window", o.window, {{"run", Window::run}, {"one", Window::one}},
                               "what is composed at once: a run of triangles whose depths overlap, or one triangle, by "
                               "the depths of their centroids, which loses area where they cross or meet")};
              },
              [](const SortedOptions& o) {
                return Technique{.framebuffer = sorted_framebuffer(o),
                                 .positions = o.positions,
                                 .errs_by = error_sources(o),
                                 .renderer = bind_options(render_sorted, o),
                                 .is_observable = true,
                                 .has_weights = true};
              })};
}

}  // namespace beampipe
