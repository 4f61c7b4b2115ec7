#include "stages/spirv/simplify.h"

#include <algorithm>
#include <functional>
#include <spirv-tools/libspirv.hpp>
#include <spirv-tools/optimizer.hpp>
#include <spirv/unified1/spirv.hpp>
#include <string>

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

void validate(std::span<const std::uint32_t> words) {
  FirstMessage message;
  spvtools::SpirvTools tools(kEnvironment);
  tools.SetMessageConsumer(message.consumer());
  spvtools::ValidatorOptions options;
  options.SetSkipBlockLayout(true);  // Mesa's zink lays push constants out in its own way
  options.SetUniversalLimit(spv_validator_limit_max_id_bound, ModuleLimits::kIds);
  options.SetUniversalLimit(spv_validator_limit_max_control_flow_nesting_depth, 256);
  options.SetUniversalLimit(spv_validator_limit_max_struct_depth, 32);
  if (!tools.Validate(words.data(), words.size(), options)) throw ShaderError("invalid SPIR-V: " + message.text());
}

// Functions may call each other so that inlining doubles the module with each of them.
class InlinedWords {
 public:
  // Of a valid module, in which no function calls itself.
  explicit InlinedWords(std::span<const std::uint32_t> words) {
    Function* function = nullptr;
    for (std::size_t at = 5; at < words.size();) {
      const std::uint32_t count = words[at] >> 16;
      const auto opcode = static_cast<spv::Op>(words[at] & 0xffffu);
      if (opcode == spv::OpFunction) function = &functions_[words[at + 2]];
      if (function) function->words += count;
      if (function && opcode == spv::OpFunctionCall) function->calls.push_back(words[at + 3]);
      at += count;
    }
  }

  // Of the function that needs the most; no more than a little beyond the limit.
  std::size_t most() {
    std::size_t most = 0;
    for (const auto& [id, function] : functions_) most = std::max(most, of(id));
    return most;
  }

 private:
  struct Function {
    std::size_t words = 0, inlined = 0;  // inlined: 0 before it is known
    std::vector<std::uint32_t> calls;
  };
  std::size_t of(std::uint32_t id) {
    Function& function = functions_[id];
    if (function.inlined != 0) return function.inlined;
    std::size_t sum = function.words;
    for (const std::uint32_t called : function.calls)
      if (sum <= ModuleLimits::kInlinedWords) sum += of(called);
    return function.inlined = sum;
  }

  std::unordered_map<std::uint32_t, Function> functions_;
};

void require_fragment_shader(std::span<const std::uint32_t> words) {
  std::size_t entries = 0;
  bool is_fragment = false, has_shader = false;
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
    const auto opcode = static_cast<spv::Op>(words[at] & 0xffffu);
    if (opcode == spv::OpCapability) {
      has_shader |= words[at + 1] == spv::CapabilityShader;
      if (words[at + 1] == spv::CapabilityKernel) throw ShaderError("expected a shader, found an OpenCL kernel");
    }
    if (opcode != spv::OpEntryPoint) continue;
    ++entries;
    is_fragment = words[at + 1] == spv::ExecutionModelFragment;
  }
  if (!has_shader || entries != 1 || !is_fragment)
    throw ShaderError("expected a module with one entry point, a fragment shader's");
}

}  // namespace

std::vector<std::uint32_t> simplify(std::span<const std::uint32_t> words, const Specialization& specialization) {
  if (words.size() > ModuleLimits::kWords)
    throw ShaderError("expected at most " + std::to_string(ModuleLimits::kWords) + " words of SPIR-V, found " +
                      std::to_string(words.size()));
  if (words.size() < 5 || words[0] != spv::MagicNumber)
    throw ShaderError("expected SPIR-V in this machine's byte order");
  validate(words);
  require_fragment_shader(words);
  if (InlinedWords(words).most() > ModuleLimits::kInlinedWords)
    throw ShaderError("the shader's functions call each other so often that inlining them takes more than " +
                      std::to_string(ModuleLimits::kInlinedWords) + " words");

  FirstMessage message;
  spvtools::Optimizer optimizer(kEnvironment);
  optimizer.SetMessageConsumer(message.consumer());
  optimizer.RegisterPass(spvtools::CreateStripDebugInfoPass())
      .RegisterPass(spvtools::CreateSetSpecConstantDefaultValuePass(specialization))
      .RegisterPass(spvtools::CreateFlattenDecorationPass())
      .RegisterPass(spvtools::CreateFreezeSpecConstantValuePass())
      .RegisterPass(spvtools::CreateFoldSpecConstantOpAndCompositePass())
      .RegisterPerformancePasses();
  spvtools::OptimizerOptions options;
  options.set_run_validator(false);  // done above, without rules about layouts
  options.set_max_id_bound(4 * ModuleLimits::kIds);
  std::vector<std::uint32_t> simplified;
  if (!optimizer.Run(words.data(), words.size(), &simplified, options))
    throw ShaderError("SPIRV-Tools cannot simplify the shader" +
                      (message.text().empty() ? std::string() : ": " + message.text()));
  return simplified;
}

}  // namespace beampipe
