#include "stages/spirv/module.h"

#include <spirv-tools/libspirv.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

#include "stages/spirv/module_limits.h"
#include "stages/spirv/shader_error.h"

namespace beampipe {
namespace {

using Kind = ShaderType::Kind;

std::uint32_t capped(std::uint64_t parts) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(parts, ShaderType::kTooMany));
}

}  // namespace

std::string name_of(spv::Op op) { return std::string("Op") + spvOpcodeString(static_cast<std::uint32_t>(op)); }

ShaderModule::ShaderModule(std::vector<std::uint32_t> words) : words_(std::move(words)) {
  if (words_.size() < 5 || words_[3] > 4 * ModuleLimits::kIds) throw ShaderError("expected a simplified module");
  definitions_.resize(words_[3]);
  types_.resize(words_[3]);
  read_instructions();
}

void ShaderModule::read_instructions() {
  struct Reader {
    ShaderModule& module;
    std::uint32_t function = 0;  // id
    std::uint32_t blocks = 0;    // of it, so far
  } reader{*this};
  const auto read = [](void* data, const spv_parsed_instruction_t* parsed) {
    Reader& to = *static_cast<Reader*>(data);
    ShaderModule& module = to.module;
    // The parser's words may be a copy in another byte order; ours have this one, and the same layout.
    Instruction instruction{static_cast<spv::Op>(parsed->opcode), parsed->type_id, parsed->result_id, {}};
    const std::size_t skipped = 1u + (parsed->type_id != 0) + (parsed->result_id != 0);
    instruction.operands = std::span(parsed->words + skipped, parsed->num_words - skipped);
    if (instruction.op == spv::OpFunction) to.function = instruction.result, to.blocks = 0;
    if (to.function == 0)
      module.globals_.push_back(instruction);
    else if (to.function == module.entry_)
      module.body_.push_back(instruction);
    if (instruction.result != 0) module.definitions_[instruction.result] = instruction;
    if (instruction.op == spv::OpFunctionEnd) to.function = 0;

    const std::span<const std::uint32_t> operands = instruction.operands;
    switch (instruction.op) {
      case spv::OpLabel:
        ++to.blocks;
        break;
      case spv::OpKill:
      case spv::OpTerminateInvocation:
        if (to.blocks == 1) module.ending_.insert(to.function);
        break;
      case spv::OpEntryPoint:
        module.entry_ = operands[1];
        break;
      case spv::OpExecutionMode:
        module.modes_.push_back(static_cast<spv::ExecutionMode>(operands[1]));
        break;
      case spv::OpExtInstImport:
        if (std::string_view(reinterpret_cast<const char*>(operands.data())) == "GLSL.std.450")
          module.glsl_ = instruction.result;
        break;
      case spv::OpDecorate:
        module.decorations_[{operands[0], kWhole, operands[1]}] = operands.size() > 2 ? operands[2] : 0;
        break;
      case spv::OpMemberDecorate:
        module.decorations_[{operands[0], operands[1], operands[2]}] = operands.size() > 3 ? operands[3] : 0;
        break;
      default:
        module.add_type(instruction);
    }
    return SPV_SUCCESS;
  };
  const std::unique_ptr<spv_context_t, decltype(&spvContextDestroy)> context(spvContextCreate(SPV_ENV_UNIVERSAL_1_6),
                                                                             &spvContextDestroy);
  if (spvBinaryParse(context.get(), &reader, words_.data(), words_.size(), nullptr, read, nullptr) != SPV_SUCCESS)
    throw ShaderError("SPIRV-Tools cannot read what it has simplified");
  if (body_.empty()) throw ShaderError("the shader's entry point has no function");
}

void ShaderModule::add_type(const Instruction& instruction) {
  const std::span<const std::uint32_t> operands = instruction.operands;
  ShaderType type;
  switch (instruction.op) {
    case spv::OpTypeBool:
      type = {.kind = Kind::boolean, .width = 32, .parts = 1};
      break;
    case spv::OpTypeInt:
      type = {.kind = Kind::integer, .width = operands[0], .parts = 1};
      break;
    case spv::OpTypeFloat:
      type = {.kind = Kind::number, .width = operands[0], .parts = 1};
      break;
    case spv::OpTypeVector:
    case spv::OpTypeMatrix:
      type = {.kind = instruction.op == spv::OpTypeVector ? Kind::vector : Kind::matrix,
              .element = operands[0],
              .count = operands[1],
              .parts = capped(std::uint64_t{types_[operands[0]].parts} * operands[1])};
      break;
    case spv::OpTypeArray: {
      const std::uint32_t count = constant_word(operands[1]);
      type = {.kind = Kind::array,
              .element = operands[0],
              .count = count,
              .parts = capped(std::uint64_t{types_[operands[0]].parts} * count)};
      break;
    }
    case spv::OpTypeRuntimeArray:
      type = {.kind = Kind::array, .element = operands[0], .parts = ShaderType::kTooMany};
      break;
    case spv::OpTypeStruct: {
      std::uint64_t parts = 0;
      for (const std::uint32_t member : operands) parts += types_[member].parts;
      type = {.kind = Kind::structure, .members = {operands.begin(), operands.end()}, .parts = capped(parts)};
      break;
    }
    case spv::OpTypePointer:
      type = {.kind = Kind::pointer, .element = operands[1], .storage = static_cast<spv::StorageClass>(operands[0])};
      break;
    case spv::OpTypeImage:
      type = {.kind = Kind::image,
              .element = operands[0],
              .dim = static_cast<spv::Dim>(operands[1]),
              .depth = operands[2] == 1,
              .arrayed = operands[3] == 1,
              .multisampled = operands[4] == 1,
              .storage_image = operands[5] == 2};
      break;
    case spv::OpTypeSampler:
      type = {.kind = Kind::sampler};
      break;
    case spv::OpTypeSampledImage:
      type = {.kind = Kind::sampled_image, .element = operands[0]};
      break;
    default:
      return;
  }
  types_[instruction.result] = std::move(type);
}

const Instruction& ShaderModule::definition(std::uint32_t id) const { return definitions_[id]; }

std::optional<std::uint32_t> ShaderModule::decoration(std::uint32_t id, spv::Decoration decoration,
                                                      std::uint32_t member) const {
  const auto found = decorations_.find({id, member, static_cast<std::uint32_t>(decoration)});
  if (found == decorations_.end()) return std::nullopt;
  return found->second;
}

bool ShaderModule::has_mode(spv::ExecutionMode mode) const {
  return std::find(modes_.begin(), modes_.end(), mode) != modes_.end();
}

std::uint32_t ShaderModule::constant_word(std::uint32_t id) const {
  const Instruction& constant = definitions_[id];
  if (constant.op == spv::OpConstantNull) return 0;
  if (constant.op != spv::OpConstant || types_[constant.type].kind != Kind::integer || types_[constant.type].width > 32)
    throw ShaderError("expected an integer constant of at most 32 bits, found " + name_of(constant.op));
  return constant.operands[0];
}

}  // namespace beampipe
