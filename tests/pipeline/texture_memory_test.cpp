// Texels in the modelled memory: caches, hand-worked frames, and what they do not depend on.
#include "pipeline/memory/texture_memory.h"

#include "pipeline/bins/frame_context.h"
#include "pipeline/memory/geometry_memory.h"
#include "pipeline/technique_table.h"
#include "stages/data/sample_fragment.h"
#include "tests/pipeline/test_pictures.h"
#include "traces/scenes.h"

namespace beampipe::texture_memory_test {

TextureImage square_image(std::uint32_t size) {
  TextureImage image{"image", size, size, {}};
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x)
      image.texels.emplace_back(x * 37 % 256, y * 91 % 256, (x + y) * 53 % 256, (x ^ y) % 3 ? 255 : 0);
  return image;
}

// The triangles of a pixel trace with an unlit texture of size x size texels; `texels` of them per pixel.
Trace textured(Trace trace, std::uint32_t size, double texels) {
  trace.images = {square_image(size)};
  trace.materials.resize(1);
  trace.materials[0].base_texture = Texture{};
  trace.materials[0].unlit = trace.materials[0].double_sided = true;
  Mesh& mesh = trace.meshes[0];
  mesh.materials.assign(mesh.triangles.size(), 0);
  for (const glm::vec3& position : mesh.positions)
    mesh.uvs[0].push_back(glm::vec2(glm::dvec2(position) * (texels / size)));
  return trace;
}

Trace textured_frame(std::uint32_t pixels, std::uint32_t size, double texels) {
  return textured(pixel_trace(pixels, pixels, quad(0, 0, pixels, pixels, 0.5, glm::vec3(1))), size, texels);
}

// One triangle that covers the whole of a frame of 2 x 2 pixels.
Trace textured_quad(double texels) {
  return textured(pixel_trace(2, 2, {{{{-1, -1, 0.5}, {8, -1, 0.5}, {-1, 8, 0.5}}, glm::vec3(1)}}), 16, texels);
}

// Cutouts, translucent and opaque triangles with the same texture, which L2 may not hold as a whole.
Trace mixed_trace() {
  Trace trace = textured(random_trace(70, 40, 120, 5), 64, 1.5);
  trace.materials.resize(3, trace.materials[0]);
  trace.materials[1].alpha_mode = AlphaMode::mask;
  trace.materials[2].alpha_mode = AlphaMode::blend;
  for (std::size_t i = 0; i < trace.meshes[0].materials.size(); ++i)
    trace.meshes[0].materials[i] = i % 4 == 3 ? kNoMaterial : static_cast<std::uint32_t>(i % 4);
  return trace;
}

std::vector<StageCounters> stages_of(const std::string& spec, const Trace& trace, const FrameInput& run = {}) {
  return parse_technique(spec).render(trace, 0, run).stages;
}

StageCounters stage_of(const char* spec, const Trace& trace, const std::string& name, const FrameInput& run = {}) {
  return beampipe::stage_of(parse_technique(spec).render(trace, 0, run), name);
}

StageCounters shade_of(const char* spec, const Trace& trace) { return stage_of(spec, trace, "shade"); }

TEST(TextureMemory, L2ServesBinsPassByPass) {
  MemoryParameters memory;
  memory.l2 = {128, 1, 128};  // one line
  const TextureRead a{.line = 7, .stage = 0, .sectors = 0b0001}, b{.line = 7, .stage = 1, .sectors = 0b0011};
  const TextureRead c{.line = 8, .stage = 1, .sectors = 0b1111};
  const auto by_stage = [&](const std::vector<TexturePasses>& bins) {
    const auto bytes = texture_dram_bytes(memory, bins);
    return std::vector<std::uint64_t>{bytes[0], bytes[1]};
  };
  EXPECT_EQ(by_stage({{{a, b}}, {{b}}}), (std::vector<std::uint64_t>{32, 32}));
  EXPECT_EQ(by_stage({{{b}}, {{a, b}}}), (std::vector<std::uint64_t>{0, 64}));
  EXPECT_EQ(by_stage({{{a}, {c}}, {{a}, {c}}}), (std::vector<std::uint64_t>{32, 128}));
  EXPECT_EQ(by_stage({{{a, c}}, {{a, c}}}), (std::vector<std::uint64_t>{64, 256}));
}

