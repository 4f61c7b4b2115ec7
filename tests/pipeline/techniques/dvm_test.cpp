// Decoupled visibility multisampling.

#include <glm/gtc/matrix_transform.hpp>

#include "tests/pipeline/techniques/render_frames.h"
#include "traces/files/trace_io.h"

namespace beampipe::dvm_test {

// A horizontal white bar, `thick` pixels high, on black.
Trace bar(double thick) { return pixel_trace(32, 16, quad(0, 8.1, 32, 8.1 + thick, 0.5, glm::vec3(1))); }

double mean_red(const Image& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) sum += image.rgba[i];
  return sum / static_cast<double>(image.rgba.size() / 4);
}

void add_draw(Trace& trace, const std::vector<PixelSpaceTriangle>& triangles) {
  trace.frames[0].draws.emplace_back().mesh = static_cast<std::uint32_t>(trace.meshes.size());
  trace.meshes.push_back(pixel_trace(1, 1, triangles).meshes[0]);
}

// A frame of `after` that follows eight frames of `before`.
Image after_eight(const Trace& before, const Trace& after, const std::string& spec = "dvm") {
  const Technique technique = parse_technique(spec);
  History history;
  for (int i = 0; i < 8; ++i) technique.render(before, 0, {1, &history});
  return technique.render(after, 0, {1, &history}).image;
}

// It looks as if it were the first.
void expect_no_ghost(const Trace& before, const Trace& after, const char* what) {
  EXPECT_LT(worst_difference(after_eight(before, after), picture("dvm", after)), 2e-3) << what;
}

// 5 x 3 pixels have 3 x 2 quads. Columns 0 and 1 show the background alone, columns 2 and 3 six materials and the
// background in row 0, and column 4, whose quads have one column, a material and the background in row 0.
TEST(Dvm, QuadsAreCountedByTheirMaterials) {
  std::vector<PixelSpaceTriangle> triangles;
  for (int i = 0; i < 6; ++i) {
    const double x = 2 + i / 3, y = 0.3 * (i % 3);
    append(triangles, quad(x, y, x + 1, y + 0.3, 0.5, glm::vec3(0.1f * static_cast<float>(i + 1))));
  }
  append(triangles, quad(4, 0, 5, 0.5, 0.5, glm::vec3(1)));
  const FrameResult found = render("dvm", pixel_trace(5, 3, triangles));
  const auto at = [&](const std::string& counter) {
    std::string pixels;
    for (const float value : found.pixel_counters.at(counter)) pixels += value == 1 ? '1' : '0';
    return pixels;
  };
  const std::string none(15, '0');
  EXPECT_EQ(at("quads_of_1"), "110001100011111");
  EXPECT_EQ(at("quads_of_2"), "000010000100000");
  EXPECT_EQ(at("quads_of_3"), none);
  EXPECT_EQ(at("quads_of_4"), none);
  EXPECT_EQ(at("quads_of_5_or_more"), "001100011000000");
  EXPECT_EQ(at("partial_quads"), "000010000111111");
  EXPECT_EQ(stage_of(found, "material_sort").items_in, 4u * 6) << "four shading samples for each quad";
}

// A draw that stood still jumps or starts to move. Nothing of it is left in its old place.
TEST(Dvm, WhatLeavesItsRestLeavesNoTrail) {
  for (const double step : {10.0, 2.0}) {
    const Trace before = pixel_trace(24, 8, quad(4, -4, 8, 20, 0.5, glm::vec3(1)));
    Trace after = before;
    after.frames[0].draws[0].transform[3][0] = step;
    const Image image = after_eight(before, after);
    for (std::uint32_t x = 0; x < 24; ++x)
      EXPECT_NEAR(red(image, x, 4), x >= 4 + step && x < 8 + step ? 1 : 0, 2e-3) << step << ' ' << x;
  }
}

