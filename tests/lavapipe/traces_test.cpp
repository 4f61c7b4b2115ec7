// The shaders of captured programs against Mesa's lavapipe, with what their draws bind and with varyings of their
// meshes' own vertices: BEAMPIPE_SHADER_TRACES=FOLDER, of traces. Prints the share of outputs that agree to 1e-5.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "stages/spirv/fragment_shader.h"
#include "tests/lavapipe/lavapipe_test.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

class LavapipeTraces : public LavapipeTest {
 protected:
  // Points have the varyings of any vertices; a triangle those of one of the mesh's own.
  ShaderCase case_of(const Trace& trace, const Draw& draw, bool is_triangle) {
    const ShaderProgram& program = trace.programs[draw.program->program];
    const Mesh& mesh = trace.meshes[draw.mesh];
    ShaderCase made{.words = program.spirv,
                    .specialization = program.specialization,
                    .use = *draw.program,
                    .images = trace.program_images,
                    .samplers = trace.program_samplers,
                    .is_triangle = is_triangle};
    std::vector<std::uint32_t> vertices;
    const glm::uvec3& triangle = mesh.triangles[random_() % mesh.triangles.size()];
    for (std::size_t i = 0; i < (is_triangle ? 3 : kPixels); ++i)
      vertices.push_back(is_triangle ? triangle[static_cast<int>(i)]
                                     : static_cast<std::uint32_t>(random_() % mesh.positions.size()));
    const std::uint64_t stride = varyings_of(program);
    std::uint32_t first = 0;
    for (const ProgramInput& each : program.inputs) {
      CaseInput& input = made.inputs[each.location];
      input.is_integer |= each.integer;
      input.is_flat |= each.interpolation == InputInterpolation::flat;
      input.vertices.resize(vertices.size());
      for (std::uint32_t k = 0; k < each.count; ++k) {
        for (std::size_t i = 0; i < vertices.size(); ++i)
          input.vertices[i][each.component + k] = mesh.varyings[vertices[i] * stride + first + k];
        if (is_triangle && !each.integer) round(input, each.component + k);
      }
      first += each.count;
    }
    return made;
  }

  // To so few bits that both know exactly what is between the vertices.
  static void round(CaseInput& input, std::uint32_t component) {
    float most = 0;
    for (const FourBits& vertex : input.vertices)
      most = std::max(most, std::abs(std::bit_cast<float>(vertex[component])));
    if (!(most > 0) || std::isinf(most)) return;
    int exponent;
    std::frexp(most, &exponent);
    for (FourBits& vertex : input.vertices)
      vertex[component] = bits_of(std::ldexp(
          std::nearbyint(std::ldexp(std::bit_cast<float>(vertex[component]), 12 - exponent)), exponent - 12));
  }
};

TEST_F(LavapipeTraces, ShadersOfPrograms) {
  const char* const folder = std::getenv("BEAMPIPE_SHADER_TRACES");
  if (!folder) GTEST_SKIP() << "BEAMPIPE_SHADER_TRACES names no folder of traces";
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".json") files.insert(entry.path());
  std::set<std::vector<std::uint32_t>> seen;
  for (const std::filesystem::path& file : files) {
    const Trace trace = read_trace(file);
    // Of each module: points and triangles of its first draws.
    std::map<std::pair<std::uint32_t, bool>, Agreement> modules;  // by number, and of triangles or points
    std::map<std::uint32_t, int> draws;
    for (const Frame& frame : trace.frames)
      for (const Draw& draw : frame.draws) {
        if (!draw.program || trace.meshes[draw.mesh].triangles.empty()) continue;
        const std::uint32_t number = draw.program->program;
        if (draws[number] == 0 && !seen.insert(trace.programs[number].spirv).second) draws[number] = 1 << 20;
        if (draws[number]++ >= 3) continue;
        for (const bool is_triangle : {false, true}) {
          try {
            modules[{number, is_triangle}] += agreement_of(*driver_, case_of(trace, draw, is_triangle));
          } catch (const ShaderError& error) {
            std::printf("%s, program %u: %s\n", file.stem().c_str(), number, error.what());
          }
        }
      }
    for (const auto& [module, found] : modules) {
      const auto& [number, is_triangle] = module;
      const LaneProgram program = load_fragment_shader(trace.programs[number].spirv);
      std::printf(
          "%s, program %u, %s: %zu lane operations, %.3f %% of %llu outputs within 1e-5, %.3f %% within 1e-3, worst "
          "%.2g\n",
          file.stem().c_str(), number, is_triangle ? "triangles" : "points", program.ops.size(), 100 * found.share(),
          static_cast<unsigned long long>(found.outputs),
          100 * static_cast<double>(found.roughly) / static_cast<double>(found.outputs), found.worst);
      // Where 16-bit floats are rounded, the least difference may become one of 2^-11.
      EXPECT_GT(static_cast<double>(found.roughly) / static_cast<double>(found.outputs), 0.998) << found.example;
    }
  }
}

}  // namespace
}  // namespace beampipe
