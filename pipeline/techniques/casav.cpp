// CASAV, correlation-aware semi-analytic visibility: the pipeline of Crassin et al. 2018. Conservative raster makes
// pairs; they become fragments with analytic coverage and a localization mask, are shaded, sorted in an A-buffer, and
// merged near to far into one aggregate per pixel. Without the A-buffer, each pixel keeps a few aggregates, into which
// fragments are merged as they come: near to far, roughly, in sorted bins, or in primitive order.
#include <algorithm>
#include <string>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/a_buffer_unit.h"
#include "pipeline/units/casav_layers_unit.h"
#include "pipeline/units/compose_units.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/owner_units.h"
#include "pipeline/units/raster_units.h"
#include "stages/beam/a_buffer.h"
#include "stages/beam/beam_fragment.h"
#include "stages/beam/compose_casav.h"
#include "stages/data/casav_aggregate.h"

namespace beampipe {
namespace {

enum class Rules {
  published,  // simd/merge.h
  over,       // alpha OVER without masks and slabs, to show what those are worth
};

// Readings of the text where it leaves several choices open at once.
enum class Reading { best, literal };

// What fragments are compared with.
enum class Depths {
  slab,       // the aggregate's slab
  positions,  // the nearest depth at each position, which is kept while a pixel's list is merged: not in the text
};

enum class CasavOrder { sorted, near_first, stream };

struct CasavOptions {
  Rules rules = Rules::published;
  MaskSource mask = MaskSource::table;  // MaskSource::none with Rules::over
  Depths depths = Depths::slab;
  SortKey sort = SortKey::centroid;
  int tiny_positions = 0;  // BeamFragmentOptions::tiny_positions
  Reading reading = Reading::best;
  MergeRules merge{};  // without regard to `reading`
  CasavStorage storage = CasavStorage::slides;
  CasavOrder order = CasavOrder::sorted;
  int layers = 3;  // aggregates of a pixel, without an A-buffer
};

std::vector<Surface> aggregate_surfaces(const CasavOptions& casav) {
  const Surface color{"color", "RGB16F", kAggregateColorBytes}, coverage{"coverage", "R32F", 4};
  if (casav.rules == Rules::over) return {coverage, color};
  const Surface mask{"mask", "R32UI", 4}, thickness{"thickness", "R32F", 4}, range{"depth_range", "RG32F", 8};
  if (casav.storage == CasavStorage::text)
    return {coverage, mask, {"depth_plane", "R32F + RG16", 8}, {"thickness", "R16", 2}, range, color};
  return {coverage, mask, {"depth_plane", "RGBA32F", 16}, thickness, range, color};
}

Framebuffer casav_framebuffer(const CasavOptions& casav) {
  std::vector<Surface> surfaces = aggregate_surfaces(casav);
  if (casav.order == CasavOrder::sorted) return {.surfaces = surfaces};
  const auto layers = static_cast<std::uint32_t>(casav.layers);
  for (Surface& surface : surfaces) {
    surface.format = times(surface.format.c_str(), layers);
    surface.bytes_per_pixel *= layers;
  }
  return {.surfaces = surfaces, .place = casav.order == CasavOrder::near_first ? Place::on_chip : Place::in_memory};
}

struct RecordBytes {
  std::uint32_t fragment, aggregate;
};

RecordBytes record_bytes(const CasavOptions& options) {
  if (options.rules == Rules::over) return {kOverFragmentBytes, kOverBytes};
  return {casav_aggregate_bytes(options.storage), casav_aggregate_bytes(options.storage)};
}

BeamFragmentOptions fragment_options(const CasavOptions& options, const MergePositions& positions) {
  BeamFragmentOptions made;
  made.mask = options.mask;
  if (options.mask != MaskSource::none) made.positions = {positions.pattern};
  made.table = &positions.table;
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

std::vector<Aggregate> compose_lists(const CasavOptions& options, const MergePositions& positions,
                                     const std::vector<Fragment>& fragments, const ABuffer& lists,
                                     const PixelObservers* observers, StageCounters& counters) {
  return options.rules == Rules::published
             ? compose(fragments, lists, {positions, options.merge, options.storage}, counters, observers)
             : compose_over(fragments, lists, counters, observers);
}

FrameResult render_sorted(const FrameJob& job, const CasavOptions& casav) {
  const FrameContext context(job, {.takes_positions = true});
  const MergePositions positions(hammersley_pattern());
  const RecordBytes bytes = record_bytes(casav);
  const BeamFragmentOptions options = fragment_options(casav, positions);
  const BinPlan plan{.stages = {StageId::conservative_raster, StageId::beam_fragment, StageId::shade, StageId::a_buffer,
                                StageId::compose, StageId::resolve},
                     .framebuffer = casav_framebuffer(casav),
                     .pair_bytes = kPairWorkingBytes + kSortBytes,
                     .order = casav.sort == SortKey::centroid ? "near to far, by the depth at the centroid"
                                                              : "near to far, by the nearest depth"};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "pair_queue", PairDepths::none, ConservativeRasterUnit::Hidden::kept,
                                  kQueueItems);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    ABufferUnit a_buffer(bin, bytes.fragment, bytes.fragment);
    const BinStage composition = bin.stage(StageId::compose);

    std::vector<Fragment>& fragments = make_fragments.queued(raster());
    shade(fragments);
    const ABuffer& lists = a_buffer(sort_records(fragments, casav.sort));
    const std::vector<PixelColor> aggregates =
        pixel_colors(compose_lists(casav, positions, fragments, lists, bin.observers(), composition.timed()));
    const std::vector<float>& merges = bin.pixel_counter("merges") = record_counts(lists);
    a_buffer.charge_memory(merges, composition);
    charge_aggregates(bin, plan.framebuffer.surfaces, pixels_with(merges), full_pixels(aggregates));
    count_specks(fragments, bin.pixel_counter("tiny_triangles"));
    bin.finish(
        resolve(aggregates, bin.background(), bytes.aggregate, bin.stage(StageId::resolve).timed(), bin.observers()));
  });
}