// A square jumps by ten pixels under a still camera. The article's rule keeps the old place: nine tenths of it, as T is
// one tenth. A pixel that was black in all frames has no deviation, so that the whole clamp removes the square there.
TEST(Dvm, AStillCameraKeepsTheGhostOfWhatMoves) {
  const Trace before = pixel_trace(24, 8, quad(4, -4, 8, 20, 0.5, glm::vec3(1)));
  Trace after = before;
  after.frames[0].draws[0].transform[3][0] = 10;
  const Image ghost = after_eight(before, after, "dvm:clamp=camera"),
              clean = after_eight(before, after, "dvm:clamp=variance");
  for (std::uint32_t x = 0; x < 24; ++x) {
    const bool was = x >= 4 && x < 8, is = x >= 14 && x < 18;
    EXPECT_NEAR(red(ghost, x, 4), was ? 0.9 : is ? 1 : 0, 2e-3) << x;
    EXPECT_NEAR(red(clean, x, 4), is ? 1 : 0, 2e-3) << x;
  }
  // Once the camera moves, by 0.05 pixel in the first frame, the ghost is gone.
  after.frames[0].view[3][0] = 0.0625;
  const Image moved = after_eight(before, after, "dvm:clamp=camera");
  for (std::uint32_t x = 4; x < 8; ++x) EXPECT_NEAR(red(moved, x, 4), 0, 2e-3) << x;
}

// A still quad of six materials: in each frame two of them have no sample, each time others. So the value of its pixels
// varies. What the whole clamp forgets, the others remember.
TEST(Dvm, VarianceKeepsWhatItHasSeenVary) {
  std::vector<PixelSpaceTriangle> triangles;
  for (int i = 0; i < 6; ++i)
    append(triangles, quad(i / 3.0, 0, (i + 1) / 3.0, 2, 0.5, glm::vec3(i % 2 == 0 ? 1.0f : 0.0f)));
  const Trace trace = pixel_trace(2, 2, triangles);
  // How much the first pixel changes from frame to frame, once it has seen eight frames.
  const auto flicker = [&](const char* spec) {
    const Technique technique = parse_technique(spec);
    History history;
    double sum = 0, last = 0;
    for (int i = 0; i < 40; ++i) {
      const double now = red(technique.render(trace, 0, {1, &history}).image, 0, 0);
      if (i >= 8) sum += std::abs(now - last);
      last = now;
    }
    return sum / 32;
  };
  EXPECT_EQ(flicker("dvm:clamp=camera"), flicker("dvm")) << "nothing moves or changes";
  EXPECT_LT(flicker("dvm"), 0.1) << "at most T of the colours' range";
  EXPECT_LT(flicker("dvm:clamp=variance"), 0.1);
}

// Six stripes of 1/3 px, each of its own material. Samples at a jitter position show two of them, for both columns of
// pixels have it at the same place. So four extra samples make the picture complete in the first frame.
TEST(Dvm, ExtraSamplesShowSixMaterialsAtOnce) {
  std::vector<PixelSpaceTriangle> triangles;
  for (int i = 0; i < 6; ++i)
    append(triangles, quad(i / 3.0, 0, (i + 1) / 3.0, 2, 0.5, glm::vec3(static_cast<float>(i * 5 % 6) / 8.0f)));
  const Trace trace = pixel_trace(2, 2, triangles);
  const Image truth = render_frames("msaa:8", trace, 1);
  EXPECT_GT(worst_difference(render_frames("dvm", trace, 1), truth), 0.05);
  for (const char* spec : {"dvm:extra=4", "dvm:extra=28"}) {
    const FrameResult found = render(spec, trace);
    EXPECT_LT(worst_difference(found.image, truth), 0x1p-11) << spec;
    EXPECT_EQ(found.pixel_counters.at("unknown"), std::vector<float>(4, 0)) << spec;
    for (const char* stage : {"shade", "light"}) EXPECT_EQ(stage_of(found, stage).lanes_used, 8u) << spec << stage;
    EXPECT_EQ(stage_of(found, "material_sort").items_in, 8u) << spec;
  }
  const auto used = [&](const char* spec) {
    const std::vector<float> by_pixel = render(spec, trace).pixel_counters.at("bytes");
    return std::accumulate(by_pixel.begin(), by_pixel.end(), 0.0f);
  };
  EXPECT_EQ(used("dvm:extra=4") - used("dvm"), 4 * (4 + 4 + 1 + 8 + 6));
  const auto bytes = [](const char* spec) { return parse_technique(spec).framebuffer_bytes_per_pixel(); };
  EXPECT_EQ(bytes("dvm:extra=4") - bytes("dvm"), 4 + 4 + 1 + 8 + 6) << "one for each pixel";
  EXPECT_EQ(bytes("dvm:extra=28") - bytes("dvm"), 7 * (4 + 4 + 1 + 8 + 6));
}

