#include "stages/spirv/shader_executor.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stages/spirv/shader_executor.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "stages/spirv/lane_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

using LaneKernels = std::array<LaneKernel, static_cast<std::size_t>(LaneCode::codes)>;
inline const LaneKernels& lane_kernels() {
  static const LaneKernels kernels = [] {
    LaneKernels made{};
    for (std::size_t i = 0; i < made.size(); ++i) made[i] = kernel_of(static_cast<LaneCode>(i));
    return made;
  }();
  return kernels;
}

constexpr std::uint32_t kNoBlock = ~0u;

// Runs the program from block 0 for lanes of `wanted` that are not kNoBlock there. `scratch`: one row for results that
// only some lanes take, and one that says which lanes take an edge.
bool run_program_kernel(const LaneProgram& program, const ShaderResources& resources, LaneRow* rows, LaneRow* scratch,
                        LaneRow& wanted, std::size_t lanes, const std::uint32_t* instructions, ShaderCounts& counts) {
  const LaneKernels& kernels = lane_kernels();
  const LaneState state{rows, lanes, &program, &resources};
  LaneRow &kept = scratch[0], &takes = scratch[1], &active = rows[kActiveRow];
  const std::uint32_t scratch_row = static_cast<std::uint32_t>(&kept - rows);
  const auto merge = [&](LaneRow& to, const LaneRow& from, const LaneRow& mask) HWY_ATTR {
    for (std::size_t i = 0; i < lanes; ++i) to.bits[i] = (from.bits[i] & mask.bits[i]) | (to.bits[i] & ~mask.bits[i]);
  };
  std::uint64_t steps = 0;
  while (true) {
    std::uint32_t least = kNoBlock;
    for (std::size_t i = 0; i < lanes; ++i) least = wanted.bits[i] < least ? wanted.bits[i] : least;
    if (least == kNoBlock) return true;
    std::uint32_t running = 0;
    for (std::size_t i = 0; i < lanes; ++i) {
      active.bits[i] = wanted.bits[i] == least ? ~0u : 0u;
      running += active.bits[i] & 1u;
    }
    const LaneBlock& block = program.blocks[least];
    steps += block.ops + 1;
    if (steps > ShaderExecutor::kMostSteps) return false;
    counts.ops += block.cost * running;
    counts.texture_requests += std::uint64_t{block.requests} * running;
    counts.instructions += std::uint64_t{instructions[least]} * running;
    counts.lanes_issued += std::uint64_t{instructions[least]} * lanes;

    for (std::uint32_t i = 0; i < block.ops; ++i) {
      const LaneOp& op = program.ops[block.first_op + i];
      const LaneKernel kernel = kernels[static_cast<std::size_t>(op.code)];
      if (op.keeps && op.code != LaneCode::discard) {
        LaneOp aside = op;
        aside.result = scratch_row;
        kernel(aside, state);
        merge(rows[op.result], kept, active);
      } else {
        kernel(op, state);
      }
    }

    if (block.end == BlockEnd::done)
      for (std::size_t i = 0; i < lanes; ++i) wanted.bits[i] |= active.bits[i];  // kNoBlock
    for (std::uint32_t j = 0; j < block.edges; ++j) {
      std::uint32_t any = 0;
      // Lanes that take an edge are no longer active. The first edge of a switch takes those that are left.
      const std::uint32_t place = block.end == BlockEnd::switched ? (j + 1) % block.edges : j;
      const LaneEdge& taken = program.edges[block.first_edge + place];
      const bool is_last = j + 1 == block.edges;
      for (std::size_t i = 0; i < lanes; ++i) {
        const std::uint32_t condition = block.condition == kNoRow ? 0 : rows[block.condition].bits[i];
        const std::uint32_t holds = is_last                         ? ~0u
                                    : block.end == BlockEnd::branch ? condition
                                    : condition == taken.literal    ? ~0u
                                                                    : 0u;
        takes.bits[i] = active.bits[i] & holds;
        active.bits[i] &= ~holds;
        any |= takes.bits[i];
      }
      if (any == 0) continue;
      for (std::uint32_t i = 0; i < taken.copies; ++i) {
        const LaneOp& copy = program.ops[taken.first_copy + i];
        merge(rows[copy.result], rows[copy.a], takes);
      }
      for (std::size_t i = 0; i < lanes; ++i) wanted.bits[i] = takes.bits[i] != 0 ? taken.target : wanted.bits[i];
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(run_program_kernel);

namespace {
constexpr std::size_t kScratchRows = 3;  // of the kernel, and the blocks that lanes want
}

ShaderExecutor::ShaderExecutor(const LaneProgram& program) : program_(program), rows_(program.rows + kScratchRows) {
  for (const auto& [row, bits] : program.constants) rows_[row].bits.fill(bits);
  for (const LaneBlock& block : program.blocks) {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < block.ops; ++i) {
      const LaneOp& op = program.ops[block.first_op + i];
      count += (!op.is_free && info_of(op.code).cost.total() != 0) || op.code == LaneCode::image;
    }
    instructions_.push_back(count);
  }
}

bool ShaderExecutor::run(const ShaderResources& resources, std::size_t count, std::uint64_t active,
                         std::uint64_t helpers, ShaderCounts& counts) {
  constexpr std::size_t kGroup = 16;
  const std::size_t lanes = std::min((count + kGroup - 1) / kGroup * kGroup, kShaderLanes);
  LaneRow* const scratch = &rows_[program_.rows];
  LaneRow &wanted = scratch[2], &helper_row = rows_[kHelperRow];
  for (std::size_t i = 0; i < kShaderLanes; ++i) {
    const bool runs = i < count && (active >> i & 1) != 0;
    wanted.bits[i] = runs ? 0u : ~0u;
    helper_row.bits[i] = runs && (helpers >> i & 1) == 0 ? 0u : ~0u;
    counts.invocations += runs;
  }
  for (std::uint32_t i = 0; i < program_.memory_rows; ++i) rows_[program_.first_memory + i].bits.fill(0);
  const bool ends = HWY_DYNAMIC_DISPATCH(run_program_kernel)(program_, resources, rows_.data(), scratch, wanted, lanes,
                                                             instructions_.data(), counts);
  if (!ends)
    for (std::size_t i = 0; i < lanes; ++i)
      if (wanted.bits[i] != ~0u) helper_row.bits[i] = ~0u;
  return ends;
}

std::uint64_t ShaderExecutor::kept() const {
  std::uint64_t lanes = 0;
  for (std::size_t i = 0; i < kShaderLanes; ++i) lanes |= std::uint64_t{rows_[kHelperRow].bits[i] == 0} << i;
  return lanes;
}

}  // namespace beampipe
#endif
