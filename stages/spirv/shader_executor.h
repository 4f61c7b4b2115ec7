// Runs a fragment shader for up to kShaderLanes invocations at once.
//
// Lanes come in groups of four, in which differences are taken: the pixel (or any place), that to its right, that below
// it, and that to the right of that one. A lane without its neighbour in the same row (column) takes the difference of
// the other one; 0 if that is missing too. A group may therefore be a quad of pixels, or one place with two more that
// only its derivatives need, without the fourth lane. Shaders that take no differences need no groups.
//
// Control flow: each lane knows the block that it wants to run, and the least block runs next, for all lanes that want
// it. Results have the same bits on every instruction set, and do not depend on which lanes run together, except for
// differences.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/spirv/image_reader.h"
#include "stages/spirv/lane_program.h"

namespace beampipe {

// What a shader reads besides its inputs, by LaneProgram::buffers. Reads outside of a buffer give 0.
struct ShaderResources {
  std::vector<std::span<const std::byte>> buffers;
  ImageReader* images = nullptr;  // may be null if the shader has none
};

// What lane operations work on.
struct LaneState {
  LaneRow* rows;
  std::size_t lanes;  // a multiple of 16
  const LaneProgram* program;
  const ShaderResources* resources;
};

// Sums over invocations: each counts what it executes.
struct ShaderCounts {
  std::uint64_t invocations = 0;
  OperationCounts ops{};
  std::uint64_t instructions = 0;      // lane operations that are counted in ops, and image operations
  std::uint64_t texture_requests = 0;  // samples, gathers and fetches
  std::uint64_t lanes_issued = 0;      // of instructions: those of lanes that wait included
  std::uint64_t stopped = 0;           // invocations that took too many steps
};

class ShaderExecutor {
 public:
  // A lane is stopped after about so many lane operations, ways out of blocks and values that phis take; an image that
  // is read counts as many. Captured programs' shaders take a few thousand.
  static constexpr std::uint32_t kMostSteps = 1u << 16;

  // The program must outlive it.
  explicit ShaderExecutor(const LaneProgram& program);

  // Rows of LaneProgram::inputs are set before run(), those of outputs can be read afterwards. 16-bit floats are
  // float32 numbers; booleans all ones or all zeros.
  LaneRow& row(std::uint32_t number) { return rows_[number]; }
  const LaneRow& row(std::uint32_t number) const { return rows_[number]; }

  // Lanes [0, count) for which bits of `active` are set; those of `helpers` are helper invocations. Adds to `counts`,
  // helpers included. Lanes that take more than `most_steps` are stopped.
  void run(const ShaderResources& resources, std::size_t count, std::uint64_t active, std::uint64_t helpers,
           ShaderCounts& counts, std::uint32_t most_steps = kMostSteps);

  // Lanes of the last run that have results: neither helpers nor discarded nor stopped.
  std::uint64_t kept() const;

 private:
  const LaneProgram& program_;
  std::vector<LaneRow> rows_;                // of the program, and the executor's own
  std::vector<std::uint32_t> instructions_;  // of one lane, by block
};

}  // namespace beampipe