// Half a texel per pixel: one bilinear probe. 1.5 texels: two levels of four texels each.
TEST(TextureMemory, CountsTheTexelsOfEachInvocation) {
  EXPECT_EQ(shade_of("visibility", textured_frame(16, 8, 0.5)).texture_bytes, 256u * 4 * 4);
  EXPECT_EQ(shade_of("visibility", textured_frame(16, 64, 1.5)).texture_bytes, 256u * 8 * 4);
  EXPECT_EQ(shade_of("dvm", textured_frame(16, 8, 0.5)).texture_bytes, 256u * 4 * 4);
  Trace nearest = textured_frame(16, 8, 0.5);
  nearest.materials[0].base_texture->magnify = Filter::nearest;
  EXPECT_EQ(shade_of("visibility", nearest).texture_bytes, 256u * 4);
  for (const char* const spec : {"beam", "beam:order=sorted", "beam:order=stream"})
    EXPECT_EQ(shade_of(spec, textured_frame(64, 8, 0.5)).texture_bytes, 64 * 64 * 4 * 4 + 64u * 4 * 4)
        << spec << ": two triangles meet in the pixels of the diagonal";
}

// Texels 0 and 1, in x and y, which are those of all four pixels, lie in the first sector.
TEST(TextureMemory, AQuadAsksForASectorOnce) {
  Trace trace = textured_quad(0.2);
  for (glm::vec2& uv : trace.meshes[0].uvs[0]) uv += glm::vec2(1.0f / 16);
  for (const char* const spec : {"deferred", "msaa:4", "acaa:4", "z3"}) {
    const StageCounters quads = shade_of(spec, trace);
    EXPECT_EQ(quads.texture_bytes, 4 * 4 * 4u) << spec;
    EXPECT_EQ(quads.texture_sector_bytes, 32u) << spec;
  }
  const StageCounters pixels = shade_of("visibility", trace);
  EXPECT_EQ(pixels.texture_bytes, 4 * 4 * 4u);
  EXPECT_EQ(pixels.texture_sector_bytes, 4 * 32u);
  EXPECT_EQ(pixels.texture_l2_bytes, 32u);
  EXPECT_EQ(pixels.texture_dram_bytes, 32u);
  trace.materials[0].alpha_mode = AlphaMode::blend;
  trace.frames[0].draws[0].state.blend = Blend{{BlendFactor::one, BlendFactor::one}, {}, {}};
  const StageCounters in_order = shade_of("beam", trace);
  EXPECT_EQ(in_order.texture_bytes, 4 * 4 * 4u) << "in the API's order";
  EXPECT_EQ(in_order.texture_sector_bytes, 4 * 32u);
}

// A triangle of one pixel. Techniques with derivatives of the quad shade its four pixels.
TEST(TextureMemory, HelperInvocationsReadTexels) {
  const Trace trace =
      textured(pixel_trace(4, 4, {{{{0.1, 0.1, 0.5}, {0.9, 0.1, 0.5}, {0.5, 0.95, 0.5}}, glm::vec3(1)}}), 16, 0.2);
  for (const char* const spec : {"deferred", "msaa:4", "acaa:4"})
    EXPECT_EQ(shade_of(spec, trace).texture_bytes, 4 * 4 * 4u) << spec;
  for (const char* const spec : {"visibility", "beam", "z3"})
    EXPECT_EQ(shade_of(spec, trace).texture_bytes, 4 * 4u) << spec;
}

// 8 x 8 texels are two lines. Each of the 16 bins reads them through its own L1, but L2 fetches them once.
TEST(TextureMemory, ATextureThatFitsIsFetchedOnce) {
  Trace trace = textured_frame(128, 8, 0.5);
  for (const char* const spec : {"beam", "msaa:4", "visibility"}) {
    const StageCounters shade = shade_of(spec, trace);
    EXPECT_EQ(shade.texture_l2_bytes, 16 * 256u) << spec;
    EXPECT_EQ(shade.texture_dram_bytes, 256u) << spec;
  }
}

TEST(TextureMemory, ReadingAlphaIsChargedToItsStage) {
  Trace trace = textured_frame(16, 8, 0.5);
  trace.materials[0].alpha_mode = AlphaMode::mask;
  const StageCounters test = stage_of("visibility", trace, "alpha_test");
  EXPECT_EQ(test.texture_bytes, 256u * 4 * 4);
  EXPECT_EQ(test.texture_dram_bytes, 256u);
  trace.images[0].texels[0].a = 0;  // so that no pixel is known as a whole where the texel is near
  for (const char* const spec : {"beam", "beam:alpha=256"}) {
    const StageCounters mask = stage_of(spec, trace, "alpha_mask");
    // Tested alpha and, where it does not tell, the texture. On two axes, two of eight texels are near the first one.
    EXPECT_EQ(mask.texture_dram_bytes, 512u) << spec;
    EXPECT_GT(mask.texture_bytes, 256u * 4 * 4 + (spec == std::string("beam") ? 16 : 256) * 4u * 4 * 4 * 4) << spec;
  }
  EXPECT_EQ(stage_of("beam", trace, "shade").texture_dram_bytes, 0u) << "L2 holds what alpha_mask has fetched";
}

