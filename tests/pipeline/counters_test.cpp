// Counters of frames that can be counted by hand.
#include <gtest/gtest.h>

#include <numeric>
#include <tuple>

#include "pipeline/technique.h"
#include "stages/data/sample_fragment.h"
#include "tests/pipeline/test_traces.h"

namespace beampipe {
namespace {

const StageCounters& stage(const FrameResult& result, const std::string& name) {
  for (const StageCounters& counters : result.stages)
    if (counters.stage == name) return counters;
  throw std::runtime_error("no stage " + name);
}

// The lower left half of the square [1, 5] x [1, 5], made a little smaller so that it does not merely touch pixels
// outside the square.
Trace half_square() {
  return pixel_trace(8, 8, {{{{1.25, 1.25, 0.5}, {4.75, 4.75, 0.5}, {1.25, 4.75, 0.5}}, glm::vec3(1)}});
}

TEST(Counters, BeamCountsEveryTouchedPixel) {
  const FrameResult result = parse_technique("beam").render(half_square(), 0, {1});
  // Rows 1 to 4 touch 1 + 1, 1 + 2, 1 + 3 and 4 pixels. The diagonal runs through corners of pixels, and a corner
  // belongs to the closed square of a pixel. Pairs without area are dropped after conservative_raster.
  const std::uint64_t touched = 1 + 2 + 3 + 4 + 3, with_area = 1 + 2 + 3 + 4;
  EXPECT_EQ(stage(result, "vertex_setup").items_in, 1u);
  EXPECT_EQ(stage(result, "vertex_setup").items_out, 1u);
  EXPECT_EQ(stage(result, "conservative_raster").items_in, 1u);
  EXPECT_EQ(stage(result, "conservative_raster").items_out, touched);
  // The triangle covers the whole of pixel (2, 3), so no fragment is made there.
  EXPECT_EQ(stage(result, "beam_fragment").items_in, touched - 1);
  EXPECT_EQ(stage(result, "beam_fragment").items_out, with_area - 1);
  EXPECT_EQ(stage(result, "shade").items_in, with_area);
  EXPECT_EQ(stage(result, "a_buffer").items_in, touched);
  EXPECT_EQ(stage(result, "compose").items_in, with_area);
  EXPECT_EQ(stage(result, "resolve").items_out, 64u);
  EXPECT_EQ(stage(result, "shade").lanes_issued, with_area);  // after visibility, without quads and helpers
  // The A-buffer has a triangle's number, a depth range and a 4-byte link for each pair, and a 4-byte head per pixel. A
  // fragment has 62 bytes: an aggregate of 42 bytes, the pixel, a plane and a centroid. Aggregates are read and written
  // once per window.
  EXPECT_EQ(result.a_buffer_peak_bytes, touched * 16 + 64 * 4);
  EXPECT_EQ(stage(result, "compose").bytes_read, (with_area - 1) * (62 + 42) + 16);
  EXPECT_EQ(stage(result, "compose").bytes_written, with_area * 42);
  // The published rules shade in quads. Pixels 1..4 lie in the quads 0, 1 and 2 of each axis. The lower left half of
  // these 3 x 3 quads has 6 quads of 4 lanes.
  EXPECT_EQ(stage(parse_technique("beam:rules=paper").render(half_square(), 0, {1}), "shade").lanes_issued, 4u * 6);
  const StageCounters merging = stage(parse_technique("beam:rules=paper").render(half_square(), 0, {1}), "compose");
  EXPECT_EQ(merging.items_in, with_area);
  EXPECT_EQ(merging.items_out, 64u) << "pixels";
  EXPECT_EQ(merging.bytes_read, with_area * 42);
  EXPECT_EQ(merging.bytes_written, 64u * 42);
  EXPECT_EQ(merging.lanes_used, with_area);
  EXPECT_EQ(merging.lanes_issued, with_area);
  // A fragment of the published rules is an aggregate. One of `alpha` has no mask and no depth slab, only a coverage, a
  // colour and a depth.
  EXPECT_EQ(parse_technique("beam:rules=paper").render(half_square(), 0, {1}).a_buffer_peak_bytes,
            with_area * 46 + 256);
  EXPECT_EQ(parse_technique("alpha").render(half_square(), 0, {1}).a_buffer_peak_bytes, with_area * 18 + 256);
}

TEST(Counters, Z3ReadsAndWritesAPixelForEachFragment) {
  const StageCounters merging = stage(parse_technique("z3").render(half_square(), 0, {1}), "compose");
  const std::uint64_t fragments = 1 + 2 + 3 + 4;
  EXPECT_EQ(merging.items_in, fragments);
  EXPECT_EQ(merging.items_out, fragments);
  EXPECT_EQ(merging.bytes_read, fragments * (26 + 50)) << "pixel, mask, plane, colour; three layers and their owners";
  EXPECT_EQ(merging.bytes_written, fragments * 50);
  EXPECT_EQ(merging.lanes_used, fragments);
  EXPECT_EQ(merging.lanes_issued, fragments);
}

TEST(Counters, DvmSelectsOutOfEightSamplesAPixel) {
  const StageCounters selecting = stage(parse_technique("dvm").render(half_square(), 0, {1}), "sample_select");
  EXPECT_EQ(selecting.items_in, 64u * 8);
  EXPECT_EQ(selecting.bytes_read, 64u * 8 * 4) << "a visibility id each";
  EXPECT_EQ(selecting.items_out, 64u) << "every pixel stores a sample";
  EXPECT_EQ(selecting.bytes_written, 64u * 9);
  EXPECT_EQ(selecting.lanes_issued, 64u);
}

TEST(Counters, MsaaCountsSamples) {
  const FrameResult one = parse_technique("msaa:1").render(half_square(), 0, {1});
  // Pixel centres (x + 1/2, y + 1/2) with x <= y and 1 <= x, y <= 4. Centres on the diagonal, which is a top right
  // edge, do not belong to the triangle.
  EXPECT_EQ(stage(one, "depth_test").items_in, 6u);
  EXPECT_EQ(stage(one, "depth_test").items_out, 6u);
  EXPECT_EQ(stage(one, "depth_test").bytes_written, 6u * 10);
  EXPECT_EQ(one.a_buffer_peak_bytes, 0u);
  const FrameResult eight = parse_technique("msaa:8").render(half_square(), 0, {1});
  EXPECT_EQ(stage(eight, "resolve").items_in, 64u * 8);
  EXPECT_GT(stage(eight, "depth_test").items_in, stage(one, "depth_test").items_in * 7);
}

// A fragment of msaa:8 moves to its centroid if the triangle does not cover the centre of the pixel. msaa:1 has a
// fragment wherever the centre is covered, and here msaa:8 has one in each of these pixels too. The pictures are the
// same because colours are flat.
TEST(Msaa, TheCentroidIsForFragmentsThatOneSampleMisses) {
  const StageCounters one = stage(parse_technique("msaa:1").render(half_square(), 0, {1}), "shade");
  const FrameResult centre = parse_technique("msaa:8,at=centre").render(half_square(), 0, {1});
  EXPECT_EQ(centre.pixel_counters.count("centroids"), 0u);
  for (const char* spec : {"msaa:8,at=centroid", "msaa:8,at=centroid,prepass"}) {
    const FrameResult centroid = parse_technique(spec).render(half_square(), 0, {1});
    EXPECT_EQ(centroid.image.rgba, centre.image.rgba) << spec;
    double moved = 0;
    for (const float count : centroid.pixel_counters.at("centroids")) moved += count;
    EXPECT_EQ(moved, static_cast<double>(stage(centre, "shade").items_in - one.items_in)) << spec;
    EXPECT_GT(moved, 0) << spec;
    EXPECT_GT(stage(centroid, "shade").ops.mul_add, stage(centre, "shade").ops.mul_add) << spec;
  }
}

TEST(Counters, ShadingRunsInWholeQuads) {
  const auto shading = [](const char* spec) {
    return stage(parse_technique(spec).render(half_square(), 0, {1}), "shade");
  };
  // The triangle covers the centres of the pixels (1, 2), (1, 3), (1, 4), (2, 3), (2, 4) and (3, 4), which lie in the
  // quads (0, 1), (0, 2), (1, 1) and (1, 2).
  for (const char* spec : {"msaa:1", "msaa:1,prepass", "deferred"}) {
    EXPECT_EQ(shading(spec).lanes_used, 6u) << spec;
    EXPECT_EQ(shading(spec).lanes_issued, 4u * 4) << spec;
  }
  EXPECT_EQ(shading("visibility").lanes_issued, 6u);
  // With eight samples, the four pixels on the diagonal are covered in part. They lie in two more of the
  // 3 x 3 quads.
  for (const char* spec : {"msaa:8", "msaa:8,prepass", "acaa:8"}) {
    EXPECT_EQ(shading(spec).lanes_used, 10u) << spec;
    EXPECT_EQ(shading(spec).lanes_issued, 6u * 4) << spec;
  }
}

TEST(Counters, AcaaReadsDepthTwiceAndOneColor) {
  const FrameResult msaa = parse_technique("msaa:8").render(half_square(), 0, {1});
  const FrameResult acaa = parse_technique("acaa:8").render(half_square(), 0, {1});
  const std::uint64_t samples = stage(msaa, "depth_test").items_in;
  EXPECT_EQ(stage(acaa, "depth_test").items_in, 2 * samples);
  EXPECT_EQ(stage(acaa, "depth_test").bytes_written, samples * 4);
  const std::uint64_t fragment_bytes = kSampleFragmentBytes + 6;  // including the shaded colour
  EXPECT_EQ(stage(acaa, "accumulate").items_in, 10u);
  EXPECT_EQ(stage(acaa, "accumulate").items_out, 10u);
  EXPECT_EQ(stage(acaa, "accumulate").bytes_read, 10 * (fragment_bytes + 8));
  EXPECT_EQ(stage(acaa, "accumulate").bytes_written, 10u * 8);
  // Saturation first adds the background to each pixel that is not full. Only pixel (2, 3) is full.
  const FrameResult saturated = parse_technique("acaa:8,double=saturate").render(half_square(), 0, {1});
  EXPECT_EQ(stage(saturated, "accumulate").items_in, 10u + 64 - 1);
  EXPECT_EQ(stage(saturated, "accumulate").bytes_read, 10 * fragment_bytes + (10 + 64 - 1) * 8 + 64 * 8 * 4);
  const StageCounters stencil =
      stage(parse_technique("acaa:8,double=stencil").render(half_square(), 0, {1}), "stencil_test");
  EXPECT_EQ(stencil.items_in, samples);
  EXPECT_EQ(stencil.items_out, samples);
  EXPECT_EQ(stencil.bytes_read, samples) << "one byte each";
  EXPECT_EQ(stencil.bytes_written, samples);
  EXPECT_EQ(stage(acaa, "resolve").bytes_read, 64u * 8);
  EXPECT_EQ(stage(msaa, "resolve").bytes_read, 64u * 8 * 6);
}

double sum_of(const FrameResult& result, const std::string& counter) {
  const std::vector<float>& values = result.pixel_counters.at(counter);
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(Counters, EveryTechniqueCountsFragmentsAndBytesOfPixels) {
  const Trace trace = random_trace(40, 30, 400, 2);
  for (const char* spec : {"beam", "beam:order=stream", "beam:rules=paper", "alpha", "z3", "msaa:8", "msaa:32",
                           "acaa:8", "deferred", "visibility", "taa:4", "dvm"}) {
    const FrameResult result = parse_technique(spec).render(trace, 0, {2});
    EXPECT_GT(sum_of(result, "fragments"), 400) << spec;
    EXPECT_GT(sum_of(result, "bytes"), 400) << spec;
  }
}

// A triangle counts once, however many passes there are.
TEST(Counters, FragmentsOfAPixelAreThoseOfTheFirstPass) {
  const Trace trace = random_trace(40, 30, 400, 2);
  const FrameResult all = parse_technique("beam:order=stream,layers=1").render(trace, 0, {2});
  const FrameResult first = parse_technique("beam:order=stream,layers=1,passes=1").render(trace, 0, {2});
  EXPECT_EQ(all.pixel_counters.at("fragments"), first.pixel_counters.at("fragments"));
  EXPECT_GT(sum_of(all, "passes"), sum_of(first, "passes"));
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
  const FrameResult apart = parse_technique("beam").render(corners(0.1), 0, {1});
  EXPECT_EQ(at(apart, "fragments"), 5);
  EXPECT_EQ(at(apart, "merges"), 5);
  EXPECT_EQ(at(apart, "tiny_triangles"), 1);
  EXPECT_EQ(at(apart, "largest_window"), 1);
  EXPECT_EQ(at(parse_technique("beam").render(corners(0), 0, {1}), "largest_window"), 4);
  EXPECT_EQ(at(parse_technique("alpha").render(corners(0.1), 0, {1}), "merges"), 5);
  EXPECT_EQ(at(parse_technique("z3").render(corners(0.1), 0, {1}), "merges"), 1) << "four owners, three layers";
  EXPECT_EQ(at(parse_technique("beam:order=stream,layers=1").render(corners(0.1), 0, {1}), "passes"), 4);
  EXPECT_EQ(at(parse_technique("beam:order=stream").render(corners(0.1), 0, {1}), "passes"), 1) << "room for five";
  const FrameResult acaa = parse_technique("acaa:8").render(corners(0.1), 0, {1});
  EXPECT_EQ(at(acaa, "visible_fragments"), at(parse_technique("msaa:8").render(corners(0.1), 0, {1}), "fragments"))
      << "nothing is hidden";
}

// The bytes of all pixels add up to those of the stages: what depth tests read and write, and what is written of
// shading samples, the G-buffer and the colour.
TEST(Counters, PixelsAddUpToStages) {
  const Trace trace = random_trace(40, 30, 400, 2);
  for (const char* spec : {"msaa:8", "visibility", "taa:4", "deferred", "dvm"}) {
    const FrameResult result = parse_technique(spec).render(trace, 0, {2});
    const std::uint64_t fragments = stage(result, "sample_raster").items_out;
    std::uint64_t bytes = stage(result, "depth_test").logical_bytes() - fragments * kSampleFragmentBytes;
    for (const StageCounters& counters : result.stages) {
      if (counters.stage == "sample_select" || counters.stage == "light") bytes += counters.bytes_written;
      if (counters.stage == "shade" && std::string(spec) != "msaa:8") bytes += counters.bytes_written;
    }
    EXPECT_EQ(sum_of(result, "bytes"), bytes) << spec;
    if (std::string(spec) == "deferred") continue;  // its fragments come twice, once for each pass
    EXPECT_EQ(sum_of(result, "fragments"), fragments) << spec;
  }
}

// Every pixel is read in its stored format and written as fp16 RGB. Both surfaces are contiguous in memory.
TEST(Counters, ResolveReadsEveryPixelOnce) {
  const Trace trace = random_trace(64, 32, 400, 2);
  RunOptions raw{2};
  raw.memory.compression = false;
  for (const auto& [spec, items, stored_bytes] : {std::tuple{"beam", 1u, 42u},
                                                  {"beam:rules=paper", 1u, 42u},
                                                  {"beam:order=stream", 1u, 8u},
                                                  {"alpha", 1u, 10u},
                                                  {"z3", 1u, 50u},
                                                  {"msaa:8", 8u, 48u},
                                                  {"msaa:32", 32u, 192u},
                                                  {"acaa:8", 1u, 8u},
                                                  {"visibility", 1u, 6u}}) {
    const StageCounters resolving = stage(parse_technique(spec).render(trace, 0, raw), "resolve");
    EXPECT_EQ(resolving.items_in, 64u * 32 * items) << spec;
    EXPECT_EQ(resolving.items_out, 64u * 32) << spec;
    EXPECT_EQ(resolving.bytes_read, 64u * 32 * stored_bytes) << spec;
    EXPECT_EQ(resolving.bytes_written, 64u * 32 * 6) << spec;
    EXPECT_EQ(resolving.lanes_used, resolving.items_in) << spec;
    EXPECT_EQ(resolving.lanes_issued, resolving.items_in) << spec;
    EXPECT_GE(resolving.sector_bytes, resolving.logical_bytes()) << spec;
    EXPECT_LE(resolving.sector_bytes, resolving.logical_bytes() * 105 / 100) << spec << ": 50 bytes lie across sectors";
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
  for (const auto& [spec, raster, passes] : {std::tuple{"beam", "conservative_raster", 1u},
                                             {"beam:order=stream", "conservative_raster", 1u},
                                             {"msaa:8", "sample_raster", 1u},
                                             {"deferred", "sample_raster", 2u}}) {
    const StageCounters found = stage(parse_technique(spec).render(trace, 0, {2}), raster);
    EXPECT_EQ(found.empty_tiles, passes) << spec;
    EXPECT_EQ(found.hidden_triangles, 2u * passes) << spec;
    EXPECT_EQ(found.hidden_items, 8u * passes) << spec << ": of the second tile";
  }
  const StageCounters super = stage(parse_technique("msaa:32").render(trace, 0, {2}), "sample_raster");
  EXPECT_EQ(super.hidden_items, 16u) << "a pixel has 2 x 2 cells, and the triangle is in the upper ones";
  EXPECT_EQ(stage(parse_technique("z3").render(trace, 0, {2}), "conservative_raster").hidden_items, 0u);
}

TEST(Counters, EveryStageWorks) {
  Trace trace = random_trace(40, 30, 50, 2);
  trace.frames[0].draws[0].shading = Shading::lambert;  // an unlit triangle needs no operations
  trace.frames[0].light_direction = glm::vec3(0, 0, 1);
  for (const char* spec : {"beam", "alpha", "msaa:4", "msaa:4,prepass", "acaa:4,double=stencil", "acaa:32", "deferred",
                           "visibility", "taa:8", "dvm", "reference"}) {
    for (const StageCounters& counters : parse_technique(spec).render(trace, 0, {2}).stages) {
      EXPECT_FALSE(counters.stage.empty()) << spec;
      EXPECT_GT(counters.items_in, 0u) << spec << ' ' << counters.stage;
      EXPECT_GT(counters.items_out, 0u) << spec << ' ' << counters.stage;
      EXPECT_GT(counters.ops.total(), 0u) << spec << ' ' << counters.stage;
      EXPECT_GT(counters.bytes_read, 0u) << spec << ' ' << counters.stage;
      EXPECT_LE(counters.lanes_used, counters.lanes_issued) << spec << ' ' << counters.stage;
    }
  }
}

}  // namespace
}  // namespace beampipe
