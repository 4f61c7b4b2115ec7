// Traces with fragment shaders of their own, from SPIR-V's assembly language.
#pragma once

#include "pipeline/technique.h"
#include "tests/stages/spirv/shader_text.h"
#include "tests/test.h"
#include "traces/srgb.h"
#include "traces/trace.h"

namespace beampipe {

// A vertex in clip space, and the numbers that the shader reads at location 0.
struct ProgramVertex {
  glm::vec4 position;
  std::vector<float> numbers = {};
};

// One draw, without camera, into a target that stores numbers.
struct ProgramTrace {
  Trace trace;

  ProgramTrace(std::uint32_t width, std::uint32_t height, const std::vector<std::uint32_t>& spirv) {
    Frame& frame = trace.frames.emplace_back();
    frame.width = width, frame.height = height;
    frame.target = ColorTarget::unorm;
    trace.programs.push_back({.name = "shader", .spirv = spirv, .specialization = {}, .inputs = {}});
  }
  ProgramTrace(std::uint32_t width, std::uint32_t height, const ShaderParts& parts)
      : ProgramTrace(width, height, assembled(shader_text(parts))) {}

  // Two triangles: 0 1 2 and 2 1 3.
  Draw& add_quad(const std::vector<ProgramVertex>& vertices) {
    Mesh& mesh = trace.meshes.emplace_back();
    mesh.name = "quad " + std::to_string(trace.meshes.size());
    for (const ProgramVertex& vertex : vertices) {
      mesh.positions.emplace_back(vertex.position);
      mesh.ws.push_back(vertex.position.w);
      for (const float number : vertex.numbers) mesh.varyings.push_back(std::bit_cast<std::uint32_t>(number));
    }
    mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
    mesh.colors.assign(2, kDefaultColor);
    const auto count = static_cast<std::uint32_t>(vertices[0].numbers.size());
    if (count > 0) trace.programs[0].inputs = {{.location = 0, .count = count}};
    Draw& draw = trace.frames[0].draws.emplace_back();
    draw.mesh = static_cast<std::uint32_t>(trace.meshes.size() - 1);
    draw.program.emplace();
    return draw;
  }

  // The whole frame at window depth 1/2. `numbers`: of the upper left, upper right, lower left and lower right corner.
  Draw& fill(const std::vector<std::vector<float>>& numbers = {{}, {}, {}, {}}) {
    return add_quad({{{-1, 1, 0, 1}, numbers[0]},
                     {{1, 1, 0, 1}, numbers[1]},
                     {{-1, -1, 0, 1}, numbers[2]},
                     {{1, -1, 0, 1}, numbers[3]}});
  }
};

// What the target stores: of each pixel, row by row.
inline std::vector<glm::vec3> stored_picture(const FrameResult& result, ColorTarget target = ColorTarget::unorm) {
  std::vector<glm::vec3> pixels;
  for (std::size_t i = 0; i < result.image.rgba.size(); i += 4) {
    glm::vec3& pixel = pixels.emplace_back();
    for (int c = 0; c < 3; ++c) {
      const double linear = result.image.rgba[i + static_cast<std::size_t>(c)];
      pixel[c] = static_cast<float>(target == ColorTarget::unorm ? encoded_as_srgb(linear) : linear);
    }
  }
  return pixels;
}

inline FrameResult rendered(const Trace& trace, const std::string& spec, int threads = 1) {
  return parse_technique(spec).render(trace, 0, {.threads = threads});
}

constexpr float kRounding = 2e-3f;  // of fp16 colours

// expected(x, y): what the target stores in a pixel; NaN: anything.
template <class Expected>
void expect_picture(const Trace& trace, const std::string& spec, Expected&& expected, float tolerance = kRounding) {
  SCOPED_TRACE(spec);
  const std::vector<glm::vec3> found = stored_picture(rendered(trace, spec), trace.frames[0].target);
  const std::uint32_t width = trace.frames[0].width;
  for (std::uint32_t i = 0; i < found.size(); ++i) {
    const glm::vec3 wanted = expected(i % width, i / width);
    for (int c = 0; c < 3; ++c) {
      if (std::isnan(wanted[c])) continue;
      ASSERT_NEAR(found[i][c], wanted[c], tolerance) << "pixel " << i % width << ", " << i / width << " channel " << c;
    }
  }
}

// With these a shader knows its place.
const std::string kFragCoord = R"(
%to_coord = OpTypePointer Input %v4
%coord = OpVariable %to_coord Input
)";
const std::string kFragCoordDecoration = "OpDecorate %coord BuiltIn FragCoord\n";

// Discards where `is_discarded`, which `body` computes, and goes on with `rest`.
inline std::string discarding(const std::string& body, const std::string& rest) {
  return body + R"(
OpSelectionMerge %goes_on None
OpBranchConditional %is_discarded %leave %goes_on
%leave = OpLabel
OpKill
%goes_on = OpLabel
)" + rest;
}
// Left of this place.
inline ShaderParts discarding_left_of(const std::string& x, const std::string& rest) {
  return {.body = discarding(R"(
%at = OpLoad %v4 %coord
%x = OpCompositeExtract %float %at 0
%is_discarded = OpFOrdLessThan %bool %x %end
)",
                             rest),
          .globals = kFragCoord + "%end = OpConstant %float " + x + "\n",
          .decorations = kFragCoordDecoration,
          .interface = "%coord"};
}

}  // namespace beampipe
