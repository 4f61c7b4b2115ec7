// Fragment shaders from SPIR-V's assembly language, and runs of them on numbers.
#pragma once

#include <spirv-tools/libspirv.hpp>

#include "stages/spirv/fragment_shader.h"
#include "stages/spirv/shader_executor.h"
#include "tests/test.h"

namespace beampipe {

inline std::vector<std::uint32_t> assembled(const std::string& text) {
  spvtools::SpirvTools tools(SPV_ENV_UNIVERSAL_1_3);
  std::string problem;
  tools.SetMessageConsumer([&](spv_message_level_t, const char*, const spv_position_t& at, const char* message) {
    problem += std::to_string(at.line) + ": " + message + "\n";
  });
  std::vector<std::uint32_t> words;
  if (!tools.Assemble(text, &words)) ADD_FAILURE() << problem << text;
  return words;
}

// Inputs %a, %b, %c (4 floats each, loaded as %va, %vb, %vc) and %i, %j, %k (4 integers, loaded as %vi, %vj, %vk, and
// the first ones of %vi as %vi0 and %vi1), outputs %out (4 floats) and %iout (4 integers). `parts`: see below.
struct ShaderParts {
  std::string body;           // after the inputs have been loaded, without OpReturn
  std::string floats = "";    // four ids, which %out gets at the end
  std::string integers = "";  // and %iout
  std::string globals = "";   // types, constants and variables
  std::string decorations = "";
  std::string functions = "";
  std::string capabilities = "";
  std::string interface = "";  // more variables of the entry point
  std::string modes = "";      // and strings of a source
};

inline std::string shader_text(const ShaderParts& parts) {
  std::string text = R"(
OpCapability Shader
OpCapability Float16
OpCapability Int16
OpCapability Int8
OpCapability StorageInputOutput16
OpCapability SampledBuffer
OpCapability Sampled1D
OpCapability ImageQuery
OpCapability DerivativeControl
)" + parts.capabilities +
                     R"(
OpExtension "SPV_KHR_16bit_storage"
OpExtension "SPV_EXT_demote_to_helper_invocation"
%glsl = OpExtInstImport "GLSL.std.450"
OpMemoryModel Logical GLSL450
OpEntryPoint Fragment %main "main" %a %b %c %i %j %k %out %iout )" +
                     parts.interface + R"(
OpExecutionMode %main OriginUpperLeft
)" + parts.modes + R"(
OpDecorate %a Location 0
OpDecorate %b Location 1
OpDecorate %c Location 2
OpDecorate %i Location 3
OpDecorate %j Location 4
OpDecorate %k Location 5
OpDecorate %i Flat
OpDecorate %j Flat
OpDecorate %k Flat
OpDecorate %out Location 0
OpDecorate %iout Location 1
)" + parts.decorations +
                     R"(
%void = OpTypeVoid
%action = OpTypeFunction %void
%bool = OpTypeBool
%float = OpTypeFloat 32
%half = OpTypeFloat 16
%int = OpTypeInt 32 1
%uint = OpTypeInt 32 0
%short = OpTypeInt 16 1
%ushort = OpTypeInt 16 0
%char = OpTypeInt 8 1
%v2 = OpTypeVector %float 2
%v3 = OpTypeVector %float 3
%v4 = OpTypeVector %float 4
%h2 = OpTypeVector %half 2
%h4 = OpTypeVector %half 4
%i2 = OpTypeVector %int 2
%i3 = OpTypeVector %int 3
%i4 = OpTypeVector %int 4
%u2 = OpTypeVector %uint 2
%u4 = OpTypeVector %uint 4
%s4 = OpTypeVector %short 4
%us4 = OpTypeVector %ushort 4
%c4 = OpTypeVector %char 4
%b4 = OpTypeVector %bool 4
%f0 = OpConstant %float 0
%f1 = OpConstant %float 1
%f2 = OpConstant %float 2
%i0 = OpConstant %int 0
%i1 = OpConstant %int 1
%i2_ = OpConstant %int 2
%i3_ = OpConstant %int 3
%i4_ = OpConstant %int 4
%u0 = OpConstant %uint 0
%u1 = OpConstant %uint 1
%u2_ = OpConstant %uint 2
%u3_ = OpConstant %uint 3
%u4_ = OpConstant %uint 4
%true = OpConstantTrue %bool
%f0000 = OpConstantComposite %v4 %f0 %f0 %f0 %f0
%f1111 = OpConstantComposite %v4 %f1 %f1 %f1 %f1
%u0000 = OpConstantComposite %u4 %u0 %u0 %u0 %u0
%u1111 = OpConstantComposite %u4 %u1 %u1 %u1 %u1
%in_v4 = OpTypePointer Input %v4
%in_u4 = OpTypePointer Input %u4
%out_v4 = OpTypePointer Output %v4
%out_u4 = OpTypePointer Output %u4
%pu = OpTypePointer Function %uint
%a = OpVariable %in_v4 Input
%b = OpVariable %in_v4 Input
%c = OpVariable %in_v4 Input
%i = OpVariable %in_u4 Input
%j = OpVariable %in_u4 Input
%k = OpVariable %in_u4 Input
%out = OpVariable %out_v4 Output
%iout = OpVariable %out_u4 Output
)" + parts.globals + R"(
%main = OpFunction %void None %action
%entry = OpLabel
)";
  // Variables of the function come first.
  const std::size_t first = parts.body.find("; begin");
  text += first == std::string::npos ? "" : parts.body.substr(0, first);
  text += R"(