// Rest needs a speed and two looks, the camera a speed, variance two deviations of four channels.
TEST(Dvm, TheClampsHistoryIsInTheFramebuffer) {
  const auto bytes = [](const char* spec) { return parse_technique(spec).framebuffer_bytes_per_pixel(); };
  EXPECT_EQ(bytes("dvm") - bytes("dvm:clamp=camera"), 2 * 4);
  EXPECT_EQ(bytes("dvm:clamp=variance") - bytes("dvm:clamp=camera"), 2 * 4 * 2 - 2);
}

// Nothing moves, but colours change, so the history must be rejected.
TEST(Dvm, WhatChangesItsLookLeavesNoGhost) {
  Trace lit = pixel_trace(24, 16, quad(4.3, 3.2, 15.6, 11.9, 0.5, glm::vec3(0.75f)), glm::vec3(0.125f));
  lit.meshes.push_back(lit.meshes[0]);
  for (glm::vec3& color : lit.meshes[1].colors) color = glm::vec3(0.25f, 0.5f, 0.0f);
  lit.frames[0].draws[0].shading = Shading::lambert;
  lit.frames[0].lighting.lights = {{glm::vec3(0, 0, 1)}};
  const auto change = [&](const char* what, const std::function<void(Frame&)>& edit) {
    Trace changed = lit;
    edit(changed.frames[0]);
    expect_no_ghost(lit, changed, what);
  };
  const Lighting grazing{{{glm::normalize(glm::vec3(1, 0, 0.25f))}}, {}};
  change("light", [&](Frame& frame) { frame.lighting = grazing; });
  change("Kd", [](Frame& frame) { frame.draws[0].kd = glm::vec3(0, 1, 0); });
  change("background", [](Frame& frame) { frame.background = glm::vec3(1, 0, 0.5f); });
  change("mesh", [](Frame& frame) { frame.draws[0].mesh = 1; });
  lit.frames[0].lighting = grazing;
  change("shading", [](Frame& frame) { frame.draws[0].shading = Shading::unlit; });
}

// A lit square turns in place by 3 degrees per frame and then stops. In every frame it has the shade of that frame, not
// of earlier ones.
TEST(Dvm, WhatTurnsUnderTheLightLeavesNoGhost) {
  Trace trace = pixel_trace(24, 16, quad(-8, -4, 8, 4, 0, glm::vec3(1)));
  Frame& frame = trace.frames[0];
  frame.projection[2][2] = 1.0 / 16, frame.projection[3][2] = 0;  // depth range for a square that is seen edge-on
  frame.draws[0].shading = Shading::lambert;
  frame.lighting.lights = {{glm::normalize(glm::vec3(1, 0, 1))}};
  const glm::dmat4 middle = glm::translate(glm::dmat4(1.0), glm::dvec3(12, 8, 0));
  const Technique technique = parse_technique("dvm"), truth = parse_technique("msaa:8");
  History history;
  for (int i = 0; i < 20; ++i) {
    frame.draws[0].transform = glm::rotate(middle, glm::radians(3.0 * std::min(i, 14)), glm::dvec3(0, 1, 0));
    const Image found = technique.render(trace, 0, {1, &history}).image, exact = truth.render(trace, 0, {1}).image;
    EXPECT_LT(std::abs(red(found, 12, 8) - red(exact, 12, 8)), 2e-3) << i;
    EXPECT_LT(worst_difference(found, exact), 4e-3) << i;
  }
}

