// Counters of frames that can be counted by hand.

#include "pipeline/bins/timeline.h"
#include "pipeline/technique_table.h"
#include "stages/data/sample_fragment.h"
#include "stages/geometry/draw_plan.h"
#include "tests/pipeline/surface_traces.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::counters_test {

TEST(Counters, DvmSelectsOutOfEightSamplesAPixel) {
  const StageCounters selecting = stage_of(parse_technique("dvm").render(half_square(), 0, {1}), "sample_select");
  EXPECT_EQ(selecting.items_in, 64u * 8);
  EXPECT_EQ(selecting.bytes_read, 64u * 8 * 4) << "a visibility id each";
  EXPECT_EQ(selecting.items_out, 64u) << "every pixel stores a sample";
  EXPECT_EQ(selecting.bytes_written, 64u * 9);
  EXPECT_EQ(selecting.lanes_issued, 64u);
}

TEST(Counters, ShadingRunsInWholeQuads) {
  const auto shading = [](const char* spec) {
    return stage_of(parse_technique(spec).render(half_square(), 0, {1}), "shade");
  };
  // The triangle covers the centres of the pixels (1, 2), (1, 3), (1, 4), (2, 3), (2, 4) and (3, 4), which lie in the
  // quads (0, 1), (0, 2), (1, 1) and (1, 2).
  for (const char* spec : {"msaa:1", "msaa:1,prepass", "deferred"}) {
    EXPECT_EQ(shading(spec).lanes_used, 6u) << spec;
    EXPECT_EQ(shading(spec).lanes_issued, 4u * 4) << spec;
  }
  EXPECT_EQ(shading("visibility").lanes_issued, 6u);
  EXPECT_EQ(shading("beam:order=sorted").lanes_issued, 10u) << "each pixel with a part of it, and no helpers";
  // With eight samples, the four pixels on the diagonal are covered in part. They lie in two more of the
  // 3 x 3 quads.
  for (const char* spec : {"msaa:8", "msaa:8,prepass", "acaa:8"}) {
    EXPECT_EQ(shading(spec).lanes_used, 10u) << spec;
    EXPECT_EQ(shading(spec).lanes_issued, 6u * 4) << spec;
  }
}