// Texels are parts of the totals. Without a model, only logical bytes are counted.
TEST(TextureMemory, TexelsArePartsOfTheTotals) {
  const Trace trace = mixed_trace();
  FrameInput off;
  off.memory.modelled = false;
  for (const std::string& spec : example_specs()) {
    std::vector<StageCounters> stages = stages_of(spec, trace);
    for (StageCounters& stage : stages) {
      EXPECT_LE(stage.texture_bytes, stage.bytes_read) << spec << ' ' << stage.stage;
      EXPECT_LE(stage.texture_sector_bytes, stage.sector_bytes) << spec << ' ' << stage.stage;
      EXPECT_LE(stage.texture_l2_bytes, std::min(stage.l2_bytes, stage.texture_sector_bytes)) << spec;
      EXPECT_LE(stage.texture_dram_bytes, std::min(stage.dram_bytes, stage.texture_l2_bytes)) << spec;
      EXPECT_EQ(stage.texture_bytes > 0, stage.texture_sector_bytes > 0) << spec << ' ' << stage.stage;
      stage.sector_bytes = stage.l2_bytes = stage.dram_bytes = 0;
      stage.texture_sector_bytes = stage.texture_l2_bytes = stage.texture_dram_bytes = 0;
    }
    EXPECT_EQ(stages_of(spec, trace, off), stages) << spec;
  }
}

TEST(TextureMemory, DoesNotDependOnThreads) {
  const Trace trace = mixed_trace();
  FrameInput one{1}, many{13};
  one.memory.l2 = many.memory.l2 = {2048, 4, 128};  // small, so that the order of the bins matters
  for (const std::string& spec : example_specs())
    EXPECT_EQ(stages_of(spec, trace, one), stages_of(spec, trace, many)) << spec;
}

// Without requests to keep in order, surfaces are shaded side by side. A small pool is collected again and again.
TEST(TextureMemory, WithoutAModelPicturesAndShadingsAreTheSame) {
  FrameInput on, off;
  off.memory.modelled = false;
  for (const char* scene : {"room", "classroom"}) {
    const Trace trace = make_scene(scene, {.width = 96, .height = 54});
    for (const char* spec : {"beam", "beam:pool=16", "beam:tolerance=0.02", "beam:at=covered", "beam:order=sorted",
                             "beam:order=stream", "msaa:8", "deferred"}) {
      const FrameResult with = parse_technique(spec).render(trace, 0, on),
                        without = parse_technique(spec).render(trace, 0, off);
      EXPECT_EQ(with.image.rgba, without.image.rgba) << scene << ' ' << spec;
      for (const auto& [name, values] : without.pixel_counters)
        EXPECT_TRUE(values == with.pixel_counters.at(name)) << scene << ' ' << spec << ": " << name;
      for (std::size_t i = 0; i < with.stages.size(); ++i) {
        EXPECT_EQ(with.stages[i].ops, without.stages[i].ops) << scene << ' ' << spec << ' ' << with.stages[i].stage;
        EXPECT_EQ(with.stages[i].texture_bytes, without.stages[i].texture_bytes) << scene << ' ' << spec;
      }
    }
  }
}

// An unlit texture needs planes (52 bytes, two sectors) and the texture coordinates of three vertices (24 bytes, one
// sector).
TEST(GeometryMemory, SurfacesAreFetchedWithTheirVertices) {
  const Trace trace = textured_frame(16, 8, 0.5);
  const FrameInput run;
  const FrameContext context({trace, trace.frames[0], run, {}});
  const TriangleList list{0, 1};
  TriangleFetches fetches({}, list, &context.shader);
  StageCounters counters;
  fetches.attributes(0, counters);
  fetches.flush(counters);
  EXPECT_EQ(counters.sector_bytes, 3 * 32u);
  EXPECT_EQ(counters.dram_bytes, 3 * 32u);

  // Planes of the second triangle: bytes 52 to 103, sectors 1 to 3. Its vertices: bytes 24 to 47, sectors 0 and 1.
  StageCounters both;
  AttributesInOrder in_order({}, &fetches);
  in_order.read(std::vector<SampleFragment>{{0, 0, 0, 0, 1}, {0, 0, 1, 0, 1}, {1, 0, 0, 0, 1}}, both);
  fetches.flush(both);
  EXPECT_EQ(both.sector_bytes, (3 + 5) * 32u);
  EXPECT_EQ(both.dram_bytes, (4 + 2) * 32u);
}

}  // namespace beampipe::texture_memory_test
