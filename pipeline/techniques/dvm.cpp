#include "pipeline/techniques/dvm.h"

#include <algorithm>

#include "pipeline/bins/render_bins.h"
#include "pipeline/sampling.h"
#include "pipeline/technique_table.h"
#include "pipeline/techniques/visibility.h"
#include "pipeline/units/gbuffer_unit.h"
#include "pipeline/units/temporal_units.h"
#include "pipeline/units/translucent_layer.h"
#include "stages/picture/shade.h"
#include "stages/samples/dilate.h"
#include "stages/samples/materials.h"
#include "stages/samples/sample_select.h"

namespace beampipe {
namespace {

// Shading samples go to memory, where the next pass reads them.
Framebuffer dvm_framebuffer(const DvmOptions& options) {
  constexpr bool kOutlivesBin = true;
  Framebuffer framebuffer{.surfaces = {{"depth", "D32F x 8", 8 * kSampleDepthBytes},
                                       {"visibility", "R32UI x 8", 8 * kVisibilityBytes},
                                       {"shading_visibility", "R32UI", kVisibilityBytes, kOutlivesBin},
                                       {"mask", "R32UI", 4, kOutlivesBin},
                                       {"location", "R8UI", 1, kOutlivesBin},
                                       {"gbuffer", "RGBA8 + RGB10A2", kGBufferBytes, kOutlivesBin},
                                       {"color", "RGB16F", kSampleColorBytes, kOutlivesBin},
                                       {"motion", "RG16F", kMotionBytes, kOutlivesBin},
                                       {"history", "RGBA16F x 2", 16, kOutlivesBin}},
                          .translucent = {translucent_layer(8), {"translucent", "RGBA16F", kLayerBytes, kOutlivesBin}}};
  const auto add = [&](const char* name, const char* format, std::uint32_t bytes) {
    framebuffer.surfaces.push_back({name, format, bytes, kOutlivesBin});
  };
  if (options.clamp != Clamp::variance) add("speed", "R16F", kSpeedBytes);
  if (options.clamp == Clamp::rest) add("look", "R32UI x 2", 2 * kLookBytes);
  if (options.clamp == Clamp::variance) add("deviation", "RGBA16F x 2", 2 * kDeviationBytes);
  if (options.room > 0)
    add("extra_samples", "visibility, mask, location, gbuffer, color",
        options.room * (kShadingSampleBytes + kGBufferBytes + kSampleColorBytes) / 4);
  return framebuffer;
}

// Counts each shading sample, with its G-buffer and colour, at the pixel of the quad that stores it; an extra one where
// it is shaded.
void add_sample_bytes(const std::vector<SampleQuad>& quads, const Tile& tile, std::vector<float>& bytes) {
  const std::size_t columns = (static_cast<std::size_t>(tile.width()) + 1) / 2;
  const auto add = [&](std::size_t q, std::size_t p, std::uint32_t triangle) {
    const std::size_t x = 2 * (q % columns) + p % 2, y = 2 * (q / columns) + p / 2;
    const bool is_shaded = triangle != kNoTriangle;
    bytes[y * static_cast<std::size_t>(tile.width()) + x] +=
        static_cast<float>(kShadingSampleBytes + (is_shaded ? kGBufferBytes + kSampleColorBytes : 0));
  };
  for (std::size_t q = 0; q < quads.size(); ++q)
    for (std::size_t p = 0; p < 4; ++p)
      if (quads[q].mask[p] != 0) add(q, p, quads[q].triangle[p]);
  for (const auto& [q, extra] : extras_of(quads)) add(q, extra->location / 8u, extra->triangle);
}

// What ends the lists of extra samples that do not fill their room.
std::uint64_t end_bytes(const std::vector<SampleQuad>& quads, std::uint32_t room) {
  std::uint64_t bytes = 0;
  for (const SampleQuad& quad : quads) bytes += quad.extras.size() < room ? kEndOfExtrasBytes : 0;
  return bytes;
}

// Sorts the quads' shading samples by material, and shades and lights them one by one.
void shade_samples(Bin& bin, const SamplePattern& pattern, const Materials& materials, std::vector<SampleQuad>& quads) {
  const BinStage sorting = bin.stage(StageId::material_sort), shading = bin.stage(StageId::shade),
                 lighting = bin.stage(StageId::light);
  const std::vector<std::uint32_t> of_quads = triangles_of(quads);
  sorting.streams(of_quads.size() * kVisibilityBytes);
  const std::vector<std::uint32_t> order = sort_materials(bin, of_quads, materials);
  std::vector<std::uint32_t> triangles;
  for (const std::uint32_t sample : order) triangles.push_back(of_quads[sample]);
  color_samples(bin.shader(), bin.tile, pattern, order, quads, bin.texels());
  bin.charge_texels(shading);
  write_gbuffer(bin.shader(), triangles, shading.timed());
  shading.streams(order.size() * (kVisibilityBytes + kGBufferBytes));
  for (const std::uint32_t triangle : triangles) bin.triangle_fetches().attributes(triangle, shading.counters);
  bin.triangle_fetches().flush(shading.counters);
  light(bin.shader(), triangles, lighting.timed());
  lighting.streams(order.size() * (kGBufferBytes + kSampleColorBytes));
}

// Marks the pixels by the number of materials in their quads.
void count_quads(Bin& bin, const std::vector<SampleQuad>& quads) {
  std::vector<float>* const by_materials[5] = {&bin.pixel_counter("quads_of_1"), &bin.pixel_counter("quads_of_2"),
                                               &bin.pixel_counter("quads_of_3"), &bin.pixel_counter("quads_of_4"),
                                               &bin.pixel_counter("quads_of_5_or_more")};
  std::vector<float>& partial = bin.pixel_counter("partial_quads");
  const auto width = static_cast<std::size_t>(bin.tile.width()), columns = (width + 1) / 2;
  for (std::size_t pixel = 0; pixel < bin.tile.pixels(); ++pixel) {
    const SampleQuad& quad = quads[pixel / width / 2 * columns + pixel % width / 2];
    (*by_materials[std::min<std::size_t>(quad.materials, 5) - 1])[pixel] = 1;
    partial[pixel] = quad.pixels < 4;
  }
}

// Over a tile's colours, and over the range of colours that its history may have.
void put_layer_over(const std::vector<glm::vec4>& layer, const Tile& tile, CurrentFrame& frame) {
  for (std::int32_t y = tile.y0; y < tile.y1; ++y)
    for (std::int32_t x = tile.x0; x < tile.x1; ++x) {
      const auto i = static_cast<std::size_t>(y * frame.width + x);
      for (std::vector<glm::vec4>* const colors : {&frame.color, &frame.low, &frame.high})
        (*colors)[i] = put_over(layer[i], (*colors)[i]);
    }
}

// What decides how far the clamp applies: how a bin's pixels have moved and changed.
void find_changes(Bin& bin, const DepthTestUnit& visibility, const std::vector<std::uint32_t>& looks, Clamp clamp,
                  TemporalFrame& over_time) {
  const BinStage stage = bin.stage(StageId::motion);
  const MovingTile moving = over_time.motion().of(bin);
  PixelContents found;
  if (clamp == Clamp::rest) found = contents(visibility.surface(), moving, looks, stage.timed());
  if (clamp == Clamp::camera) found.speeds = camera_speeds(visibility.surface(), moving, stage.timed());
  stage.streams(found.looks.size() * kLookBytes + found.speeds.size() * kSpeedBytes);
  if (!found.looks.empty()) copy_to_frame(found.looks, bin.tile, bin.context.frame, over_time.current.looks);
  if (!found.speeds.empty()) copy_to_frame(found.speeds, bin.tile, bin.context.frame, over_time.current.speeds);
}

std::vector<ErrorSource> error_sources(const DvmOptions& options) {
  std::vector<ErrorSource> sources = {ErrorSource::sampled_depth, ErrorSource::gbuffer_of_8_bits,
                                      ErrorSource::quads_over_the_border};
  if (options.material == MaterialBy::draw) sources.push_back(ErrorSource::shared_shading_samples);
  return sources;
}

FrameResult render_dvm(const FrameJob& job, const DvmOptions& options) {
  const FrameContext context(job, {.storage = MaterialStorage::gbuffer});
  const Frame& frame = job.frame;
  TemporalFrame over_time(context, {options.blend, options.clamp, kStillPixels, kDeviations});
  const std::uint32_t frames = over_time.history().frames;
  const Materials materials(material_ids(context.triangles, options.material));
  const std::vector<std::uint32_t> looks = looks_of(frame);
  const Sampling sampling{CellGrid{}, standard_pattern(8)};
  const SelectOptions select{frames % 8, frames + 1, options.room};
  QuadFrame quads(frame.width, frame.height);
  std::vector<glm::vec4> translucent(context.has_blending() ? over_time.current.color.size() : 0);

  const BinPlan plan{
      .stages = {StageId::sample_raster, StageId::depth_test, StageId::sample_select, StageId::material_sort,
                 StageId::shade, StageId::light, StageId::motion, StageId::blend},
      .framebuffer = dvm_framebuffer(options),
      .empty_bins_differ = true};
  FrameResult result = render_bins(context, plan, [&](Bin& bin) {
    const BinStage selecting = bin.stage(StageId::sample_select);
    DepthTestUnit visibility(bin, sampling, kVisibilityBytes);
    draw_visibility(bin, visibility);
    std::vector<SampleQuad> selected =
        sample_select(visibility.surface(), bin.tile, materials.ids, select, selecting.timed());
    visibility.read_colors(selecting);
    selecting.streams(shaded_samples(selected) * kShadingSampleBytes + end_bytes(selected, options.room));
    count_quads(bin, selected);
    shade_samples(bin, sampling.pattern, materials, selected);
    quads.insert(bin.tile, selected);
    over_time.find_motion(bin, visibility);
    find_changes(bin, visibility, looks, options.clamp, over_time);
    if (context.has_blending()) {
      copy_to_frame(draw_translucent(bin, visibility, ShadeAt::centroid), bin.tile, frame, translucent);
      bin.stage(StageId::blend).streams(bin.tile.pixels() * kLayerBytes);
    }
    if (bin.models_memory()) add_sample_bytes(selected, bin.tile, bin.pixel_counter("bytes"));
  });
  run_on_tiles(context, StageId::dilate, result, [&](const Tile& tile, const BinStage& stage) {
    dilate({quads, context.triangles.draws, context.background, options.room}, tile, stage.timed(), over_time.current);
    const std::vector<SampleQuad> here = quads.of(tile);
    stage.streams((tile.pixels() + extras_of(here).size()) * (kSampleColorBytes + kShadingSampleBytes) +
                  end_bytes(here, options.room));
    if (!context.has_blending()) return;
    put_layer_over(translucent, tile, over_time.current);
    stage.streams(tile.pixels() * kLayerBytes);
  });
  run_on_tiles(context, StageId::temporal, result,
               [&](const Tile& tile, const BinStage& stage) { over_time.accumulate(tile, stage); });
  result.pixel_counters["unknown"] = unknown_part(over_time.current);
  over_time.finish(result);
  return result;
}

// A quad has four pixels, and six counters are about quads.
std::uint32_t working_bytes(Clamp clamp) {
  constexpr std::uint32_t kQuadBytes = sizeof(SampleQuad) / 4 + 6 * sizeof(float);
  return kTemporalWorkingBytes + kQuadBytes + (clamp == Clamp::variance ? sizeof(glm::vec4) : 0);
}

}  // namespace

TechniqueKind dvm_kind() {
  return {.name = "dvm",
          .description =
              "decoupled visibility multisampling: 8 triangle ids per pixel, four shaded samples per 2x2 quad "
              "spread by their masks, accumulated over time",
          .source = "Hable 2021",
          .examples = {"dvm", "dvm:material=draw", "dvm:clamp=camera", "dvm:clamp=variance", "dvm:extra=4"},
          .stressed = {"dvm"},
          .counters = {"quads_of_1", "quads_of_2", "quads_of_3", "quads_of_4", "quads_of_5_or_more", "partial_quads",
                       "unknown"},
          .make = make_from(
              DvmOptions{},
              [](DvmOptions& o) -> SpecOptions {
                return {number("blend", o.blend, 0.001f, 1.0f, "weight of each new frame"),
                        choice("material", o.material, {{"color", MaterialBy::color}, {"draw", MaterialBy::draw}},
                               "which samples may share a colour: those of one draw and Kd, or of one draw"),
                        choice("clamp", o.clamp,
                               {{"rest", Clamp::rest}, {"camera", Clamp::camera}, {"variance", Clamp::variance}},
                               "where the history keeps colours that the new frame lacks: where all in the pixel "
                               "rests, where the camera does, or as far as the pixel's values varied before"),
                        choice("extra", o.room, {{"0", 0u}, {"4", 4u}, {"28", 28u}},
                               "shading samples that a quad has room for beside its four; materials without a sample "
                               "take them first, and then those of others; 28 are enough for all")};
              },
              [](const DvmOptions& o) {
                return Technique{.framebuffer = dvm_framebuffer(o),
                                 .sampled_at = places_of(msaa_sampling(8)),
                                 .errs_by = error_sources(o),
                                 .renderer = bind_options(render_dvm, o),
                                 .keeps_history = true,
                                 .working_bytes_per_pixel = working_bytes(o.clamp)};
              })};
}

}  // namespace beampipe
