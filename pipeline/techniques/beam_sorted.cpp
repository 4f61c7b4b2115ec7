// The beam in sorted order. An A-buffer sorts the pairs of each pixel by depth. Window by window, near to far, pairs
// become shaded fragments and are composed, until the pixel is closed.

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/a_buffer_unit.h"
#include "pipeline/units/compose_units.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"
#include "stages/data/beam_aggregate.h"

namespace beampipe {
namespace {

struct SortedOptions {
  int positions = 256;  // of the mask; together with `storage` one of BEAMPIPE_STORED_AGGREGATES
  Storage storage = Storage::packed;
  std::size_t window = kAnyNumber;  // most pairs in a window
};

Framebuffer sorted_framebuffer(const SortedOptions& sorted) {
  const auto mask_bytes = static_cast<std::uint32_t>(sorted.positions) / 8;
  return {
      .surfaces = {{"coverage", "R32F", 4},
                   {"mask", times("R32UI", mask_bytes / 4), mask_bytes},
                   sorted.storage == Storage::packed ? Surface{"color", "RGB16F", 6} : Surface{"color", "RGB32F", 12}}};
}

template <std::size_t Words, class Channel>
FrameResult render_shape(const FrameJob& job, const SortedOptions& sorted) {
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
    ComposeBeamUnit<Words, Channel> compose(bin, positions);
    std::vector<float>& specks = bin.pixel_counter("tiny_triangles");

    const std::vector<Pair>& pairs = raster();
    WindowsUnit windows(bin, pairs, a_buffer(sort_records(pairs, bin.tile)), sorted.window);
    while (windows.next([&](std::uint32_t pixel) { return compose.is_open(pixel); })) {
      std::vector<Fragment>& fragments = make_fragments.fetched(windows.pairs, "window_fragments");
      shade.visible(fragments);
      shade.visible(windows.whole);
      compose(fragments, windows.whole);
      count_specks(fragments, specks);
    }
    shade.finish_fetches();
    a_buffer.charge_memory(windows.finish(), windows.stage);
    bin.finish(compose.resolve_aggregates(plan.framebuffer.surfaces));
  });
}

FrameResult render_sorted(const FrameJob& job, const SortedOptions& sorted) {
  return with_aggregate(sorted.positions, sorted.storage,
                        [&]<std::size_t Words, class Channel>() { return render_shape<Words, Channel>(job, sorted); });
}

}  // namespace

TechniqueKind beam_sorted_kind() {
  return {.name = "beam",
          .variant = {"order", "sorted"},
          .description =
              "an A-buffer sorts the triangles of a pixel by depth; their fragments are composed near to far into one "
              "aggregate that conserves area, until the pixel is closed",
          .source = "ours, after Crassin et al. 2018",
          .examples = {"beam:order=sorted", "beam:order=sorted,storage=float32", "beam:order=sorted,window=one"},
          .texture_taps = 16,
          .stressed = {"beam:order=sorted", "beam:order=sorted,storage=float32", "beam:order=sorted,bits=32"},
          .make = make_from(
              SortedOptions{},
              [](SortedOptions& o) -> SpecOptions {
                return {choice("bits", o.positions, {{"32", 32}, {"256", 256}}, "positions of the mask"),
                        beside(
                            "bits=256", [&o] { return o.positions == 256; },
                            choice("storage", o.storage, {{"packed", Storage::packed}, {"float32", Storage::float32}},
                                   "format of the aggregate's colour: fp16, or float32")),
                        choice("window", o.window, {{"run", kAnyNumber}, {"one", 1}},
                               "what is composed at once: a run of triangles whose depths overlap, or one triangle")};
              },
              [](const SortedOptions& o) {
                return Technique{.framebuffer = sorted_framebuffer(o),
                                 .positions = o.positions,
                                 .errs_by = {ErrorSource::estimated_areas},
                                 .renderer = bind_options(render_sorted, o),
                                 .is_observable = true,
                                 .has_weights = true};
              })};
}

}  // namespace beampipe