// Without an A-buffer.
FrameResult render_layers(const FrameJob& job, const CasavOptions& casav) {
  const FrameContext context(job, {.takes_positions = true});
  const MergePositions positions(hammersley_pattern());
  const BeamFragmentOptions options = fragment_options(casav, positions);
  const bool sorts = casav.order == CasavOrder::near_first;
  BinPlan plan{.stages = {StageId::conservative_raster, StageId::beam_fragment, StageId::shade, StageId::compose,
                          StageId::resolve},
               .framebuffer = casav_framebuffer(casav),
               .keeps_tile_size = sorts,
               .sorts_lists = sorts};
  if (sorts) plan.stages.insert(plan.stages.begin(), StageId::bin_sort);
  if (sorts) plan.order = kNearFirstOrder;
  return render_bins(context, plan, [&](Bin& bin) {
    const TriangleList list = sorts ? sort_bin(bin).triangles : bin.list;
    ConservativeRasterUnit raster(bin, "pair_queue", PairDepths::none, ConservativeRasterUnit::Hidden::kept,
                                  kQueueItems);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    ComposeLayersUnit compose(bin, static_cast<std::size_t>(casav.layers), {positions, casav.merge, casav.storage},
                              plan.framebuffer.surfaces);
    std::vector<float>& counts = bin.pixel_counter("fragments");

    for_each_batch(list, [&](const TriangleList& batch) {
      std::vector<Fragment>& fragments = make_fragments.queued(raster(batch, bin.tile));
      count_by_pixel(fragments, counts);
      shade(fragments);
      compose(fragments);
    });
    bin.finish(compose.resolve_layers());
  });
}

// The literal reading sets three of the rules. Depths are compared at each position where masks are exact or depths are
// kept; with kept depths nothing asks how thick the slab is.
CasavOptions with_rules(CasavOptions options) {
  if (options.reading == Reading::literal) {
    options.merge.fuzzy = MergeRules::Fuzzy::delta;
    options.merge.slab = MergeRules::Slab::full;
    options.merge.plane = MergeRules::Plane::area;
  }
  if (options.mask == MaskSource::exact) options.merge.partition = MergeRules::Partition::positions;
  if (options.depths == Depths::positions) {
    options.merge.partition = MergeRules::Partition::given;
    options.merge.thickness = MergeRules::Thickness::none;
  }
  return options;
}

FrameResult render_casav(const FrameJob& job, const CasavOptions& casav) {
  const CasavOptions options = with_rules(casav);
  return casav.order == CasavOrder::sorted ? render_sorted(job, options) : render_layers(job, options);
}

std::vector<ErrorSource> error_sources(const CasavOptions& options) {
  if (options.rules == Rules::over) return {ErrorSource::independent_fragments};
  std::vector<ErrorSource> sources = {ErrorSource::published_merges, ErrorSource::merges_in_fp16};
  if (options.storage == CasavStorage::text) sources.push_back(ErrorSource::merges_of_half_slopes);
  return sources;
}

Technique make_casav(const CasavOptions& options) {
  return {.framebuffer = casav_framebuffer(options),
          .positions = hammersley_pattern().count,
          .errs_by = error_sources(options),
          .renderer = bind_options(render_casav, options),
          .is_observable = true,
          .has_weights = options.order == CasavOrder::sorted};
}

