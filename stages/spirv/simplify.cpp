#include "stages/spirv/simplify.h"

#include <spirv-tools/libspirv.hpp>
#include <spirv-tools/optimizer.hpp>
#include <spirv/unified1/spirv.hpp>
#include <string>
#include <utility>

#include "stages/spirv/module_limits.h"
#include "stages/spirv/module_words.h"
#include "stages/spirv/shader_error.h"

namespace beampipe {
namespace {

constexpr spv_target_env kEnvironment = SPV_ENV_UNIVERSAL_1_6;

// Keeps the first message, as one line.
class FirstMessage {
 public:
  spvtools::MessageConsumer consumer() {
    return [this](spv_message_level_t level, const char*, const spv_position_t&, const char* message) {
      if (level > SPV_MSG_ERROR || !text_.empty() || !message) return;
      for (const char c : std::string(message)) text_ += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
      if (text_.size() > 300) text_.resize(300);
    };
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// Of any words.
void require_fragment_shader(std::span<const std::uint32_t> words) {
  std::size_t entries = 0;
  bool is_fragment = false, has_shader = false;
  for_each_instruction(words, [&](spv::Op op, std::span<const std::uint32_t> operands) {
    const std::uint32_t first = operands.empty() ? ~0u : operands[0];
    if (op == spv::OpCapability) {
      has_shader |= first == spv::CapabilityShader;
      if (first == spv::CapabilityKernel) throw ShaderError("expected a shader, found an OpenCL kernel");
    }
    if (op != spv::OpEntryPoint) return;
    ++entries;
    is_fragment = first == spv::ExecutionModelFragment;
  });
  if (!has_shader || entries != 1 || !is_fragment)
    throw ShaderError("expected a module with one entry point, a fragment shader's");
}

void validate(std::span<const std::uint32_t> words) {
  FirstMessage message;
  spvtools::SpirvTools tools(kEnvironment);
  tools.SetMessageConsumer(message.consumer());
  spvtools::ValidatorOptions options;
  options.SetSkipBlockLayout(true);  // Mesa's zink lays push constants out in its own way
  options.SetUniversalLimit(spv_validator_limit_max_id_bound, ModuleLimits::kIds);
  options.SetUniversalLimit(spv_validator_limit_max_control_flow_nesting_depth, ModuleLimits::kNesting);
  options.SetUniversalLimit(spv_validator_limit_max_struct_depth, 32);
  if (!tools.Validate(words.data(), words.size(), options)) throw ShaderError("invalid SPIR-V: " + message.text());
}

// Hints would make the optimizer leave functions as they are, which are then not supported; or repeat the bodies of
// loops as often as a constant says.
void remove_hints(std::vector<std::uint32_t>& words) {
  for_each_instruction(words, [&](spv::Op op, std::span<const std::uint32_t> operands) {
    const auto clear = [&](std::uint32_t bits) {
      words[static_cast<std::size_t>(&operands[2] - words.data())] &= ~bits;
    };
    if (op == spv::OpFunction) clear(spv::FunctionControlDontInlineMask);
    if (op == spv::OpLoopMerge) clear(spv::LoopControlUnrollMask);
  });
}

// The module after the passes that `add` registers.
template <class Add>
void optimize(std::vector<std::uint32_t>& words, Add&& add) {
  FirstMessage message;
  spvtools::Optimizer optimizer(kEnvironment);
  optimizer.SetMessageConsumer(message.consumer());
  add(optimizer);
  spvtools::OptimizerOptions options;
  options.set_run_validator(false);  // done already, without rules about layouts
  options.set_max_id_bound(4 * ModuleLimits::kIds);
  std::vector<std::uint32_t> optimized;
  if (!optimizer.Run(words.data(), words.size(), &optimized, options))
    throw ShaderError("SPIRV-Tools cannot simplify the shader" +
                      (message.text().empty() ? std::string() : ": " + message.text()));
  words = std::move(optimized);
}

}  // namespace

std::vector<std::uint32_t> simplify(std::span<const std::uint32_t> words, const Specialization& specialization) {
  if (words.size() > ModuleLimits::kWords)
    throw ShaderError("expected at most " + std::to_string(ModuleLimits::kWords) + " words of SPIR-V, found " +
                      std::to_string(words.size()));
  if (words.size() < kModuleHeaderWords || words[0] != spv::MagicNumber)
    throw ShaderError("expected SPIR-V in this machine's byte order");
  require_fragment_shader(words);
  check_module(words);
  validate(words);

  std::vector<std::uint32_t> module(words.begin(), words.end());
  remove_hints(module);
  optimize(module, [&](spvtools::Optimizer& optimizer) {
    optimizer.RegisterPass(spvtools::CreateStripDebugInfoPass())
        .RegisterPass(spvtools::CreateSetSpecConstantDefaultValuePass(specialization))
        .RegisterPass(spvtools::CreateFlattenDecorationPass())
        .RegisterPass(spvtools::CreateFreezeSpecConstantValuePass())
        .RegisterPass(spvtools::CreateFoldSpecConstantOpAndCompositePass());
  });
  check_calls(module);
  optimize(module, [](spvtools::Optimizer& optimizer) {
    optimizer.RegisterPass(spvtools::CreateWrapOpKillPass())
        .RegisterPass(spvtools::CreateDeadBranchElimPass())
        .RegisterPass(spvtools::CreateMergeReturnPass())
        .RegisterPass(spvtools::CreateInlineExhaustivePass())
        .RegisterPass(spvtools::CreateEliminateDeadFunctionsPass());
  });
  check_values(module);
  optimize(module, [](spvtools::Optimizer& optimizer) {
    optimizer.RegisterPerformancePasses().RegisterPass(spvtools::CreateCompactIdsPass());
  });
  return module;
}

}  // namespace beampipe