// The same for pixels with no sample in any shading sample's mask: a quad has 16 draws, of which 12 remain unknown.
TEST(Dvm, WhatIsUnknownKeepsNoGhost) {
  Trace before = pixel_trace(2, 2, {});
  for (int i = 0; i < 16; ++i) {
    const double x = i % 4 / 2.0, y = i / 4 / 2.0;
    add_draw(before, quad(x, y, x + 0.5, y + 0.5, 0.5, glm::vec3(1)));
  }
  Trace after = before;
  for (Draw& draw : after.frames[0].draws) draw.kd = glm::vec3(0.25f);
  expect_no_ghost(before, after, "Kd");
}

// A square moves by one pixel per frame behind wires that stand still and cover their pixels only in part. Then it
// stops.
TEST(Dvm, WhatPassesBehindAStillSilhouetteLeavesNoTrail) {
  std::vector<PixelSpaceTriangle> wires;
  for (const double x : {6.1, 13.4, 20.7}) append(wires, quad(x, -4, x + 0.2, 20, 0.25, glm::vec3(0.5f, 0.25f, 0)));
  Trace trace = pixel_trace(32, 16, wires);
  add_draw(trace, quad(0, 4, 6, 10, 0.5, glm::vec3(1)));
  const Technique technique = parse_technique("dvm"), truth = parse_technique("msaa:8");
  History history;
  for (int i = 0; i < 30; ++i) {
    trace.frames[0].draws[1].transform[3][0] = std::min(i, 20);
    const Image found = technique.render(trace, 0, {1, &history}).image;
    EXPECT_LT(worst_difference(found, truth.render(trace, 0, {1}).image), 4e-3) << i;
  }
}

TEST(Dvm, ABarThinnerThanAPixelVanishesUnderTaaOnly) {
  const Trace trace = bar(0.2);  // covers one of the eight jitter positions
  const double truth = mean_red(render_frames("reference", trace, 1));
  const double msaa = mean_red(render_frames("msaa:8", trace, 1));
  ASSERT_NEAR(truth, 0.2 / 16, 1e-3);
  EXPECT_NEAR(mean_red(render_frames("dvm", trace, 1)), msaa, 1e-6);
  for (const char* spec : {"dvm", "dvm:clamp=camera", "dvm:clamp=variance"})
    EXPECT_NEAR(mean_red(render_frames(spec, trace, 60)), msaa, 1e-3) << spec << ", whatever fades the clamp";
  // Each jitter cycle hits the bar once. That frame adds T of its colour, which the next frame clamps away, so the
  // average is T / 8.
  const Technique taa = parse_technique("taa:8");
  History history;
  double sum = 0;
  for (int i = 0; i < 64; ++i) {
    const double seen = mean_red(taa.render(trace, 0, {1, &history}).image);
    if (i < 8) continue;
    sum += seen / 56;
    EXPECT_TRUE(seen < 1e-6 || std::abs(seen - 0.1 / 16) < 1e-4) << seen;
  }
  EXPECT_NEAR(sum, 0.1 / 16 / 8, 1e-4);
}

