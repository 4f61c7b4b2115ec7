#include "stages/spirv/module_limits.h"

#include <algorithm>
#include <string>
#include <unordered_map>
#include <vector>

#include "stages/spirv/module_words.h"

namespace beampipe {
namespace {

using Operands = std::span<const std::uint32_t>;

void require_at_most(std::uint64_t most, std::uint64_t found, const char* what) {
  if (found > most) throw ShaderError("expected at most " + std::to_string(most) + ' ' + what);
}

// How many parts types have: themselves, and the parts of what they are made of.
class TypeParts {
 public:
  // Elements of arrays count if the optimizer would make variables of them: if there are at most so many.
  static constexpr std::uint32_t kOneElement = 1, kReplacedElements = 100;
  explicit TypeParts(std::uint32_t most_elements) : most_elements_(most_elements) {}

  // Returns how many parts the instruction brings: those of the type that it defines, or of its result.
  std::uint64_t add(spv::Op op, Operands operands) {
    const auto at = [&](std::size_t i) { return i < operands.size() ? operands[i] : 0; };
    switch (op) {
      case spv::OpConstant:
        if (operands.size() == 3) constants_[at(1)] = at(2);
        return 0;
      case spv::OpTypeArray:
        return parts_[at(0)] = 1 + of(at(1)) * elements(at(2));
      case spv::OpTypeVector:
      case spv::OpTypeMatrix:
      case spv::OpTypeRuntimeArray:
      case spv::OpTypeSampledImage:
        return parts_[at(0)] = 1 + of(at(1));
      case spv::OpTypePointer:
        return parts_[at(0)] = 1 + of(at(2));
      case spv::OpTypeStruct:
      case spv::OpTypeFunction: {
        std::uint64_t parts = 1;
        for (std::size_t i = 1; i < operands.size(); ++i) parts += of(at(i));
        return parts_[at(0)] = std::min(parts, kMany);
      }
      default: {  // the first operand of what has a type
        const auto type = parts_.find(at(0));
        return type == parts_.end() ? 0 : type->second;
      }
    }
  }

  std::uint64_t of(std::uint32_t type) const {
    const auto found = parts_.find(type);
    return found == parts_.end() ? 1 : std::min(found->second, kMany);
  }

 private:
  static constexpr std::uint64_t kMany = ModuleLimits::kParts + 1;

  std::uint32_t elements(std::uint32_t length) const {
    const auto found = constants_.find(length);
    return found == constants_.end() || found->second > most_elements_ ? 1 : found->second;
  }

  std::uint32_t most_elements_;
  std::unordered_map<std::uint32_t, std::uint64_t> parts_;  // by id
  std::unordered_map<std::uint32_t, std::uint32_t> constants_;
};

// What functions have, with what they call.
class Inlining {
 public:
  explicit Inlining(std::span<const std::uint32_t> words) {
    TypeParts types(TypeParts::kReplacedElements);
    Sizes globals;
    Function* function = nullptr;
    for_each_instruction(words, [&](spv::Op op, Operands operands) {
      const std::uint64_t parts = types.add(op, operands);
      if (op == spv::OpFunction) function = &functions_[operands[1]];
      if (!function) {
        if (op == spv::OpVariable && operands[2] == spv::StorageClassPrivate) globals.parts += parts;
        return;
      }
      function->sizes += {.words = 1 + operands.size(), .blocks = op == spv::OpLabel, .parts = parts};
      if (op == spv::OpFunctionCall) function->calls.push_back(operands[2]);
    });
    globals.check();
  }

  void check() {
    for (auto& [id, function] : functions_) visit(function);
  }

 private:
  struct Sizes {
    std::uint64_t words = 0, blocks = 0, parts = 0;
    Sizes& operator+=(const Sizes& other) {
      words += other.words, blocks += other.blocks, parts += other.parts;
      return *this;
    }
    void check() const {
      require_at_most(ModuleLimits::kInlinedWords, words, "words of a function, with those that it calls");
      require_at_most(ModuleLimits::kBlocks, blocks, "blocks of a function, with those that it calls");
      require_at_most(ModuleLimits::kParts, parts, "parts of values of a function, with those that it calls");
    }
  };
  struct Function {
    enum class State { unknown, open, known };
    Sizes sizes;
    std::vector<std::uint32_t> calls;
    State state = State::unknown;
  };

  // As deep as functions call each other, which is at most ModuleLimits::kBlocks.
  const Sizes& visit(Function& function) {
    if (function.state == Function::State::open) throw ShaderError("a function of the shader calls itself");
    if (function.state == Function::State::known) return function.sizes;
    function.state = Function::State::open;
    function.sizes.check();
    for (const std::uint32_t called : function.calls) {
      function.sizes += visit(functions_.at(called));
      function.sizes.check();
    }
    function.state = Function::State::known;
    return function.sizes;
  }

