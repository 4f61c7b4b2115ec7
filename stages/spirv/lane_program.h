// A fragment shader as lane operations: what decode() makes and ShaderExecutor runs.
#pragma once

#include <array>
#include <cstdint>
#include <spirv/unified1/spirv.hpp>
#include <vector>

#include "stages/spirv/lane_code.h"

namespace beampipe {

inline constexpr std::uint32_t kNoRow = ~0u;

// Rows that every program has.
inline constexpr std::uint32_t kActiveRow = 0;  // lanes that run the block
inline constexpr std::uint32_t kHelperRow = 1;  // lanes whose results nobody keeps: helpers and discarded ones
inline constexpr std::uint32_t kFixedRows = 2;

struct LaneOp {
  LaneCode code = LaneCode::copy;
  bool keeps = false;      // other lanes keep the result that they have
  std::uint8_t width = 4;  // load_bytes: in bytes
  bool is_free = false;    // part of another operation, which is counted
  std::uint32_t result = kNoRow;
  std::uint32_t a = kNoRow, b = kNoRow, c = kNoRow, d = 0;
};

enum class ImageAction : std::uint8_t { sample, gather, fetch, query_size, query_levels, query_lod };

// An operation on an image. Rows that it does not have are kNoRow.
struct ImageOp {
  ImageAction action = ImageAction::sample;
  std::uint32_t image = 0;         // index in LaneProgram::images
  std::uint32_t sampler = kNoRow;  // index in LaneProgram::samplers; kNoRow: of the image itself, or none
  std::uint32_t image_element = kNoRow, sampler_element = kNoRow;  // rows; kNoRow: the first of the array
  std::array<std::uint32_t, 4> coordinates{kNoRow, kNoRow, kNoRow, kNoRow};
  std::array<std::uint32_t, 3> dx{kNoRow, kNoRow, kNoRow}, dy = dx;  // of the coordinates; with the layer left out
  std::array<std::uint32_t, 3> offset = dx;
  std::uint32_t lod = kNoRow, bias = kNoRow, least_lod = kNoRow, reference = kNoRow;
  std::uint32_t component = 0;  // gather: which one
  bool is_for_helpers = true;   // else lanes whose results nobody keeps need not read
  std::array<std::uint32_t, 4> results{kNoRow, kNoRow, kNoRow, kNoRow};

  template <class Visit>
  void for_each_operand(Visit&& visit) {
    for (std::uint32_t* row : {&image_element, &sampler_element, &lod, &bias, &least_lod, &reference})
      if (*row != kNoRow) visit(*row);
    for (std::uint32_t& row : coordinates)
      if (row != kNoRow) visit(row);
    for (auto* rows : {&dx, &dy, &offset})
      for (std::uint32_t& row : *rows)
        if (row != kNoRow) visit(row);
  }
};

// A way out of a block: lanes that take it go to `target` after the copies, which are the values of its phis.
struct LaneEdge {
  std::uint32_t target = 0;                  // block
  std::uint32_t literal = 0;                 // switch: of this value
  std::uint32_t first_copy = 0, copies = 0;  // in LaneProgram::ops
};

// branch: a condition's first edge where it holds. switched: the edge with the value of the condition, else the first.
enum class BlockEnd : std::uint8_t { done, jump, branch, switched };

struct LaneBlock {
  std::uint32_t first_op = 0, ops = 0;  // in LaneProgram::ops
  BlockEnd end = BlockEnd::done;
  std::uint32_t condition = kNoRow;         // row
  std::uint32_t first_edge = 0, edges = 0;  // in LaneProgram::edges
  OperationCounts cost{};                   // of one lane
  std::uint32_t requests = 0;               // texture requests of one lane
  std::uint32_t steps = 0;                  // what it counts as where runs are bounded (ShaderExecutor::kMostSteps)
};

// How an input varies over its triangle.
enum class Interpolation : std::uint8_t { perspective, linear, flat };

// A part of a variable of the interface: one component of one location, or of a built-in variable.
struct InterfaceRow {
  std::uint32_t row = 0;
  std::uint32_t location = kNoRow;  // kNoRow: built-in
  std::uint32_t component = 0;      // of the location; of a built-in: of all that it has
  std::uint32_t index = 0;          // of outputs: 1 is the second source of blending
  spv::BuiltIn built_in = spv::BuiltInMax;
  bool is_float = true;  // else an integer or a boolean
  Interpolation interpolation = Interpolation::perspective;
  bool at_centroid = false, at_sample = false;
};

// A uniform or storage buffer. Push constants have no set and no binding.
struct BufferSlot {
  std::uint32_t set = kNoRow, binding = kNoRow;
  std::uint32_t element = 0;  // of an array of buffers
};

enum class TexelKind : std::uint8_t { floats, signed_integers, unsigned_integers };

// Images, with or without a sampler of their own, and samplers. `count`: of an array; 0: of unknown length.
struct ImageSlot {
  std::uint32_t set = kNoRow, binding = kNoRow, count = 1;
  spv::Dim dim = spv::Dim2D;
  bool arrayed = false, depth = false, has_sampler = false;
  TexelKind texels = TexelKind::floats;
};
struct SamplerSlot {
  std::uint32_t set = kNoRow, binding = kNoRow, count = 1;
};

struct LaneProgram {
  std::vector<LaneOp> ops;
  std::vector<ImageOp> image_ops;
  std::vector<LaneEdge> edges;
  std::vector<LaneBlock> blocks;  // lanes that diverge take the least first; the first one begins

  std::uint32_t rows = kFixedRows;  // all of them: fixed ones, constants, inputs, memory, registers
  std::vector<std::pair<std::uint32_t, std::uint32_t>> constants;  // row, bits
  std::uint32_t first_memory = 0, memory_rows = 0;                 // outputs and local variables, which are 0 at first

  std::vector<InterfaceRow> inputs, outputs;
  std::vector<BufferSlot> buffers;
  std::vector<ImageSlot> images;
  std::vector<SamplerSlot> samplers;

  std::uint32_t registers = 0;     // of 32 bits that one invocation needs at most for values
  bool takes_differences = false;  // it needs groups of four lanes
  bool discards = false;
  bool tests_early = false;  // depth and stencil before the shader, although it discards
};

}  // namespace beampipe