%va = OpLoad %v4 %a
%vb = OpLoad %v4 %b
%vc = OpLoad %v4 %c
%vi = OpLoad %u4 %i
%vj = OpLoad %u4 %j
%vk = OpLoad %u4 %k
%vi0 = OpCompositeExtract %uint %vi 0
%vi1 = OpCompositeExtract %uint %vi 1
)" + (first == std::string::npos ? parts.body : parts.body.substr(first));
  const auto store = [&](const std::string& ids, const std::string& type, const std::string& to) {
    if (!ids.empty())
      text += "\n%all_" + to + " = OpCompositeConstruct %" + type + " " + ids + "\nOpStore %" + to + " %all_" + to;
  };
  store(parts.floats, "v4", "out"), store(parts.integers, "u4", "iout");
  text += R"(
OpReturn
OpFunctionEnd
)" + parts.functions;
  return text;
}

// A loop of which %goes_on is known once `check` has been run. `phis`: numbers from turn to turn, from %entry or
// %again. `turn`: what ends each turn.
inline std::string loop_text(const std::string& phis, const std::string& check, const std::string& turn) {
  return "OpBranch %header\n%header = OpLabel\n" + phis + check +
         "OpLoopMerge %after %again None\nOpBranchConditional %goes_on %again %after\n%again = OpLabel\n" + turn +
         "OpBranch %header\n%after = OpLabel\n";
}

// A loaded shader with its executor.
class TestShader {
 public:
  explicit TestShader(const ShaderParts& parts, const Specialization& specialization = {})
      : TestShader(assembled(shader_text(parts)), specialization) {}
  explicit TestShader(const std::vector<std::uint32_t>& words, const Specialization& specialization = {})
      : program(load_fragment_shader(words, specialization)), executor(program) {}

  LaneRow* input(std::uint32_t location, std::uint32_t component) {
    for (const InterfaceRow& row : program.inputs)
      if (row.location == location && row.component == component) return &executor.row(row.row);
    return nullptr;
  }
  LaneRow* built_in(spv::BuiltIn built_in, std::uint32_t component = 0) {
    for (const InterfaceRow& row : program.inputs)
      if (row.built_in == built_in && row.component == component) return &executor.row(row.row);
    return nullptr;
  }
  const LaneRow& output(std::uint32_t location, std::uint32_t component) const {
    for (const InterfaceRow& row : program.outputs)
      if (row.location == location && row.component == component) return executor.row(row.row);
    throw std::logic_error("no such output");
  }
  float number(std::uint32_t component, std::size_t lane) const { return output(0, component).number(lane); }
  std::uint32_t integer(std::uint32_t component, std::size_t lane) const { return output(1, component).bits[lane]; }

  void set(std::uint32_t location, std::uint32_t component, std::size_t lane, float value) {
    if (LaneRow* row = input(location, component)) row->set(lane, value);
  }
  void set_integer(std::uint32_t location, std::uint32_t component, std::size_t lane, std::uint32_t value) {
    if (LaneRow* row = input(location, component)) row->bits[lane] = value;
  }
  // False if lanes were stopped.
  bool run(std::size_t lanes = kShaderLanes) {
    const std::uint64_t before = counts.stopped;
    executor.run(resources, lanes, ~std::uint64_t{0}, 0, counts);
    return counts.stopped == before;
  }

  LaneProgram program;
  ShaderExecutor executor;
  ShaderResources resources;
  ShaderCounts counts;
};

// Floats of all kinds: special ones, those of everyday use, and any bits.
inline float any_float(std::mt19937& random, std::size_t i) {
  constexpr float kSpecial[] = {0.0f,  -0.0f, 1.0f,   -1.0f,  0.5f,  -0.5f, 1.5f,    2.5f,
                                -2.5f, 3.0f,  -7.25f, 255.0f, 1e-3f, 1e30f, -1e-30f, 16777216.0f};
  if (i % 8 < 2) return kSpecial[random() % std::size(kSpecial)];
  if (i % 8 < 6) return std::uniform_real_distribution<float>(-10, 10)(random);
  float value;
  do value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
  while (!(std::fabs(value) < 1e37f));
  return value;
}

inline std::uint32_t any_integer(std::mt19937& random, std::size_t i) {
  constexpr std::uint32_t kSpecial[] = {0,           1,           2,      31,     32,         0xffffffffu,
                                        0x80000000u, 0x7fffffffu, 0xffff, 0x8000, 0xfffffffeu};
  if (i % 4 == 0) return kSpecial[random() % std::size(kSpecial)];
  if (i % 4 == 1) return static_cast<std::uint32_t>(random() % 41) - 20u;
  return static_cast<std::uint32_t>(random());
}

}  // namespace beampipe
