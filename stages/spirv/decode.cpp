#include "stages/spirv/decode.h"

#include <algorithm>
#include <string>

#include "stages/spirv/block_order.h"
#include "stages/spirv/decoder.h"

namespace beampipe {

// The instructions of a block of the module.
struct Decoder::Block {
  std::uint32_t label = 0;  // id
  std::span<const Instruction> phis = {}, others = {};
  Instruction end = {};
  BlockEdges edges = {};
};

std::vector<Decoder::Block> Decoder::split_blocks() const {
  const std::span<const Instruction> body = module_.body();
  std::vector<Block> blocks;
  std::unordered_map<std::uint32_t, std::uint32_t> numbers;  // of blocks, by label
  for (const Instruction& instruction : body)
    if (instruction.op == spv::OpLabel) numbers.emplace(instruction.result, static_cast<std::uint32_t>(numbers.size()));
  const auto number_of = [&](std::uint32_t label) {
    const auto found = numbers.find(label);
    if (found == numbers.end()) throw ShaderError("a branch leaves the shader's function");
    return found->second;
  };
  std::size_t first = 0, phis = 0;
  bool ends_invocation = false;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Instruction& instruction = body[i];
    const std::span<const std::uint32_t> operands = instruction.operands;
    if (instruction.op == spv::OpLabel) {
      blocks.push_back({.label = instruction.result});
      first = i + 1, phis = 0, ends_invocation = false;
      continue;
    }
    if (blocks.empty()) continue;  // OpFunction
    Block& block = blocks.back();
    phis += instruction.op == spv::OpPhi;
    switch (instruction.op) {
      case spv::OpLoopMerge:
        block.edges.structure = {number_of(operands[0]), number_of(operands[1])};
        break;
      case spv::OpSelectionMerge:
        block.edges.structure = {number_of(operands[0])};
        break;
      case spv::OpBranch:
        block.edges.successors = {number_of(operands[0])};
        break;
      case spv::OpBranchConditional:
        block.edges.successors = {number_of(operands[1]), number_of(operands[2])};
        break;
      case spv::OpSwitch:
        for (std::size_t j = 1; j < operands.size(); j += 2) block.edges.successors.push_back(number_of(operands[j]));
        break;
      case spv::OpFunctionCall:
        ends_invocation |= module_.ends_invocation(operands[0]);
        continue;
      case spv::OpReturn:
      case spv::OpKill:
      case spv::OpTerminateInvocation:
      case spv::OpUnreachable:
        break;
      default:
        continue;
    }
    if (instruction.op == spv::OpLoopMerge || instruction.op == spv::OpSelectionMerge) continue;
    block.phis = body.subspan(first, phis);
    block.others = body.subspan(first + phis, i - first - phis);
    block.end = instruction;
    if (ends_invocation) block.end = {.op = spv::OpKill};
  }
  for (const Block& block : blocks)
    if (block.end.op == spv::OpNop) throw ShaderError("a block ends in a way that is not supported");
  return blocks;
}

void Decoder::decode_instruction(const Instruction& instruction) {
  if (instruction.type != 0) require_room(instruction.type);
  switch (instruction.op) {
    case spv::OpNop:
    case spv::OpLoopMerge:
    case spv::OpSelectionMerge:
      return;
    case spv::OpVariable:
      return define_variable(instruction);
    case spv::OpUndef:
      return define(instruction, zeros(instruction.type));
    case spv::OpAccessChain:
    case spv::OpInBoundsAccessChain:
      return access_chain(instruction);
    case spv::OpLoad: {
      const ShaderPointer& from = pointer(instruction.operands[0]);
      if (from.space == ShaderPointer::Space::images)
        values_[instruction.result].handle = load_handle(from);
      else
        define(instruction, load(from));
      return;
    }
    case spv::OpStore:
      return store(pointer(instruction.operands[0]), Parts(parts(instruction.operands[1])));
    case spv::OpCopyMemory:
      return store(pointer(instruction.operands[0]), load(pointer(instruction.operands[1])));
    case spv::OpFunctionCall:
      if (module_.ends_invocation(instruction.operands[0])) return;  // at the end of the block
      throw ShaderError("SPIRV-Tools cannot inline a function of the shader");
    case spv::OpDemoteToHelperInvocation:
      draft_.program.discards = true;
      return add({.code = LaneCode::discard});
    case spv::OpIsHelperInvocationEXT: {
      const Row result = draft_.add_row(DraftRow::Kind::value);
      add({.code = LaneCode::copy, .result = result, .a = kHelperRow});
      return define(instruction, {result});
    }
    case spv::OpExtInst:
      if (module_.is_glsl(instruction.operands[0])) return decode_glsl(instruction);
      break;
    default:
      if (decode_arithmetic(instruction) || decode_image(instruction)) return;
  }
  throw ShaderError(name_of(instruction.op) + " is not supported");
}

