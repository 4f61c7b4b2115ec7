// A fragment shader of SPIR-V as a program of lane operations, for ShaderExecutor.
//
// Supported: what Mesa's zink and glslang make of desktop OpenGL and Vulkan programs' fragment shaders.
//   - numbers: floats of 16 and 32 bits, integers of 8, 16 and 32 bits, booleans; vectors, matrices, arrays,
//   structures;
//   - arithmetic, comparisons, conversions, bit fields, derivatives; all of GLSL.std.450 but InterpolateAt*, IMix and
//     what needs 64 bits;
//   - inputs, outputs, built-in variables; uniform and storage buffers and push constants, to read; local arrays;
//   - images that are sampled, gathered, fetched and asked for their sizes, arrays of them included;
//   - all structured control flow; OpKill, OpTerminateInvocation and OpDemoteToHelperInvocation.
// Not supported, and named in the error: writes to buffers and images, atomics, storage images, images with several
// samples, subpass inputs, pointers that are chosen while the shader runs, arrays of buffers with an index that is not
// constant, subgroups, ray queries, 64 bits.
//
// How counts are made: ops of one invocation are those of the blocks that it runs, each lane operation as lane_code.cpp
// has it, of the simplified module with its common parts within a block made once.
#pragma once

#include <cstdint>
#include <span>

#include "stages/spirv/lane_program.h"
#include "stages/spirv/shader_error.h"
#include "stages/spirv/simplify.h"

namespace beampipe {

// Throws ShaderError, one line.
LaneProgram load_fragment_shader(std::span<const std::uint32_t> words, const Specialization& specialization = {});

// What a module, which may be broken, says to coverage and to tests, besides its colours.
struct ShaderEffects {
  bool discards = false;  // it has an instruction that discards an invocation
  bool tests_early = false;
  bool writes_depth = false, writes_samples = false;  // FragDepth, SampleMask
};
ShaderEffects effects_of(std::span<const std::uint32_t> words);

}  // namespace beampipe
