#include "tools/evaluate/machine_memory.h"

#include "pipeline/technique.h"
#include "tests/message_of.h"
#include "tests/tools/fixtures.h"

namespace beampipe::machine_memory_test {

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

std::string refusal(const Trace& trace, const char* spec, std::uint64_t memory) {
  return message_of<std::runtime_error>(
      [&] { require_memory(trace, trace.frames[0], parse_technique(spec).working_bytes_per_pixel, spec, memory); });
}

TEST(MachineMemory, OfPixelsIsAskedForBeforeItIsTaken) {
  Trace trace;
  trace.frames.resize(1);
  trace.frames[0].width = trace.frames[0].height = 16384;
  EXPECT_EQ(refusal(trace, "msaa:1", 4 * kGiB), "no error");
  EXPECT_EQ(refusal(trace, "dvm", 40 * kGiB), "no error");
  EXPECT_EQ(refusal(trace, "dvm", 16 * kGiB),
            "dvm: 16384 x 16384 pixels and 0 triangles may need 38912 MiB, and this machine has 16384");
}

TEST(MachineMemory, OfTrianglesThatAreDrawnAgainAndAgainIsAskedForBeforeItIsTaken) {
  Trace trace;
  trace.meshes.resize(1);
  trace.meshes[0].triangles.resize(30000);
  trace.frames.resize(1);
  trace.frames[0].draws.resize(30000);
  EXPECT_EQ(refusal(trace, "beam", 128 * kGiB), "no error");
  expect_parts(refusal(trace, "beam", 64 * kGiB), {"900000000 triangles may need 102"});
}

// A frame of one pixel and one triangle with a material.
Trace varying_pixel() {
  Trace trace;
  trace.materials.resize(1);
  trace.meshes.resize(1);
  trace.meshes[0].positions.resize(3);
  trace.meshes[0].triangles.resize(1);
  trace.meshes[0].materials = {0};
  trace.frames.resize(1);
  trace.frames[0].width = trace.frames[0].height = 1;
  trace.frames[0].draws.resize(1);
  return trace;
}

// What the shader keeps for each material was not asked for.
TEST(MachineMemory, OfMaterialsIsAskedForBeforeItIsTaken) {
  Trace trace = varying_pixel();
  EXPECT_EQ(refusal(trace, "beam", kGiB), "no error");
  trace.materials.resize(1'000'000);
  EXPECT_EQ(refusal(trace, "beam", 8 * kGiB), "no error");
  const std::string refused = refusal(trace, "beam", kGiB / 2);
  EXPECT_EQ(refused.find("beam: 1 x 1 pixels and 1 triangles, with 1000000 materials and 0 images, may need "), 0u)
      << refused;
  trace.materials[0].unlit = true;  // the triangle is flat, and no material is shaded
  EXPECT_EQ(refusal(trace, "beam", kGiB / 2), "no error");
}

TEST(MachineMemory, OfTexturesAndVerticesIsAskedForBeforeItIsTaken) {
  Trace trace = varying_pixel();
  const std::uint64_t without = frame_memory(trace, trace.frames[0], 16);
  trace.images.resize(2);  // of which one is used, in two colour spaces
  for (TextureImage& image : trace.images) image = {"", 1024, 1024, std::vector<glm::u8vec4>(1 << 20)};
  trace.materials[0].base_texture = trace.materials[0].emissive_texture = Texture{.image = 1};
  const std::uint64_t srgb = frame_memory(trace, trace.frames[0], 16) - without;
  EXPECT_GE(srgb, (1u << 20) * (4 * 4 / 3 + 16u));
  EXPECT_LE(srgb, (1u << 20) * 32u);
  trace.materials[0].normal_texture = Texture{.image = 1};
  EXPECT_EQ(frame_memory(trace, trace.frames[0], 16) - without, 2 * srgb);

  Trace vertices = varying_pixel();
  vertices.meshes[0].positions.resize(1003);
  EXPECT_EQ(frame_memory(vertices, vertices.frames[0], 16) - without, 1000 * sizeof(SurfaceVertex));
}

// 1.3 texels of 4 bytes for each alpha test, and what one takes while it is made.
TEST(MachineMemory, OfTestedAlphaIsAskedForBeforeItIsTaken) {
  Trace trace = varying_pixel();
  trace.images = {{"", 1024, 1024, std::vector<glm::u8vec4>(1 << 20)}};
  trace.materials[0].base_texture = Texture{.image = 0};
  const std::uint64_t without = frame_memory(trace, trace.frames[0], 16);
  trace.materials[0].alpha_mode = AlphaMode::mask;
  const std::uint64_t results = (1 << 20) * 4 * 4 / 3, working = (1 << 20) * (4 + 16 * 5 / 4);
  EXPECT_EQ(frame_memory(trace, trace.frames[0], 16) - without, results + working);

  trace.materials.resize(3, trace.materials[0]);
  trace.materials[1].alpha_cutoff = 0.75f;
  const std::uint64_t of_one = frame_memory(trace, trace.frames[0], 16);
  trace.frames[0].draws.push_back(trace.frames[0].draws[0]);
  const std::uint64_t twice = frame_memory(trace, trace.frames[0], 16);
  EXPECT_LT(twice - of_one, 1u << 20) << "the others are not drawn";
  trace.frames[0].draws[1].material = 2;
  EXPECT_EQ(frame_memory(trace, trace.frames[0], 16), twice) << "the test is the same";
  trace.frames[0].draws[1].material = 1;
  EXPECT_EQ(frame_memory(trace, trace.frames[0], 16) - twice, results);
}

TEST(MachineMemory, IsKnown) { EXPECT_GT(machine_memory(), kGiB / 4); }

}  // namespace beampipe::machine_memory_test