// One sheet covers 8 x 8 pixels, and an opaque wall, which is drawn later, hides half of it.
TEST(Counters, APrepassLeavesTranslucentFragmentsThatAreSeen) {
  SurfaceTrace scene(8, 8);
  scene.add_rectangle(0, 0, 8, 8, 0.5, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
  scene.add_rectangle(0, 0, 4, 8, 0.25, unlit_material(glm::vec4(1.0f)));
  for (const char* spec : {"msaa:1,prepass", "taa:1,shading=forward"}) {
    const FrameResult result = render(spec, scene.trace);
    EXPECT_EQ(stage_of(result, "blend").items_out, 32u) << spec;
    EXPECT_EQ(stage_of(result, "shade").items_in, 64u) << spec << ": each pixel is shaded once";
  }
}

// Nothing hides anything, so a depth pre-pass saves no shading.
TEST(Counters, TranslucentFragmentsAreShadedAlikeWithAPrepass) {
  Random random(3);
  SurfaceTrace scene(24, 16);
  const Material glass = textured_material(scene.add_image(random_image(random, 16, 16)), AlphaMode::blend);
  scene.add_rectangle(-1, -1, 30, 20, 0.9, unlit_material(glm::vec4(1.0f)));
  scene.add_rectangle(1.3, 2.2, 14.6, 9.1, 0.75, glass);
  scene.add_rectangle(7.7, 4.4, 20.5, 15.2, 0.5, glass);
  scene.add_rectangle(3.1, 7.9, 17.4, 12.8, 0.625, glass);
  FrameInput run{1};
  run.memory.modelled = false;  // caches see another order
  for (const std::string n : {"1", "8", "32"})
    for (const char* at : {"", ",at=centroid"}) {
      const auto shading = [&](const std::string& prepass) {
        return stage_of(parse_technique("msaa:" + n + at + prepass).render(scene.trace, 0, run), "shade");
      };
      EXPECT_EQ(shading(",prepass"), shading("")) << n << at;
    }
}

// In one bin, whose triangles the raster takes at once.
void expect_stages_as_they_run(const std::string& spec, const Trace& trace) {
  Timeline timeline;
  FrameInput run{1};
  run.tile_size = 32;
  const FrameResult result = parse_technique(spec).render(trace, 0, run, FrameSinks{.timeline = &timeline});
  std::vector<std::string> ran, listed;
  for (const Timeline::Event& event : timeline.events())
    if (event.tile && std::ranges::find(ran, event.name) == ran.end()) ran.push_back(event.name);
  for (const StageCounters& stage : result.stages)
    if (const std::string name(name_of(stage.stage)); std::ranges::find(ran, name) != ran.end()) listed.push_back(name);
  if (spec == "acaa:4,double=saturate") {  // it accumulates the background before any fragment
    std::erase(ran, "accumulate"), std::erase(listed, "accumulate");
  }
  EXPECT_EQ(listed, ran) << spec;
  EXPECT_GE(ran.size(), 2u) << spec;
}

TEST(Counters, StagesAreListedInTheOrderInWhichTheyRun) {
  const Trace by_depth = random_surfaces(24, 16, 60, 5);
  Trace in_order = by_depth;
  std::vector<Draw>& draws = in_order.frames[0].draws;
  draws.push_back(draws[0]);
  draws[1].state.blend = Blend{{BlendFactor::one, BlendFactor::one}, {}, {}};
  ASSERT_TRUE(needs_api_order(in_order, in_order.frames[0]));
  for (const std::string& spec : example_specs()) {
    expect_stages_as_they_run(spec, by_depth);
    expect_stages_as_they_run(spec, in_order);
  }
}

TEST(Counters, EveryTechniqueCountsFragmentsAndBytesOfPixels) {
  const Trace trace = random_trace(40, 30, 400, 2);
  for (const std::string& spec : example_specs()) {
    if (spec.starts_with("reference")) continue;
    const FrameResult result = parse_technique(spec).render(trace, 0, {2});
    EXPECT_GT(sum_of(result, "fragments"), 400) << spec;
    EXPECT_GT(sum_of(result, "bytes"), 400) << spec;
  }
}

// Pixel (1, 1) has a triangle in each corner, all four at different depths or all at the same, and a speck in the
// middle, which covers no position.
TEST(Counters, PixelsOfFourCornersAndASpeck) {
  const auto corners = [](double step) {
    const auto z = [&](int k) { return 0.1 + k * step; };
    std::vector<PixelSpaceTriangle> triangles = {
        {{{1.02, 1.02, z(0)}, {1.4, 1.02, z(0)}, {1.02, 1.4, z(0)}}, glm::vec3(1)},
        {{{1.98, 1.02, z(1)}, {1.98, 1.4, z(1)}, {1.6, 1.02, z(1)}}, glm::vec3(1)},
        {{{1.98, 1.98, z(2)}, {1.6, 1.98, z(2)}, {1.98, 1.6, z(2)}}, glm::vec3(1)},
        {{{1.02, 1.98, z(3)}, {1.02, 1.6, z(3)}, {1.4, 1.98, z(3)}}, glm::vec3(1)},
        {{{1.5, 1.5, 0.05}, {1.51, 1.5, 0.05}, {1.5, 1.51, 0.05}}, glm::vec3(1)}};
    return pixel_trace(4, 4, triangles);
  };
  const auto at = [](const FrameResult& result, const char* counter) {
    return result.pixel_counters.at(counter).at(1 * 4 + 1);
  };
  const FrameResult apart = parse_technique("beam:order=sorted").render(corners(0.1), 0, {1});
  EXPECT_EQ(at(apart, "fragments"), 5);
  EXPECT_EQ(at(apart, "merges"), 5);
  EXPECT_EQ(at(apart, "tiny_triangles"), 1);
  EXPECT_EQ(at(apart, "largest_window"), 1);
  EXPECT_EQ(at(parse_technique("beam:order=sorted").render(corners(0), 0, {1}), "largest_window"), 4);
  EXPECT_EQ(at(parse_technique("alpha").render(corners(0.1), 0, {1}), "merges"), 5);
  EXPECT_EQ(at(parse_technique("z3").render(corners(0.1), 0, {1}), "merges"), 1) << "four owners, three layers";
  for (const char* spec : {"beam", "beam:order=stream"}) {
    const FrameResult roomy = parse_technique(spec).render(corners(0.1), 0, {1});
    EXPECT_EQ(at(roomy, "fragments"), 5) << spec;
    EXPECT_EQ(at(roomy, "merges"), 0) << spec << ": there is room for each of four owners";
  }
  const FrameResult acaa = parse_technique("acaa:8").render(corners(0.1), 0, {1});
  EXPECT_EQ(at(acaa, "visible_fragments"), at(parse_technique("msaa:8").render(corners(0.1), 0, {1}), "fragments"))
      << "nothing is hidden";
}

// The bytes of all pixels add up to those of the stages: what depth tests read and write, and what is written of
// shading samples, the G-buffer and the colour.
TEST(Counters, PixelsAddUpToStages) {
  const Trace trace = random_trace(40, 30, 400, 2);
  for (const char* spec : {"msaa:8", "visibility", "visibility:4", "taa:4", "deferred", "dvm"}) {
    const FrameResult result = parse_technique(spec).render(trace, 0, {2});
    const bool twice = std::string(spec) == "deferred";
    const auto stage = [&](const char* name) { return twice ? both_passes(result, name) : stage_of(result, name); };
    const std::uint64_t fragments = stage("sample_raster").items_out;
    std::uint64_t bytes = stage("depth_test").logical_bytes() - fragments * kSampleFragmentBytes;
    for (const StageCounters& counters : result.stages) {
      if (counters.stage == StageId::sample_select || counters.stage == StageId::light) bytes += counters.bytes_written;
      if (counters.stage == StageId::shade && std::string(spec) != "msaa:8") bytes += counters.bytes_written;
    }
    EXPECT_EQ(sum_of(result, "bytes"), bytes) << spec;
    if (twice) continue;  // its fragments come twice, once for each pass
    EXPECT_EQ(sum_of(result, "fragments"), fragments) << spec;
  }
}

// Every pixel is read in its stored format and written as fp16 RGB. Both surfaces are contiguous in memory. Of open
// pixels a colour and an area are read; on chip that moves no memory. In memory, the words of 6 bytes are read; records
// were read when the last surfaces became final.
TEST(Counters, ResolveReadsEveryPixelOnceWhereItIsKept) {
  const Trace trace = random_trace(64, 32, 400, 2);
  FrameInput raw{2};
  raw.memory.compression = false;
  constexpr std::uint64_t kPixels = 64 * 32, kPicture = 6;
  for (const auto& [spec, items, read, moved] : {std::tuple{"beam:order=sorted", 1u, 42u, 42u},
                                                 {"casav", 1u, 42u, 42u},
                                                 {"alpha", 1u, 10u, 10u},
                                                 {"z3", 1u, 50u, 50u},
                                                 {"msaa:8", 8u, 48u, 48u},
                                                 {"msaa:32", 32u, 192u, 192u},
                                                 {"acaa:8", 1u, 8u, 8u},
                                                 {"visibility", 1u, 6u, 6u},
                                                 {"visibility:4", 4u, 24u, 24u},
                                                 {"beam", 1u, 8u, 0u},
                                                 {"beam:order=stream", 1u, 8u, 6u}}) {
    const StageCounters resolving = stage_of(parse_technique(spec).render(trace, 0, raw), "resolve");
    EXPECT_EQ(resolving.items_in, kPixels * items) << spec;
    EXPECT_EQ(resolving.items_out, kPixels) << spec;
    EXPECT_EQ(resolving.bytes_read, kPixels * read) << spec;
    EXPECT_EQ(resolving.bytes_written, kPixels * kPicture) << spec;
    EXPECT_EQ(resolving.lanes_used, resolving.items_in) << spec;
    EXPECT_EQ(resolving.lanes_issued, resolving.items_in) << spec;
    EXPECT_GE(resolving.sector_bytes, kPixels * (moved + kPicture)) << spec;
    EXPECT_LE(resolving.sector_bytes, kPixels * (moved + kPicture) * 105 / 100) << spec << ": some lie across sectors";
    EXPECT_EQ(resolving.dram_bytes, resolving.sector_bytes) << spec;
  }
}

// One triangle closes the first of four tiles of 32 x 32 pixels, and those pixels of the second where x + y < 64.
// Behind it lie a triangle in the first tile alone, and one in a row of pixels of both tiles, 8 of them in the second.
TEST(Counters, WhatIsHiddenIsCountedOnce) {
  const Trace trace = pixel_trace(128, 32,
                                  {{{{-1, -1, 0.3}, {66, -1, 0.3}, {-1, 66, 0.3}}, glm::vec3(1)},
                                   {{{2, 2, 0.6}, {9, 2, 0.6}, {2, 9, 0.6}}, glm::vec3(1)},
                                   {{{28.1, 2.1, 0.6}, {39.9, 2.1, 0.6}, {28.1, 2.4, 0.6}}, glm::vec3(1)}});
  for (const auto& [spec, raster, passes] : {std::tuple{"beam:order=sorted", "conservative_raster", 1u},
                                             {"msaa:8", "sample_raster", 1u},
                                             {"deferred", "sample_raster", 2u}}) {
    const FrameResult result = parse_technique(spec).render(trace, 0, {2});
    const StageCounters found = passes == 2 ? both_passes(result, raster) : stage_of(result, raster);
    EXPECT_EQ(found.empty_tiles, passes) << spec;
    EXPECT_EQ(found.hidden_triangles, 2u * passes) << spec;
    EXPECT_EQ(found.hidden_items, 8u * passes) << spec << ": of the second tile";
  }
  const StageCounters super = stage_of(parse_technique("msaa:32").render(trace, 0, {2}), "sample_raster");
  EXPECT_EQ(super.hidden_items, 16u) << "a pixel has 2 x 2 cells, and the triangle is in the upper ones";
  EXPECT_EQ(stage_of(parse_technique("z3").render(trace, 0, {2}), "conservative_raster").hidden_items, 0u);
}

// Whatever way an option takes through a technique, no stage of it works for nothing. The second trace has materials,
// cutouts and translucent triangles.
TEST(Counters, NoStageIsFree) {
  Trace flat = random_trace(40, 30, 50, 2);
  flat.frames[0].draws[0].shading = Shading::lambert;  // an unlit triangle needs no operations
  flat.frames[0].lighting.lights = {{glm::vec3(0, 0, 1)}};
  std::vector<std::string> specs = example_specs();
  for (const char* spec : {"msaa:4,prepass", "acaa:4,double=stencil", "acaa:32", "visibility:4", "msaa:4,motion"})
    specs.push_back(spec);
  for (const Trace& trace : {flat, random_surfaces(40, 30, 300, 2)}) {
    for (const std::string& spec : specs) {
      for (const StageCounters& counters : parse_technique(spec).render(trace, 0, {2}).stages) {
        const std::string place = spec + ' ' + std::string(name_of(counters.stage));
        EXPECT_NE(counters.stage.id, StageId::none) << spec;
        EXPECT_GT(counters.items_in, 0u) << place;
        EXPECT_GT(counters.items_out, 0u) << place;
        // Windows of one pair are not compared with what follows them.
        const std::uint64_t least = spec == "beam:order=sorted,window=one" ? 0 : 1;
        EXPECT_GE(counters.ops.total(), least) << place;
        EXPECT_GT(counters.bytes_read, 0u) << place;
        EXPECT_LE(counters.lanes_used, counters.lanes_issued) << place;
      }
    }
  }
}

}  // namespace beampipe::counters_test