// `places`: in the order in which blocks run, of the module's blocks.
void Decoder::decode_end(const Block& block, const std::vector<std::uint32_t>& places) {
  const std::span<const std::uint32_t> operands = block.end.operands;
  const auto edge_to = [&](std::size_t successor, std::uint32_t literal = 0) {
    block_->edges.push_back({.target = places[block.edges.successors[successor]], .literal = literal});
  };
  switch (block.end.op) {
    case spv::OpBranch:
      block_->end = BlockEnd::jump;
      edge_to(0);
      break;
    case spv::OpBranchConditional:
      block_->end = BlockEnd::branch;
      block_->condition = part(operands[0]);
      edge_to(0), edge_to(1);
      break;
    case spv::OpSwitch: {
      if (scalar_of(module_.definition(operands[0]).type).width != 32)
        throw ShaderError("OpSwitch of an integer that has not 32 bits is not supported");
      block_->end = BlockEnd::switched;
      block_->condition = part(operands[0]);
      for (std::size_t i = 0; i < block.edges.successors.size(); ++i) edge_to(i, i == 0 ? 0 : operands[2 * i]);
      break;
    }
    case spv::OpKill:
    case spv::OpTerminateInvocation:
      draft_.program.discards = true;
      add({.code = LaneCode::discard});
      break;
    default:
      break;  // done
  }
}

Draft Decoder::decode() {
  draft_.program.tests_early = module_.has_mode(spv::ExecutionModeEarlyFragmentTests);
  const std::vector<Block> blocks = split_blocks();
  if (blocks.empty()) throw ShaderError("the shader's function is empty");
  const std::vector<std::uint32_t> order = block_order([&] {
    std::vector<BlockEdges> edges;
    for (const Block& block : blocks) edges.push_back(block.edges);
    return edges;
  }());
  std::vector<std::uint32_t> places(blocks.size(), 0);
  for (std::uint32_t i = 0; i < order.size(); ++i) places[order[i]] = i;

  draft_.blocks.resize(order.size());
  block_ = &draft_.blocks[0];
  for (const Instruction& instruction : module_.globals())
    if (instruction.op == spv::OpVariable) define_variable(instruction);
  for (const std::uint32_t number : order)
    for (const Instruction& phi : blocks[number].phis) {
      Parts rows;
      require_room(phi.type);
      const std::uint32_t count = parts_of(phi.type);
      for (std::uint32_t i = 0; i < count; ++i) rows.push_back(draft_.add_row(DraftRow::Kind::value));
      define(phi, std::move(rows));
    }
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    block_ = &draft_.blocks[i];
    if (i != 0) made_.clear();
    for (const Instruction& instruction : blocks[order[i]].others) decode_instruction(instruction);
    decode_end(blocks[order[i]], places);
  }

  // Which block of the draft a label is.
  std::unordered_map<std::uint32_t, std::uint32_t> by_label;
  for (std::uint32_t i = 0; i < order.size(); ++i) by_label.emplace(blocks[order[i]].label, i);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    for (const Instruction& phi : blocks[order[i]].phis) {
      const Parts to = parts(phi.result);
      for (std::size_t j = 0; j + 1 < phi.operands.size(); j += 2) {
        const auto from_block = by_label.find(phi.operands[j + 1]);
        if (from_block == by_label.end()) continue;  // it is never reached
        block_ = &draft_.blocks[from_block->second];
        const Parts from = parts(phi.operands[j]);
        for (DraftEdge& edge : block_->edges)
          if (edge.target == i)
            for (std::size_t k = 0; k < to.size(); ++k) {
              count_op();
              edge.copies.emplace_back(to[k], from[k]);
            }
      }
    }
  }
  return std::move(draft_);
}

Draft decode(const ShaderModule& module) { return Decoder(module).decode(); }

}  // namespace beampipe
