// What a module says to coverage and tests, found without loading it.
#include "tests/stages/spirv/shader_text.h"

namespace beampipe::shader_effects_test {

ShaderEffects effects_of(const ShaderParts& parts) { return beampipe::effects_of(assembled(shader_text(parts))); }

TEST(ShaderEffects, AreThoseOfItsInstructions) {
  const ShaderEffects none = effects_of({.body = ""});
  EXPECT_FALSE(none.discards || none.tests_early || none.writes_depth || none.writes_samples);
  EXPECT_TRUE(effects_of({.body = "", .modes = "OpExecutionMode %main EarlyFragmentTests\n"}).tests_early);
  EXPECT_FALSE(effects_of({.body = "", .modes = "OpExecutionMode %main DepthReplacing\n"}).tests_early);
  const std::string leave = R"(
OpSelectionMerge %on None
OpBranchConditional %true %leave %on
%leave = OpLabel
OpKill
%on = OpLabel
)";
  EXPECT_TRUE(effects_of({.body = leave}).discards);
  const ShaderEffects depth =
      effects_of({.body = "",
                  .globals = "%to_float = OpTypePointer Output %float\n%depth = OpVariable %to_float Output\n",
                  .decorations = "OpDecorate %depth BuiltIn FragDepth\n",
                  .interface = "%depth"});
  EXPECT_TRUE(depth.writes_depth);
  EXPECT_FALSE(depth.writes_samples);
  const ShaderEffects by_group =
      effects_of({.body = "",
                  .globals = "%to_float = OpTypePointer Output %float\n%depth = OpVariable %to_float Output\n",
                  .decorations = "OpDecorate %group BuiltIn FragDepth\n%group = OpDecorationGroup\n"
                                 "OpGroupDecorate %group %depth\n",
                  .interface = "%depth"});
  EXPECT_TRUE(by_group.writes_depth);
}

// The same built-in is an input and an output.
TEST(ShaderEffects, AMaskThatIsReadIsNotWritten) {
  for (const std::string storage : {"Input", "Output"}) {
    const ShaderEffects effects =
        effects_of({.body = "",
                    .globals = "%array = OpTypeArray %int %u1\n%to_array = OpTypePointer " + storage +
                               " %array\n%mask = OpVariable %to_array " + storage + "\n",
                    .decorations = "OpDecorate %mask BuiltIn SampleMask\n",
                    .interface = "%mask"});
    EXPECT_EQ(effects.writes_samples, storage == "Output");
    EXPECT_FALSE(effects.writes_depth);
  }
}

// Instructions that end beyond the module, or are empty, end the search.
TEST(ShaderEffects, BrokenModulesSayNothing) {
  const std::vector<std::uint32_t> words = assembled(shader_text({.body = ""}));
  for (std::size_t count = 0; count < 40; ++count) {
    std::vector<std::uint32_t> cut(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(count));
    EXPECT_FALSE(beampipe::effects_of(cut).discards);
    cut.resize(count + 1, 0xffff0000u | spv::OpDecorate);
    EXPECT_FALSE(beampipe::effects_of(cut).writes_depth);
  }
}

}  // namespace beampipe::shader_effects_test
