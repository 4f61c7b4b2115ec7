#include "pipeline/technique_table.h"

#include <limits>

#include "pipeline/techniques/acaa.h"
#include "pipeline/techniques/beam.h"
#include "pipeline/techniques/beam_paper.h"
#include "pipeline/techniques/beam_stream.h"
#include "pipeline/techniques/deferred.h"
#include "pipeline/techniques/dvm.h"
#include "pipeline/techniques/msaa.h"
#include "pipeline/techniques/reference.h"
#include "pipeline/techniques/taa.h"
#include "pipeline/techniques/visibility.h"
#include "pipeline/techniques/z3.h"

namespace beampipe {
namespace {

TechniqueKind beam_kind() {
  return {.name = "beam",
          .description =
              "the triangles of a pixel, sorted by depth, become fragments with analytic coverage and a mask, "
              "composed near to far into one area-conserving aggregate until the pixel is closed",
          .source = "ours, after Crassin et al. 2018",
          .make = make_from(
              BeamOptions{},
              [](BeamOptions& o) -> SpecOptions {
                return {choice("bits", o.positions, {{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}},
                               "positions of the mask"),
                        choice("storage", o.storage, {{"packed", Storage::packed}, {"float32", Storage::float32}},
                               "format of the aggregate's colour: fp16, or float32")};
              },
              [](const BeamOptions& o) {
                Technique technique{.framebuffer = beam_framebuffer(o), .render = bind_options(render_beam, o)};
                technique.weights = bind_options(beam_weights, o);
                return technique;
              })};
}

TechniqueKind beam_stream_kind() {
  return {.name = "beam",
          .variant = {"order", "stream", "sort"},
          .description =
              "fragments in primitive order, without an A-buffer; a pixel with more visible surfaces than "
              "layers takes further passes over the geometry",
          .source = "ours",
          .make = make_from(
              StreamOptions{},
              [](StreamOptions& o) -> SpecOptions {
                return {
                    choice("bits", o.positions, {{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}},
                           "positions of the mask"),
                    choice("layers", o.layers, {{"1", 1}, {"5", 5}},
                           "surfaces that a pixel keeps at once; fewer layers take more passes"),
                    number("passes", o.passes, 1, 1000, "most passes over the geometry; without it there is no limit")};
              },
              [](const StreamOptions& o) {
                return Technique{.framebuffer = stream_framebuffer(o), .render = bind_options(render_stream, o)};
              })};
}

Technique make_published(const PublishedOptions& options) {
  Technique technique{.framebuffer = published_framebuffer(options), .render = bind_options(render_published, options)};
  technique.weights = bind_options(published_weights, options);
  return technique;
}

// simd/merge_rules.h explains the policies, and docs/accuracy.md says where they come from.
SpecOptions published_options(PublishedOptions& o) {
  using R = MergeRules;
  return {choice("mask", o.mask, {{"table", MaskSource::table}, {"exact", MaskSource::exact}},
                 "masks from a 64 x 64 table, or from edge tests"),
          choice("sort", o.sort, {{"centroid", SortKey::centroid}, {"nearest", SortKey::nearest}},
                 "the fragment's depth that the A-buffer sorts by"),
          choice("tiny", o.tiny_positions, {{"1", 1}, {"3", 3}}, "most mask positions that a speck is given"),
          choice("overlap", o.merge.overlap,
                 {{"tiny", R::Overlap::tiny},
                  {"over", R::Overlap::over},
                  {"add", R::Overlap::add},
                  {"transition", R::Overlap::transition}},
                 "how coverages combine where masks overlap: ADD for specks and OVER for others, OVER, ADD, or a "
                 "transition from ADD to OVER"),
          choice("local", o.merge.local, {{"clamp", R::Local::clamp}, {"keep", R::Local::keep}},
                 "a local coverage above 1 is clamped to 1, or kept"),
          choice("fuzzy", o.merge.fuzzy, {{"delta", R::Fuzzy::delta}, {"mix", R::Fuzzy::mix}},
                 "blending within the slab: by the published formulas, or between over and under"),
          choice("extents", o.merge.extents, {{"range", R::Extents::range}, {"slab", R::Extents::slab}},
                 "the slab ends at its depth range, or at its thickness alone"),
          choice("slab", o.merge.slab, {{"full", R::Slab::full}, {"visible", R::Slab::visible}},
                 "the slab grows by the whole fragment, or by its visible positions"),
          choice("plane", o.merge.plane, {{"area", R::Plane::area}, {"visible", R::Plane::visible}},
                 "planes are weighted by coverage, or by what is visible of each"),
          choice("thickness", o.merge.thickness,
                 {{"larger", R::Thickness::larger}, {"containing", R::Thickness::containing}},
                 "the slab keeps the larger thickness, or contains all merged fragments"),
          choice("storage", o.storage,
                 {{"slides", PaperStorage::slides}, {"text", PaperStorage::text}, {"float32", PaperStorage::float32}},
                 "formats of the aggregate: as in the talk's slides, as in the paper's text, or float32")};
}

TechniqueKind beam_paper_kind() {
  return {.name = "beam",
          .variant = {"rules", "paper", "conserve"},
          .description =
              "the published rules: a 32-bit mask from a table, a depth slab, one aggregate per pixel; the "
              "options are other readings of these rules, see docs/accuracy.md",
          .source = "Crassin et al. 2018",
          .make = make_from(PublishedOptions{.tiny_positions = 1}, published_options, make_published)};
}

TechniqueKind alpha_kind() {
  return {.name = "alpha",
          .description = "the fragments of the published rules, blended by plain OVER, without masks",
          .source = "Porter and Duff 1984",
          .make = make_plain(
              [] { return make_published(PublishedOptions{.rules = Rules::over, .mask = MaskSource::none}); })};
}

TechniqueKind z3_kind() {
  struct Shape {
    int positions, layers;
    bool operator==(const Shape&) const = default;
  };
  struct Z3Spec {
    Shape shape{Z3Options{}.positions, Z3Options{}.layers};
    LayerMerge merge = Z3Options{}.merge;
  };
  return {.name = "z3",
          .description =
              "fragments in primitive order, kept in a few layers per pixel; when there is no room, two layers merge",
          .source = "Jouppi and Chang 1999",
          .make = make_from(
              Z3Spec{},
              [](Z3Spec& o) -> SpecOptions {
                return {choice("shape", o.shape, {{"32x2", {32, 2}}, {"32x3", {32, 3}}, {"128x3", {128, 3}}},
                               "positions of the mask x layers"),
                        choice("merge", o.merge, {{"depth", LayerMerge::depth}, {"color", LayerMerge::color}},
                               "the two layers that merge are the closest in depth (as published), or in colour")};
              },
              [](const Z3Spec& o) {
                const Z3Options options{o.shape.positions, o.shape.layers, o.merge};
                return Technique{.framebuffer = z3_framebuffer(options), .render = bind_options(render_z3, options)};
              })};
}

TechniqueKind msaa_kind() {
  return {
      .name = "msaa",
      .description =
          "multisampling: depth and colour at N samples, one shader invocation per triangle and pixel; above "
          "16 samples, super-resolution of 8x",
      .source = "Direct3D, Vulkan",
      .make = make_from(
          MsaaOptions{},
          [](MsaaOptions& o) -> SpecOptions {
            return {
                samples(o.samples, kMaxMsaaSamples, "samples per pixel"),
                choice("color", o.rgba, {{"rgb16f", false}, {"rgba16f", true}}, "format of a sample's colour"),
                choice("at", o.at, {{"centre", ShadeAt::centre}, {"centroid", ShadeAt::centroid}},
                       "where a fragment is shaded that does not cover the pixel's centre: there all the same, or at "
                       "the centroid of its samples"),
                flag("prepass", o.prepass,
                     "depth first, so that only visible fragments are shaded; the picture is the same")};
          },
          [](const MsaaOptions& o) {
            return Technique{.framebuffer = msaa_framebuffer(o),
                             .samples = static_cast<std::uint32_t>(o.samples),
                             .render = bind_options(render_msaa, o)};
          })};
}

TechniqueKind acaa_kind() {
  using A = AccumulatorFormat;
  return {.name = "acaa",
          .description = "accumulative antialiasing: N depth samples and one colour accumulator per pixel",
          .source = "Enderton et al. 2015",
          .make = make_from(
              AcaaOptions{},
              [](AcaaOptions& o) -> SpecOptions {
                return {samples(o.samples, kMaxAcaaSamples, "samples per pixel"),
                        choice("double", o.double_counting,
                               {{"none", DoubleCounting::none},
                                {"stencil", DoubleCounting::stencil},
                                {"saturate", DoubleCounting::saturate}},
                               "what keeps surfaces of equal depth from being counted twice"),
                        choice("color", o.color, {{"unorm8", A::unorm8}, {"fp16", A::fp16}, {"fp32", A::fp32}},
                               "format of the accumulator")};
              },
              [](const AcaaOptions& o) {
                return Technique{.framebuffer = acaa_framebuffer(o), .render = bind_options(render_acaa, o)};
              })};
}

TechniqueKind deferred_kind() {
  return {.name = "deferred",
          .description = "one sample per pixel: depth, then a G-buffer from 2x2 quads, then lighting per pixel",
          .source = "Burns and Hunt 2013, Hable 2021",
          .make = make_plain([] {
            return Technique{.framebuffer = deferred_framebuffer(), .render = bind_options(render_deferred)};
          })};
}

TechniqueKind visibility_kind() {
  return {.name = "visibility",
          .description = "one sample per pixel: triangle ids and depth, then shading per pixel",
          .source = "Burns and Hunt 2013, Hable 2021",
          .make = make_plain([] {
            return Technique{.framebuffer = visibility_framebuffer(), .render = bind_options(render_visibility)};
          })};
}

TechniqueKind taa_kind() {
  return {.name = "taa",
          .description = "temporal antialiasing of visibility at one sample per pixel, jittered over N positions",
          .source = "Lottes 2011, Karis 2014, Salvi 2016",
          .make = make_from(
              TaaOptions{},
              [](TaaOptions& o) -> SpecOptions {
                return {samples(o.samples, kMaxTaaSamples, "positions of the jitter"),
                        number("blend", o.blend, 0.001f, 1.0f, "weight of each new frame")};
              },
              [](const TaaOptions& o) {
                return Technique{.framebuffer = taa_framebuffer(),
                                 .render = bind_options(render_taa, o),
                                 .keeps_history = true,
                                 .working_bytes_per_pixel = kTemporalWorkingBytes};
              })};
}

TechniqueKind dvm_kind() {
  constexpr std::uint32_t kMostSeed = std::numeric_limits<std::uint32_t>::max();
  return {.name = "dvm",
          .description =
              "decoupled visibility multisampling: 8 triangle ids per pixel, four shaded samples per 2x2 quad "
              "spread by their masks, accumulated over time",
          .source = "Hable 2021",
          .make = make_from(
              DvmOptions{},
              [](DvmOptions& o) -> SpecOptions {
                return {number("blend", o.blend, 0.001f, 1.0f, "weight of each new frame"),
                        number("seed", o.seed, 0u, kMostSeed, "seed of the random choices"),
                        choice("material", o.material, {{"color", MaterialBy::color}, {"draw", MaterialBy::draw}},
                               "samples share what is shaded within a draw and Kd, or within a draw")};
              },
              [](const DvmOptions& o) {
                return Technique{.framebuffer = dvm_framebuffer(),
                                 .render = bind_options(render_dvm, o),
                                 .keeps_history = true,
                                 .working_bytes_per_pixel = kDvmWorkingBytes};
              })};
}

TechniqueKind reference_kind() {
  return {.name = "reference",
          .description = "4096 samples per pixel in double precision: the truth that errors are measured against",
          .source = "ours",
          .make = make_plain([] {
            return Technique{.framebuffer = reference_framebuffer(), .render = bind_options(render_reference)};
          })};
}

}  // namespace

const std::vector<TechniqueKind>& technique_kinds() {
  static const std::vector<TechniqueKind> kinds = {
      beam_kind(), beam_stream_kind(), beam_paper_kind(), alpha_kind(), z3_kind(),  msaa_kind(),
      acaa_kind(), deferred_kind(),    visibility_kind(), taa_kind(),   dvm_kind(), reference_kind(),
  };
  return kinds;
}

}  // namespace beampipe
