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

// One run of a program.
class ProgramRun {
 public:
  ProgramRun(const LaneState& state, std::uint32_t most_steps)
      : program_(*state.program),
        most_steps_(most_steps),
        state_(state),
        active_(state.rows[kActiveRow]),
        aside_(state.rows[program_.rows + kAsideRow]),
        takes_(state.rows[program_.rows + kTakesRow]),
        spent_(state.rows[program_.rows + kSpentRow]),
        wanted_(state.rows[program_.rows + kWantedRow]) {
    spent_.bits.fill(0);
  }

  void run(const std::uint32_t* instructions, ShaderCounts& counts) {
    while (true) {
      const std::uint32_t number = least_wanted();
      if (number == kNoBlock) break;
      const LaneBlock& block = program_.blocks[number];
      const std::uint64_t running = activate(number);
      if (running == 0) continue;  // all have been stopped
      counts.ops += block.cost * running;
      counts.texture_requests += block.requests * running;
      counts.instructions += instructions[number] * running;
      counts.lanes_issued += std::uint64_t{instructions[number]} * state_.lanes;
      run_ops(block);
      leave(block);
    }
    counts.stopped += stopped_;
  }

 private:
  std::uint32_t least_wanted() const {
    std::uint32_t least = kNoBlock;
    for (std::size_t i = 0; i < state_.lanes; ++i) least = wanted_.bits[i] < least ? wanted_.bits[i] : least;
    return least;
  }

  // Lanes that want the block run, unless all their blocks together are too many. Returns how many.
  std::uint32_t activate(std::uint32_t number) {
    const std::uint32_t steps = program_.blocks[number].steps;
    std::uint32_t running = 0, most = 0;
    for (std::size_t i = 0; i < state_.lanes; ++i) {
      active_.bits[i] = wanted_.bits[i] == number ? ~0u : 0u;
      running += active_.bits[i] & 1u;
      spent_.bits[i] += active_.bits[i] & steps;
      most = spent_.bits[i] > most ? spent_.bits[i] : most;
    }
    return most > most_steps_ ? running - stop() : running;
  }

  // Returns how many of the active lanes stop.
  std::uint32_t stop() {
    std::uint32_t stopped = 0;
    for (std::size_t i = 0; i < state_.lanes; ++i) {
      if (active_.bits[i] == 0 || spent_.bits[i] <= most_steps_) continue;
      active_.bits[i] = 0, wanted_.bits[i] = kNoBlock;
      state_.rows[kHelperRow].bits[i] = ~0u;
      ++stopped;
    }
    stopped_ += stopped;
    return stopped;
  }

  void run_ops(const LaneBlock& block) {
    const LaneKernels& kernels = lane_kernels();
    for (std::uint32_t i = 0; i < block.ops; ++i) {
      const LaneOp& op = program_.ops[block.first_op + i];
      const LaneKernel kernel = kernels[static_cast<std::size_t>(op.code)];
      if (!op.keeps) {
        kernel(op, state_);
        continue;
      }
      LaneOp aside = op;
      aside.result = program_.rows + kAsideRow;
      kernel(aside, state_);
      merge(state_.rows[op.result], aside_, active_);
    }
  }

  void merge(LaneRow& to, const LaneRow& from, const LaneRow& mask) {
    for (std::size_t i = 0; i < state_.lanes; ++i)
      to.bits[i] = (from.bits[i] & mask.bits[i]) | (to.bits[i] & ~mask.bits[i]);
  }

  // Lanes that have taken an edge are no longer active; the last one takes those that are left.
  void leave(const LaneBlock& block) {
    if (block.end == BlockEnd::done)
      for (std::size_t i = 0; i < state_.lanes; ++i) wanted_.bits[i] |= active_.bits[i];  // kNoBlock
    for (std::uint32_t i = 0; i < block.edges; ++i) {
      // The first edge of a switch comes last.
      const std::uint32_t place = block.end == BlockEnd::switched ? (i + 1) % block.edges : i;
      const LaneEdge& edge = program_.edges[block.first_edge + place];
      if (!choose_lanes(block, edge, i + 1 == block.edges)) continue;
      for (std::uint32_t j = 0; j < edge.copies; ++j) {
        const LaneOp& copy = program_.ops[edge.first_copy + j];
        merge(state_.rows[copy.result], state_.rows[copy.a], takes_);
      }
      for (std::size_t j = 0; j < state_.lanes; ++j)
        wanted_.bits[j] = takes_.bits[j] != 0 ? edge.target : wanted_.bits[j];
    }
  }

  // Which active lanes take the edge; they stop being active. False if none does.
  bool choose_lanes(const LaneBlock& block, const LaneEdge& edge, bool is_last) {
    std::uint32_t any = 0;
    const LaneRow& condition = is_last ? active_ : state_.rows[block.condition];
    const std::uint32_t literal = is_last || block.end == BlockEnd::branch ? ~0u : edge.literal;
    for (std::size_t i = 0; i < state_.lanes; ++i) {
      takes_.bits[i] = condition.bits[i] == literal ? active_.bits[i] : 0;
      active_.bits[i] &= ~takes_.bits[i];
      any |= takes_.bits[i];
    }
    return any != 0;
  }

  const LaneProgram& program_;
  std::uint32_t most_steps_;
  LaneState state_;
  LaneRow &active_, &aside_, &takes_, &spent_, &wanted_;
  std::uint32_t stopped_ = 0;
};

// `instructions`: of each block.
void run_program_kernel(const LaneState& state, const std::uint32_t* instructions, std::uint32_t most_steps,
                        ShaderCounts& counts) {
  ProgramRun(state, most_steps).run(instructions, counts);
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(run_program_kernel);

ShaderExecutor::ShaderExecutor(const LaneProgram& program)
    : program_(program), rows_(program.rows + HWY_NAMESPACE::kOwnRows) {
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

void ShaderExecutor::run(const ShaderResources& resources, std::size_t count, std::uint64_t active,
                         std::uint64_t helpers, ShaderCounts& counts, std::uint32_t most_steps) {
  constexpr std::size_t kGroup = 16;
  const std::size_t lanes = std::min((count + kGroup - 1) / kGroup * kGroup, kShaderLanes);
  LaneRow &wanted = rows_[program_.rows + HWY_NAMESPACE::kWantedRow], &helper_row = rows_[kHelperRow];
  for (std::size_t i = 0; i < kShaderLanes; ++i) {
    const bool runs = i < count && (active >> i & 1) != 0;
    wanted.bits[i] = runs ? 0u : ~0u;
    helper_row.bits[i] = runs && (helpers >> i & 1) == 0 ? 0u : ~0u;
    counts.invocations += runs;
  }
  for (std::uint32_t i = 0; i < program_.memory_rows; ++i) rows_[program_.first_memory + i].bits.fill(0);
  HWY_DYNAMIC_DISPATCH(run_program_kernel)
  ({rows_.data(), lanes, &program_, &resources}, instructions_.data(), most_steps, counts);
}

std::uint64_t ShaderExecutor::kept() const {
  std::uint64_t lanes = 0;
  for (std::size_t i = 0; i < kShaderLanes; ++i) lanes |= std::uint64_t{rows_[kHelperRow].bits[i] == 0} << i;
  return lanes;
}

}  // namespace beampipe
#endif
