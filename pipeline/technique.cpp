#include "pipeline/technique.h"

#include "pipeline/bins/threads.h"
#include "pipeline/spec.h"
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

// The render function of a technique that takes its frame and, if it has any, its options.
template <class Render, class... Options>
auto bind_options(Render* render, const Options&... options) {
  return [=](const Trace& trace, std::size_t frame, const RunOptions& run) {
    return on_threads(run.threads, [&] { return render(trace, trace.frames.at(frame), options..., run); });
  };
}

// What the paper leaves open, by the names of simd/merge_rules.h.
MergeRules merge_rules(Spec& spec) {
  using R = MergeRules;
  R rules;
  rules.overlap = spec.choice<R::Overlap>("overlap", {{"tiny", R::Overlap::tiny},
                                                      {"over", R::Overlap::over},
                                                      {"add", R::Overlap::add},
                                                      {"transition", R::Overlap::transition}});
  rules.local = spec.choice<R::Local>("local", {{"clamp", R::Local::clamp}, {"keep", R::Local::keep}});
  rules.fuzzy = spec.choice<R::Fuzzy>("fuzzy", {{"delta", R::Fuzzy::delta}, {"mix", R::Fuzzy::mix}});
  rules.extents = spec.choice<R::Extents>("extents", {{"range", R::Extents::range}, {"slab", R::Extents::slab}});
  rules.slab = spec.choice<R::Slab>("slab", {{"full", R::Slab::full}, {"visible", R::Slab::visible}});
  rules.plane = spec.choice<R::Plane>("plane", {{"area", R::Plane::area}, {"visible", R::Plane::visible}});
  rules.thickness = spec.choice<R::Thickness>(
      "thickness", {{"larger", R::Thickness::larger}, {"containing", R::Thickness::containing}});
  return rules;
}

Technique make_published(Spec& spec) {
  PublishedOptions options;
  options.mask = spec.choice<MaskSource>("mask", {{"table", MaskSource::table}, {"exact", MaskSource::exact}});
  options.sort = spec.choice<SortKey>("sort", {{"centroid", SortKey::centroid}, {"nearest", SortKey::nearest}});
  options.tiny_positions = spec.choice<int>("tiny", {{"1", 1}, {"3", 3}});
  options.merge = merge_rules(spec);
  options.storage = spec.choice<PaperStorage>(
      "storage", {{"slides", PaperStorage::slides}, {"text", PaperStorage::text}, {"float32", PaperStorage::float32}});
  return {spec.text(), published_framebuffer(options), 0, bind_options(render_published, options), true};
}

Technique make_stream(Spec& spec) {
  StreamOptions options;
  options.positions = spec.choice<int>("bits", {{"128", 128}, {"256", 256}, {"64", 64}, {"32", 32}});
  options.layers = spec.choice<int>("layers", {{"5", 5}, {"1", 1}});
  options.passes = spec.number("passes", 0, 1, 1000);
  return {spec.text(), stream_framebuffer(options), 0, bind_options(render_stream, options)};
}

Technique make_beam(Spec& spec) {
  if (spec.choice<bool>("rules", {{"conserve", false}, {"paper", true}})) return make_published(spec);
  if (spec.choice<bool>("order", {{"sort", false}, {"stream", true}})) return make_stream(spec);
  BeamOptions options;
  options.positions = spec.choice<int>("bits", {{"256", 256}, {"128", 128}, {"64", 64}, {"32", 32}});
  options.storage = spec.choice<Storage>("storage", {{"packed", Storage::packed}, {"float32", Storage::float32}});
  return {spec.text(), beam_framebuffer(options), 0, bind_options(render_beam, options), true};
}

Technique make_alpha(Spec& spec) {
  PublishedOptions options;
  options.rules = Rules::over;
  options.mask = MaskSource::none;
  return {spec.text(), published_framebuffer(options), 0, bind_options(render_published, options), true};
}

Technique make_z3(Spec& spec) {
  struct Shape {
    int positions, layers;
  };
  Z3Options options;
  const auto shape = spec.choice<Shape>("shape", {{"32x3", {32, 3}}, {"32x2", {32, 2}}, {"128x3", {128, 3}}});
  options.positions = shape.positions, options.layers = shape.layers;
  options.merge = spec.choice<LayerMerge>("merge", {{"depth", LayerMerge::depth}, {"color", LayerMerge::color}});
  return {spec.text(), z3_framebuffer(options), 0, bind_options(render_z3, options)};
}

