// Lane operations that the executor of shaders runs in a second, on one core with its best instruction set: eight
// octaves of noise, as a landscape's shader has it, 482 lane operations in each invocation.
#include <benchmark/benchmark.h>

#include <random>
#include <spirv-tools/libspirv.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "stages/spirv/fragment_shader.h"
#include "stages/spirv/shader_executor.h"

namespace beampipe {
namespace {

// A loop over octaves; in each, the noise of the four corners of a cell is mixed by a smooth step.
constexpr const char* kNoise = R"(
OpCapability Shader
%glsl = OpExtInstImport "GLSL.std.450"
OpMemoryModel Logical GLSL450
OpEntryPoint Fragment %main "main" %place %octaves %color
OpExecutionMode %main OriginUpperLeft
OpDecorate %place Location 0
OpDecorate %octaves Location 1
OpDecorate %octaves Flat
OpDecorate %color Location 0
%void = OpTypeVoid
%action = OpTypeFunction %void
%bool = OpTypeBool
%float = OpTypeFloat 32
%int = OpTypeInt 32 1
%v2 = OpTypeVector %float 2
%v4 = OpTypeVector %float 4
%in_v2 = OpTypePointer Input %v2
%in_int = OpTypePointer Input %int
%out_v4 = OpTypePointer Output %v4
%i0 = OpConstant %int 0
%i1 = OpConstant %int 1
%f0 = OpConstant %float 0
%f1 = OpConstant %float 1
%f2 = OpConstant %float 2
%f3 = OpConstant %float 3
%half = OpConstant %float 0.5
%gamma = OpConstant %float 0.45
%large = OpConstant %float 43758.547
%kx = OpConstant %float 12.9898
%ky = OpConstant %float 78.233
%k = OpConstantComposite %v2 %kx %ky
%threes = OpConstantComposite %v2 %f3 %f3
%right = OpConstantComposite %v2 %f1 %f0
%below = OpConstantComposite %v2 %f0 %f1
%both = OpConstantComposite %v2 %f1 %f1
%hash_type = OpTypeFunction %float %v2
%place = OpVariable %in_v2 Input
%octaves = OpVariable %in_int Input
%color = OpVariable %out_v4 Output
%main = OpFunction %void None %action
%entry = OpLabel
%start = OpLoad %v2 %place
%count = OpLoad %int %octaves
OpBranch %loop
%loop = OpLabel
%p = OpPhi %v2 %start %entry %p_next %again
%amplitude = OpPhi %float %half %entry %amplitude_next %again
%sum = OpPhi %float %f0 %entry %sum_next %again
%i = OpPhi %int %i0 %entry %i_next %again
%goes_on = OpSLessThan %bool %i %count
OpLoopMerge %end %again None
OpBranchConditional %goes_on %octave %end
%octave = OpLabel
%cell = OpExtInst %v2 %glsl Floor %p
%f = OpExtInst %v2 %glsl Fract %p
%square = OpFMul %v2 %f %f
%twice = OpVectorTimesScalar %v2 %f %f2
%rest = OpFSub %v2 %threes %twice
%u = OpFMul %v2 %square %rest
%ux = OpCompositeExtract %float %u 0
%uy = OpCompositeExtract %float %u 1
%cell_right = OpFAdd %v2 %cell %right
%cell_below = OpFAdd %v2 %cell %below
%cell_both = OpFAdd %v2 %cell %both
%n0 = OpFunctionCall %float %hash %cell
%n1 = OpFunctionCall %float %hash %cell_right
%n2 = OpFunctionCall %float %hash %cell_below
%n3 = OpFunctionCall %float %hash %cell_both
%upper = OpExtInst %float %glsl FMix %n0 %n1 %ux
%lower = OpExtInst %float %glsl FMix %n2 %n3 %ux
%noise = OpExtInst %float %glsl FMix %upper %lower %uy
%term = OpFMul %float %noise %amplitude
OpBranch %again
%again = OpLabel
%sum_next = OpFAdd %float %sum %term
%p_next = OpVectorTimesScalar %v2 %p %f2
%amplitude_next = OpFMul %float %amplitude %half
%i_next = OpIAdd %int %i %i1
OpBranch %loop
%end = OpLabel
%bright = OpExtInst %float %glsl Pow %sum %gamma
%result = OpCompositeConstruct %v4 %bright %sum %sum %f1
OpStore %color %result
OpReturn
OpFunctionEnd
%hash = OpFunction %float None %hash_type
%at = OpFunctionParameter %v2
%hash_entry = OpLabel
%angle = OpDot %float %at %k
%sine = OpExtInst %float %glsl Sin %angle
%scaled = OpFMul %float %sine %large
%hashed = OpExtInst %float %glsl Fract %scaled
OpReturnValue %hashed
OpFunctionEnd
)";

LaneProgram noise_program() {
  std::vector<std::uint32_t> words;
  if (!spvtools::SpirvTools(SPV_ENV_UNIVERSAL_1_3).Assemble(kNoise, &words)) throw std::logic_error("not SPIR-V");
  return load_fragment_shader(words);
}

// `octaves(lane)`: how long each lane runs.
template <class Octaves>
void run_noise(benchmark::State& state, Octaves&& octaves) {
  const LaneProgram program = noise_program();
  ShaderExecutor executor(program);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 10);
  for (const InterfaceRow& input : program.inputs)
    for (std::size_t lane = 0; lane < kShaderLanes; ++lane) {
      if (input.location == 0)
        executor.row(input.row).set(lane, uniform(random));
      else
        executor.row(input.row).bits[lane] = octaves(lane);
    }
  ShaderCounts counts;
  for (auto _ : state) executor.run({}, kShaderLanes, ~std::uint64_t{0}, 0, counts);
  state.SetItemsProcessed(static_cast<std::int64_t>(counts.instructions));
  state.counters["ops_per_invocation"] =
      static_cast<double>(counts.instructions) / static_cast<double>(counts.invocations);
}

void noise(benchmark::State& state) {
  run_noise(state, [](std::size_t) { return 8u; });
}
BENCHMARK(noise);

// Only lanes that run count.
void noise_where_lanes_leave_one_by_one(benchmark::State& state) {
  run_noise(state, [](std::size_t lane) { return static_cast<std::uint32_t>(lane % 9); });
}
BENCHMARK(noise_where_lanes_leave_one_by_one);

void load_shader(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(noise_program());
}
BENCHMARK(load_shader);

}  // namespace
}  // namespace beampipe