  std::unordered_map<std::uint32_t, Function> functions_;
};

// How far values and pointers are from what they come from: through copies, changes of parts, and variables.
class Origins {
 public:
  // Of the function's instructions, in their order.
  void add(spv::Op op, Operands operands) {
    // What follows are the indices of parts.
    const std::size_t ids = op == spv::OpCompositeExtract ? 3 : op == spv::OpCompositeInsert ? 4 : operands.size();
    for (const std::uint32_t operand : operands.first(ids)) charge(of(operand).steps);
    switch (op) {
      case spv::OpVariable:
        origins_[operands[1]] = {operands[1], 1};
        break;
      case spv::OpCopyObject:
      case spv::OpAccessChain:
      case spv::OpInBoundsAccessChain:
        origins_[operands[1]] = {variable_of(operands[2]), of(operands[2]).steps + 1};
        break;
      case spv::OpCompositeInsert:
        origins_[operands[1]].steps = of(operands[3]).steps + 1;
        break;
      case spv::OpLoad:
        origins_[operands[1]].steps = stored_[variable_of(operands[2])] + 1;
        break;
      case spv::OpStore: {
        const std::uint32_t variable = variable_of(operands[0]);
        std::uint64_t& steps = stored_[variable];
        steps = (variable == operands[0] ? of(operands[1]).steps : steps) + 1;  // the whole, or a part
        charge(steps);
        break;
      }
      default:
        break;
    }
  }

  std::uint32_t variable_of(std::uint32_t pointer) const { return of(pointer).variable; }

 private:
  struct Origin {
    std::uint32_t variable = 0;  // id; 0: none
    std::uint64_t steps = 0;
  };
  Origin of(std::uint32_t id) const {
    const auto found = origins_.find(id);
    return found == origins_.end() ? Origin{} : found->second;
  }
  void charge(std::uint64_t steps) {
    require_at_most(ModuleLimits::kSteps, all_steps_ += steps,
                    "steps from values back to what they are copies or changes of");
  }

  std::unordered_map<std::uint32_t, Origin> origins_;
  std::unordered_map<std::uint32_t, std::uint64_t> stored_;  // steps of what variables have
  std::uint64_t all_steps_ = 0;
};

// How many ways out a block has.
std::uint64_t ways(spv::Op op, Operands operands) {
  switch (op) {
    case spv::OpBranch:
      return 1;
    case spv::OpBranchConditional:
      return 2;
    case spv::OpSwitch:
      return operands.size() / 2;
    default:
      return 0;
  }
}

}  // namespace

void check_module(std::span<const std::uint32_t> words) {
  TypeParts types(TypeParts::kOneElement);
  std::unordered_map<std::uint32_t, std::uint64_t> decorations;  // by what they decorate
  std::uint64_t blocks = 0, parts = 0, built_ins = 0, group_decorations = 0;
  for_each_instruction(words, [&](spv::Op op, Operands operands) {
    blocks += op == spv::OpLabel;
    require_at_most(ModuleLimits::kBlocks, blocks, "blocks");
    parts += types.add(op, operands);
    require_at_most(ModuleLimits::kParts, parts, "parts of types and values");
    if (operands.empty()) return;
    if (op == spv::OpDecorate) ++decorations[operands[0]];
    const std::size_t decoration = op == spv::OpDecorate ? 1 : op == spv::OpMemberDecorate ? 2 : operands.size();
    built_ins += decoration < operands.size() && operands[decoration] == spv::DecorationBuiltIn;
    require_at_most(ModuleLimits::kBuiltIns, built_ins, "decorations of built-in variables");
    if (op == spv::OpGroupDecorate || op == spv::OpGroupMemberDecorate)
      group_decorations += decorations[operands[0]] * operands.size();
    require_at_most(ModuleLimits::kGroupDecorations, group_decorations, "decorations by groups");
  });
}

void check_calls(std::span<const std::uint32_t> words) { Inlining(words).check(); }

void check_values(std::span<const std::uint32_t> words) {
  TypeParts types(TypeParts::kReplacedElements);
  Origins origins;
  std::unordered_map<std::uint32_t, std::uint64_t> stores;  // by variable
  std::unordered_map<std::uint32_t, std::uint64_t> parts;
  std::uint64_t all_ways = 0, blocks = 0, values = 0;
  for_each_instruction(words, [&](spv::Op op, Operands operands) {
    const std::uint64_t here = types.add(op, operands);
    if (op == spv::OpVariable && (operands[2] == spv::StorageClassFunction || operands[2] == spv::StorageClassPrivate))
      parts[operands[1]] = here;
    origins.add(op, operands);
    if (op == spv::OpStore || op == spv::OpCopyMemory) ++stores[origins.variable_of(operands[0])];
    all_ways += ways(op, operands);
    blocks += op == spv::OpLabel;
    values += blocks > 0;
  });
  require_at_most(ModuleLimits::kBlockValues, blocks * values, "blocks times instructions");
  // A variable that is stored to once needs no phis; others may need one in each block, with an operand for each way.
  std::uint64_t changing = 0;
  for (const auto& [variable, count] : stores)
    if (count > 1) changing += parts[variable];
  require_at_most(ModuleLimits::kPhiOperands, changing * all_ways, "ways between blocks, times variables that change");
}

}  // namespace beampipe