// simd/merge_rules.h explains the policies.
SpecOptions casav_options(CasavOptions& o) {
  using R = MergeRules;
  const auto of_best_reading = [&o](SpecOption option) {
    return beside(
        "reading=best", [&o] { return o.reading == Reading::best; }, std::move(option));
  };
  const auto of_slab = [&o](SpecOption option) {
    return beside(
        "depths=slab", [&o] { return o.depths == Depths::slab; }, std::move(option));
  };
  return {
      choice("reading", o.reading, {{"best", Reading::best}, {"literal", Reading::literal}},
             "the best reading of the text, or the literal one: fuzzy=delta, slab=full, plane=area"),
      choice("mask", o.mask, {{"table", MaskSource::table}, {"exact", MaskSource::exact}},
             "masks from a table of 32 directions and 128 distances, or from edge tests"),
      beside(
          "order=sorted", [&o] { return o.order == CasavOrder::sorted; },
          choice("depths", o.depths, {{"slab", Depths::slab}, {"positions", Depths::positions}},
                 "what a fragment is compared with: the aggregate's slab, or the nearest depth at each position")),
      beside(
          "order=sorted", [&o] { return o.order == CasavOrder::sorted; },
          choice("sort", o.sort, {{"centroid", SortKey::centroid}, {"nearest", SortKey::nearest}},
                 "the fragment's depth that the A-buffer sorts by")),
      choice("tiny", o.tiny_positions, {{"1", 1}, {"3", 3}},
             "most mask positions given to a small fragment, which covers none by itself"),
      choice("overlap", o.merge.overlap,
             {{"tiny", R::Overlap::tiny},
              {"over", R::Overlap::over},
              {"unbounded", R::Overlap::unbounded},
              {"transition", R::Overlap::transition}},
             "how coverages combine where masks overlap: ADD for small fragments and OVER for others, OVER, as "
             "tiny but so that a small fragment takes nothing from what lies behind it, or a transition from ADD to "
             "OVER"),
      choice("regional", o.merge.regional, {{"local", R::Regional::local}, {"area", R::Regional::area}},
             "coverage of an overlapping region: relative to the region's positions, or its area"),
      of_best_reading(choice(
          "fuzzy", o.merge.fuzzy, {{"unite", R::Fuzzy::unite}, {"delta", R::Fuzzy::delta}, {"mix", R::Fuzzy::mix}},
          "coverage within the slab: the union of both, the sum of the blending factors, or between over and "
          "under")),
      of_slab(choice("extents", o.merge.extents, {{"range", R::Extents::range}, {"slab", R::Extents::slab}},
                     "where the slab ends: at its depth range, or at its thickness alone")),
      of_best_reading(choice("slab", o.merge.slab, {{"visible", R::Slab::visible}, {"full", R::Slab::full}},
                             "what the slab grows by: a fragment's visible positions, or all of it")),
      of_best_reading(choice("plane", o.merge.plane, {{"visible", R::Plane::visible}, {"area", R::Plane::area}},
                             "how planes are weighted: by what is visible of each, or by coverage")),
      of_slab(choice(
          "thickness", o.merge.thickness,
          {{"larger", R::Thickness::larger}, {"containing", R::Thickness::containing}, {"none", R::Thickness::none}},
          "thickness after a merge: the larger one, one that contains all merged fragments, or none")),
      choice("storage", o.storage, {{"slides", CasavStorage::slides}, {"text", CasavStorage::text}},
             "formats of the aggregate: as in the talk's slides, or as in the paper's text"),
      choice("order", o.order,
             {{"sorted", CasavOrder::sorted}, {"near-first", CasavOrder::near_first}, {"stream", CasavOrder::stream}},
             "order of fragments: sorted in an A-buffer, near to far from sorted bins, or primitive order"),
      beside(
          "order=near-first or order=stream", [&o] { return o.order != CasavOrder::sorted; },
          choice("layers", o.layers, {{"1", 1}, {"3", 3}, {"8", 8}},
                 "aggregates that a pixel keeps without an A-buffer"))};
}

}  // namespace

TechniqueKind casav_kind() {
  return {.name = "casav",
          .description =
              "correlation-aware semi-analytic visibility, as its paper has it: a 32-bit mask from a table, "
              "and one aggregate with a depth slab per pixel; the options are other readings of the paper",
          .source = "Crassin et al. 2018",
          .examples = {"casav", "casav:mask=exact", "casav:storage=text", "casav:reading=literal",
                       "casav:sort=nearest,tiny=3,overlap=transition,regional=area,fuzzy=mix,extents=slab,slab=full,"
                       "plane=area,thickness=containing",
                       "casav:thickness=none", "casav:mask=exact,depths=positions,overlap=unbounded",
                       "casav:order=near-first", "casav:order=stream,layers=8"},
          .stressed = {"casav", "casav:reading=literal", "casav:storage=text"},
          .counters = {"merges", "tiny_triangles"},
          .make = make_from(CasavOptions{.tiny_positions = 1}, casav_options, make_casav)};
}

TechniqueKind alpha_kind() {
  return {.name = "alpha",
          .description = "the fragments of casav, blended by plain OVER, without masks",
          .source = "Porter and Duff 1984",
          .examples = {"alpha"},
          .stressed = {"alpha"},
          .counters = {"merges", "tiny_triangles"},
          .make = make_plain([] { return make_casav(CasavOptions{.rules = Rules::over, .mask = MaskSource::none}); })};
}

}  // namespace beampipe