Technique make_msaa(Spec& spec) {
  MsaaOptions options;
  options.samples = spec.samples(kMaxMsaaSamples);
  options.rgba = spec.choice<bool>("color", {{"rgb16f", false}, {"rgba16f", true}});
  options.at = spec.choice<ShadeAt>("at", {{"centre", ShadeAt::centre}, {"centroid", ShadeAt::centroid}});
  options.prepass = spec.flag("prepass");
  return {spec.text(), msaa_framebuffer(options), static_cast<std::uint32_t>(options.samples),
          bind_options(render_msaa, options)};
}

Technique make_acaa(Spec& spec) {
  AcaaOptions options;
  options.samples = spec.samples(kMaxAcaaSamples);
  options.double_counting = spec.choice<DoubleCounting>(
      "double",
      {{"none", DoubleCounting::none}, {"stencil", DoubleCounting::stencil}, {"saturate", DoubleCounting::saturate}});
  options.color = spec.choice<AccumulatorFormat>(
      "color",
      {{"fp16", AccumulatorFormat::fp16}, {"unorm8", AccumulatorFormat::unorm8}, {"fp32", AccumulatorFormat::fp32}});
  return {spec.text(), acaa_framebuffer(options), 0, bind_options(render_acaa, options)};
}

Technique make_deferred(Spec& spec) { return {spec.text(), deferred_framebuffer(), 0, bind_options(render_deferred)}; }

Technique make_visibility(Spec& spec) {
  return {spec.text(), visibility_framebuffer(), 0, bind_options(render_visibility)};
}

Technique make_taa(Spec& spec) {
  TaaOptions options;
  options.samples = spec.samples(kMaxTaaSamples);
  options.blend = spec.number("blend", options.blend, 0.001f, 1.0f);
  return {spec.text(), taa_framebuffer(), 0, bind_options(render_taa, options), false, true, kTemporalWorkingBytes};
}

Technique make_dvm(Spec& spec) {
  DvmOptions options;
  options.blend = spec.number("blend", options.blend, 0.001f, 1.0f);
  options.seed = spec.number("seed", options.seed, 0u, std::numeric_limits<std::uint32_t>::max());
  options.material = spec.choice<MaterialBy>("material", {{"color", MaterialBy::color}, {"draw", MaterialBy::draw}});
  return {spec.text(), dvm_framebuffer(), 0, bind_options(render_dvm, options), false, true, kDvmWorkingBytes};
}

Technique make_reference(Spec& spec) {
  return {spec.text(), reference_framebuffer(), 0, bind_options(render_reference)};
}

struct Kind {
  std::string_view name;
  const char* usage;  // behind "expected"
  const char* help;   // lines
  Technique (*make)(Spec&);
};