// Slightly slanted bars, 1.5, 0.5 and 0.2 pixels thick, lie around the rows 6, 18 and 30. The camera stands still.
TEST(Dvm, KeepsTheBarsOfTheSampleThatTaaLoses) {
  const Trace trace = read_trace(std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/samples/thin_bars.json");
  // The red that a bar adds to the background, summed over its pixels.
  const auto light = [&](const Image& image, std::uint32_t bar) {
    double sum = 0;
    for (std::uint32_t y = 12 * bar; y < 12 * bar + 12; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) sum += red(image, x, y) - trace.frames[0].background.r;
    return sum;
  };
  const Image truth = render_frames("reference", trace, 1);
  const auto share_kept = [&](const std::string& spec, std::uint32_t bar) {  // averaged over the last jitter cycle
    const Technique technique = parse_technique(spec);
    History history;
    double sum = 0;
    for (std::size_t i = 0; i < trace.frames.size(); ++i) {
      const Image image = technique.render(trace, i, {1, &history}).image;
      if (i + 8 >= trace.frames.size()) sum += light(image, bar) / 8;
    }
    return sum / light(truth, bar);
  };
  for (std::uint32_t bar = 0; bar < 3; ++bar) EXPECT_NEAR(share_kept("dvm", bar), 1, 0.02) << bar;
  EXPECT_GT(share_kept("taa:8", 0), 0.9);
  EXPECT_LT(share_kept("taa:8", 1), 0.7);
  EXPECT_LT(share_kept("taa:8", 2), 0.3);
}

// A hut moves in front of another one. The camera stands still.
TEST(Dvm, WhatMovesUnderAStillCameraLeavesNoTrail) {
  const Trace trace = read_trace(std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/samples/passing_huts.json");
  const Technique technique = parse_technique("dvm"), truth = parse_technique("msaa:64");
  History history;
  for (std::size_t i = 0; i < trace.frames.size(); ++i) {
    const Image found = technique.render(trace, i, {1, &history}).image;
    EXPECT_LT(rmse(found, truth.render(trace, i, {1}).image), 0.02) << i;
  }
}

TEST(Dvm, TheFirstFrameIsMsaaWhereMaterialsAreFew) {
  // Each material has a single colour, so the picture depends on nothing but the masks.
  std::vector<PixelSpaceTriangle> triangles = quad(2.3, 3.1, 17.7, 20.9, 0.5, glm::vec3(0.25f, 0.5f, 0.75f));
  triangles.push_back({{{5, 1, 0.3}, {29, 9, 0.4}, {11, 27, 0.2}}, glm::vec3(1.0f, 0.5f, 0.125f)});
  for (const std::uint32_t size : {32u, 31u}) {  // with an odd size, quads extend beyond the frame
    const Trace trace = pixel_trace(size, size, triangles, glm::vec3(0.125f, 0.25f, 0.5f));
    const Image truth = render_frames("msaa:8", trace, 1);
    EXPECT_LT(worst_difference(render_frames("dvm", trace, 1), truth), 0x1p-11) << size;
    EXPECT_LT(worst_difference(render_frames("dvm", trace, 20), truth), 0x1p-8) << size;
  }
}

TEST(Dvm, PastFourMaterialsTimeMakesUpForWhatIsMissing) {
  // Eight columns of 1/4 px in one quad, each with its own material.
  std::vector<PixelSpaceTriangle> triangles;
  const auto value = [](int i) { return static_cast<float>(i * 5 % 8) / 8.0f; };
  for (int i = 0; i < 8; ++i) append(triangles, quad(i / 4.0, 0, (i + 1) / 4.0, 2, 0.5, glm::vec3(value(i))));
  const Trace trace = pixel_trace(2, 2, triangles);
  const FrameResult first = parse_technique("dvm").render(trace, 0, {1});
  double unknown = 0;
  for (const float part : first.pixel_counters.at("unknown")) unknown += part / 4;
  EXPECT_GT(unknown, 0.3);  // half of the materials, and so about half of the samples, have no shading sample
  EXPECT_LT(unknown, 0.7);
  const Image truth = render_frames("msaa:8", trace, 1), late = render_frames("dvm:blend=0.02", trace, 400);
  for (std::uint32_t x = 0; x < 2; ++x)
    EXPECT_NEAR((red(late, x, 0) + red(late, x, 1)) / 2, red(truth, x, 0), 0.08) << x;
}

TEST(Dvm, MaterialByDrawSpreadsAcrossColors) {
  // One draw has two colours side by side in a pixel. With material=draw they are one material, and the pixel gets the
  // colour of one sample.
  std::vector<PixelSpaceTriangle> triangles = quad(0, 0, 0.5, 2, 0.5, glm::vec3(1));
  append(triangles, quad(0.5, 0, 2, 2, 0.5, glm::vec3(0)));
  const Trace trace = pixel_trace(2, 2, triangles);
  EXPECT_NEAR(red(render_frames("dvm", trace, 1), 0, 0), 0.5, 1e-6);
  const double by_draw = red(render_frames("dvm:material=draw", trace, 1), 0, 0);
  EXPECT_TRUE(by_draw == 0 || by_draw == 1) << by_draw;
}

}  // namespace beampipe::dvm_test