constexpr Kind kKinds[] = {
    {"beam",
     "beam, beam:bits=256|128|64|32,storage=packed|float32, either or both, beam:order=stream and, if wanted, "
     "bits=128|256|64|32, layers=5|1, passes=N, or "
     "beam:rules=paper and, if wanted, mask=table|exact, sort=centroid|nearest, "
     "tiny=1|3, overlap=tiny|over|add|transition, local=clamp|keep, fuzzy=delta|mix, extents=range|slab, "
     "slab=full|visible, plane=area|visible, thickness=larger|containing, storage=slides|text|float32",
     "  beam         sorted, visible fragments with analytic coverage and a mask, one area-conserving aggregate per "
     "pixel\n"
     "               beam:bits=N      N = 32, 64, 128 or 256 (the default) mask positions\n"
     "               beam:order=stream  fragments in primitive order, no A-buffer: a pixel's state is all there is; "
     "pixels\n"
     "                 with more visible surfaces than layers take further passes over the geometry\n"
     "               beam:order=stream,bits=N,layers=5|1,passes=P  N = 128 positions and 5 layers: 80 bytes; N = 64 "
     "and\n"
     "                 1 layer: 32 bytes; at most P passes\n"
     "               beam:storage=packed|float32  the aggregate's colour: fp16 (the default) or float32\n"
     "               beam:rules=paper the published rules: 32-bit mask, depth slab\n"
     "               beam:rules=paper,storage=slides|text|float32  42 bytes as in the talk, 32 as in the text, or 56\n"
     "               beam:rules=paper,mask=exact  its masks from edge tests in place of the 64 x 64 table\n"
     "               beam:rules=paper,sort=nearest,tiny=3,overlap=over|add|transition,local=keep,fuzzy=mix,\n"
     "                 extents=slab,slab=visible,plane=visible,thickness=containing  other readings of its rules,\n"
     "                 any of them (docs/accuracy.md)\n",
     make_beam},
    {"z3", "z3 or z3:shape=32x3|32x2|128x3,merge=depth|color, either or both",
     "  z3           fragments in primitive order into layers, those too many merged: Z3 (Jouppi and Chang 1999)\n"
     "               z3:shape=PxL  P mask positions and L layers: 32x3 (the default), 32x2 or 128x3\n"
     "               z3:merge=depth|color  what is merged: the closest in depth (as published), or in colour\n",
     make_z3},
    {"alpha", "'alpha' alone: it has no options", "  alpha        the same fragments, plain OVER, no mask\n",
     make_alpha},
    {"msaa",
     "msaa:N with N = 1, 2, 4, 8, 16, 32, 64, 128, 256, 512 or 1024; then, if wanted, color=rgb16f|rgba16f, "
     "at=centre|centroid and prepass",
     "  msaa:N       multisampling, N = 1, 2, 4, ... 1024; above 16: super-resolution of 8x\n"
     "               msaa:N,color=rgba16f  8 bytes of colour per sample in place of 6\n"
     "               msaa:N,at=centre|centroid  where the pixel's centre is not covered, shade there all the same "
     "(the\n"
     "                 default), or at the centroid of the covered samples\n"
     "               msaa:N,prepass        depth first, so that only visible fragments are shaded; the same picture\n",
     make_msaa},
    {"acaa",
     "acaa:N with N = 1, 2, 4, 8, 16, 32, 64, 128 or 256; then, if wanted, double=none|stencil|saturate and "
     "color=fp16|unorm8|fp32",
     "  acaa:N       accumulative antialiasing: N depth samples, one colour accumulator; N = 1, 2, 4, ... 256\n"
     "               acaa:N,double=none|stencil|saturate  what keeps equal depths from counting twice (none)\n"
     "               acaa:N,color=fp16|unorm8|fp32        the accumulator's format (fp16)\n",
     make_acaa},
    {"deferred", "'deferred' alone: it has no options",
     "  deferred     1x: depth, G-buffer in 2x2 quads, then lighting per pixel\n", make_deferred},
    {"visibility", "'visibility' alone: it has no options",
     "  visibility   1x: triangle ids and depth, then shading per pixel\n", make_visibility},
    {"taa", "taa:N with N = 1, 2, 4, 8 or 16; then, if wanted, blend=T with T from 0.001 to 1",
     "  taa:N        temporal antialiasing of 1x visibility, jittered over N positions\n"
     "               taa:N,blend=T  weight of each new frame (0.1)\n",
     make_taa},
    {"dvm", "dvm or dvm:blend=T,seed=S,material=color|draw with T from 0.001 to 1 and S from 0 to 4294967295",
     "  dvm          decoupled visibility: 8x triangle ids, 4 shaded samples per 2x2 quad, spread by their masks\n"
     "               dvm:blend=T  weight of each new frame (0.1); dvm:seed=S  of the random choices (1)\n"
     "               dvm:material=color|draw  what samples are shared by: draw and Kd (the default), or draw alone\n",
     make_dvm},
    {"reference", "'reference' alone: it has no options",
     "  reference    4096 samples per pixel, double precision: the truth that errors are measured against\n",
     make_reference},
};

}  // namespace

Technique parse_technique(std::string_view text) {
  std::string names;
  for (const Kind& kind : kKinds) {
    if (kind.name == spec_name(text)) {
      Spec spec(text, kind.usage);
      Technique technique = kind.make(spec);
      spec.finish();
      return technique;
    }
    names.append(names.empty() ? "one of " : ", ").append(kind.name);
  }
  Spec(text, names).fail();
}

std::string technique_help() {
  std::string help;
  for (const Kind& kind : kKinds) help += kind.help;
  return help;
}

}  // namespace beampipe
