// Modules that are valid, and that would take SPIRV-Tools or the decoder minutes, all memory or the whole stack.
#include "stages/spirv/module.h"
#include "stages/spirv/module_words.h"
#include "tests/message_of.h"
#include "tests/stages/spirv/shader_text.h"

namespace beampipe {
namespace {

std::string error_of(const ShaderParts& parts) {
  const std::vector<std::uint32_t> words = assembled(shader_text(parts));
  return message_of<ShaderError>([&] { load_fragment_shader(words); });
}

// With every # as the number, for numbers from first to end.
std::string repeated(const std::string& text, int first, int end) {
  std::string all;
  for (int i = first; i < end; ++i)
    for (const char c : text) all += c == '#' ? std::to_string(i) : std::string(1, c);
  return all;
}

// As repeated(), where @ is the number before.
std::string chained(const std::string& text, int first, int end) {
  std::string all;
  for (int i = first; i < end; ++i) {
    std::string one = repeated(text, i, i + 1);
    for (std::size_t at = one.find('@'); at != std::string::npos; at = one.find('@'))
      one.replace(at, 1, std::to_string(i - 1));
    all += one;
  }
  return all;
}

// %fun@, of so many instructions.
std::string function_text(const std::string& instructions) {
  return "%fun@ = OpFunction %void None %action\n%start@ = OpLabel\n" + instructions + "OpReturn\nOpFunctionEnd\n";
}
// %fun`first` to %fun`end - 1`, each of which calls the next one.
std::string functions_that_call_the_next(int first, int end) {
  return chained(function_text("%call@ = OpFunctionCall %void %fun#\n"), first + 1, end + 1);
}

TEST(SpirvLimits, FunctionsThatCallThemselves) {
  const std::string first = functions_that_call_the_next(0, 1);
  // In a cycle, and from no live code.
  EXPECT_EQ(error_of({.body = "",
                      .functions = first + chained(function_text("%call@ = OpFunctionCall %void %fun0\n"), 2, 3)}),
            "a function of the shader calls itself");
  EXPECT_EQ(error_of({.body = "%call = OpFunctionCall %void %fun0\n",
                      .functions = first + chained(function_text("%call@ = OpFunctionCall %void %fun1\n"), 2, 3)}),
            "a function of the shader calls itself");
}

// Each function calls the next one.
ShaderParts chain_of_calls(int functions) {
  return {.body = "%call = OpFunctionCall %void %fun0\n",
          .functions = functions_that_call_the_next(0, functions - 1) +
                       chained(function_text("OpStore %iout %u1111\n"), functions, functions + 1)};
}

TEST(SpirvLimits, LongChainsOfCalls) {
  TestShader shader(chain_of_calls(1000));
  shader.run();
  EXPECT_EQ(shader.integer(2, 3), 1u);
  EXPECT_EQ(error_of(chain_of_calls(20000)), "expected at most 4096 blocks");
}

// 2^20 calls of the last function.
TEST(SpirvLimits, FunctionsThatCallTheNextOneTwice) {
  const std::string twice =
      function_text("%call@ = OpFunctionCall %void %fun#\n%again@ = OpFunctionCall %void %fun#\n");
  EXPECT_EQ(error_of({.body = "%call = OpFunctionCall %void %fun0\n",
                      .functions = chained(twice, 1, 21) + chained(function_text(""), 21, 22)}),
            "expected at most 4096 blocks of a function, with those that it calls");
}

TEST(SpirvLimits, StructuresOfTwoStructures) {
  const auto with_depth = [](int depth) {
    const std::string last = std::to_string(depth);
    return ShaderParts{.body = "",
                       .globals = "%pair0 = OpTypeStruct %float %float\n" +
                                  chained("%pair# = OpTypeStruct %pair@ %pair@\n", 1, depth + 1) +
                                  "%to_pair = OpTypePointer Private %pair" + last +
                                  "\n%pairs = OpVariable %to_pair Private\n"};
  };
  EXPECT_EQ(error_of(with_depth(8)), "no error");
  EXPECT_EQ(error_of(with_depth(30)), "expected at most 1048576 parts of types and values");
}

TEST(SpirvLimits, DeepArrays) {
  EXPECT_EQ(error_of({.body = "",
                      .globals = "%list0 = OpTypeArray %float %u1\n" +
                                 chained("%list# = OpTypeArray %list@ %u1\n", 1, 10000)}),
            "expected at most 1048576 parts of types and values");
}

// 2^12 parts, which are read very often.
TEST(SpirvLimits, LargeValuesThatAreReadOften) {
  EXPECT_EQ(error_of({.body = "%pairs = OpVariable %to_pair Function\n; begin\n" +
                              repeated("%x# = OpLoad %pair11 %pairs\nOpStore %pairs %x#\n", 0, 10000),
                      .globals = "%pair0 = OpTypeStruct %float %float\n" +
                                 chained("%pair# = OpTypeStruct %pair@ %pair@\n", 1, 12) +
                                 "%to_pair = OpTypePointer Function %pair11\n"}),
            "expected at most 1048576 parts of types and values");
}

// 10^8 numbers, of which the optimizer would make variables.
TEST(SpirvLimits, ArraysOfArrays) {
  EXPECT_EQ(error_of({.body = R"(
%s = OpVariable %to_a3 Function
; begin
%to_x = OpAccessChain %pu %s %u1 %u1 %u1 %u1
OpStore %to_x %vi0
%all = OpLoad %a3 %s
%y = OpCompositeExtract %uint %all 1 1 1 1
%r = OpCompositeConstruct %u4 %y %y %y %y
OpStore %iout %r
)",
                      .globals = "%hundred = OpConstant %uint 100\n%a0 = OpTypeArray %uint %hundred\n" +
                                 chained("%a# = OpTypeArray %a@ %hundred\n", 1, 4) +
                                 "%to_a3 = OpTypePointer Function %a3\n"}),
            "expected at most 1048576 parts of values of a function, with those that it calls");
}

TEST(SpirvLimits, BuiltInVariables) {
  EXPECT_EQ(error_of({.body = "",
                      .globals = repeated("%coord# = OpVariable %in_v4 Input\n", 0, 5000),
                      .decorations = repeated("OpDecorate %coord# BuiltIn FragCoord\n", 0, 5000)}),
            "expected at most 256 decorations of built-in variables");
}

// Each is validated with all functions.
TEST(SpirvLimits, EntryPoints) {
  std::vector<std::uint32_t> words = assembled(shader_text(chain_of_calls(1000)));
  std::size_t at = kModuleHeaderWords;
  while ((words[at] & 0xffffu) != spv::OpEntryPoint) at += words[at] >> 16;
  const std::vector<std::uint32_t> entry(words.begin() + static_cast<std::ptrdiff_t>(at),
                                         words.begin() + static_cast<std::ptrdiff_t>(at + (words[at] >> 16)));
  for (int i = 0; i < 10000; ++i)
    words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), entry.begin(), entry.end());
  EXPECT_EQ(message_of<ShaderError>([&] { load_fragment_shader(words); }),
            "expected a module with one entry point, a fragment shader's");
}

// A group has 1000 decorations and 1000 members.
TEST(SpirvLimits, DecorationsOfGroups) {
  EXPECT_EQ(error_of({.body = "",
                      .globals = repeated("%t# = OpTypeStruct %uint\n", 0, 1000),
                      .decorations = repeated("OpDecorate %group Restrict\n", 0, 1000) +
                                     "%group = OpDecorationGroup\nOpGroupDecorate %group" + repeated(" %t#", 0, 1000) +
                                     "\n"}),
            "expected at most 65536 decorations by groups");
}

ShaderParts switch_with(int cases) {
  return {.body = "%x = OpCompositeExtract %uint %vi 0\nOpSelectionMerge %after None\nOpSwitch %x %after" +
                  repeated(" # %case#", 0, cases) + "\n" +
                  repeated("%case# = OpLabel\nOpStore %iout %r#\nOpBranch %after\n", 0, cases) + "%after = OpLabel\n",
          .globals = repeated("%n# = OpConstant %uint 1#\n%r# = OpConstantComposite %u4 %n# %n# %n# %n#\n", 0, cases)};
}

TEST(SpirvLimits, LongSwitches) {
  TestShader shader(switch_with(2000));
  shader.set_integer(3, 0, 5, 1999), shader.set_integer(3, 0, 6, 2000);
  shader.run();
  EXPECT_EQ(shader.integer(0, 4), 10u);
  EXPECT_EQ(shader.integer(0, 5), 11999u);
  EXPECT_EQ(shader.integer(0, 6), 0u);  // there is no such case
  EXPECT_EQ(error_of(switch_with(10000)), "expected at most 4096 blocks");
}

// Each of 1000 cases changes its own variable, so that all need a phi with an operand for each case.
TEST(SpirvLimits, VariablesThatDependOnTheWay) {
  EXPECT_EQ(error_of({.body = repeated("%x# = OpVariable %pu Function\n", 0, 1000) + "; begin\n" +
                              repeated("OpStore %x# %u1\n", 0, 1000) +
                              "%n = OpCompositeExtract %uint %vi 0\nOpSelectionMerge %after None\nOpSwitch %n %after" +
                              repeated(" # %case#", 0, 1000) + "\n" +
                              repeated("%case# = OpLabel\nOpStore %x# %u2_\nOpBranch %after\n", 0, 1000) +
                              "%after = OpLabel\n%sum0 = OpLoad %uint %x0\n" +
                              chained("%y# = OpLoad %uint %x#\n%sum# = OpIAdd %uint %sum@ %y#\n", 1, 1000) +
                              "%r = OpCompositeConstruct %u4 %sum999 %sum999 %sum999 %sum999\nOpStore %iout %r\n"}),
            "expected at most 524288 ways between blocks, times variables that change");
  // One variable with as many parts, in 600 cases.
  const auto table_with = [](const std::string& row) {
    return ShaderParts{.body =
                           "%table = OpVariable %to_table Function\n; begin\n%n = OpCompositeExtract %uint %vi 0\n"
                           "%place = OpAccessChain %pu %table %u1 %u2_\n"
                           "OpSelectionMerge %after None\nOpSwitch %n %after" +
                           repeated(" # %case#", 0, 600) + "\n" +
                           repeated("%case# = OpLabel\nOpStore %place %u2_\nOpBranch %after\n", 0, 600) +
                           "%after = OpLabel\n%y = OpLoad %uint %place\n"
                           "%r = OpCompositeConstruct %u4 %y %y %y %y\nOpStore %iout %r\n",
                       .globals =
                           "%ten = OpConstant %uint 10\n%hundred = OpConstant %uint 100\n"
                           "%row = OpTypeArray %uint %hundred\n%table_type = OpTypeArray %row " +
                           row + "\n%to_table = OpTypePointer Function %table_type\n"};
  };
  EXPECT_EQ(error_of(table_with("%ten")), "expected at most 524288 ways between blocks, times variables that change");
  EXPECT_EQ(error_of(table_with("%u3_")), "no error");
}

// Values that the optimizer keeps for each of 3000 blocks.
TEST(SpirvLimits, ValuesInManyBlocks) {
  EXPECT_EQ(
      error_of(
          {.body = "%x = OpCompositeExtract %uint %vi 0\n%yes = OpINotEqual %bool %x %u0\n%y0 = OpIAdd %uint %x %u1\n" +
                   chained("%y# = OpIAdd %uint %y@ %x\n", 1, 10000) +
                   repeated("OpSelectionMerge %after# None\nOpBranchConditional %yes %inside# %after#\n"
                            "%inside# = OpLabel\nOpStore %iout %vi\nOpBranch %after#\n%after# = OpLabel\n",
                            0, 1500) +
                   "%r = OpCompositeConstruct %u4 %y9999 %x %x %x\nOpStore %iout %r\n"}),
      "expected at most 33554432 blocks times instructions");
}

TEST(SpirvLimits, ChainsOfPointersAndComposites) {
  constexpr const char* kSteps =
      "expected at most 8388608 steps from values back to what they are copies or changes of";
  EXPECT_EQ(error_of({.body = "%p0 = OpCopyObject %out_v4 %out\n" +
                              chained("%p# = OpCopyObject %out_v4 %p@\nOpStore %p# %va\n", 1, 10000)}),
            kSteps);
  EXPECT_EQ(error_of({.body = "%p0 = OpAccessChain %out_v4 %out\n" +
                              chained("%p# = OpAccessChain %out_v4 %p@\nOpStore %p# %va\n", 1, 10000)}),
            kSteps);
  EXPECT_EQ(error_of({.body = "%made0 = OpCopyObject %v4 %va\n" +
                              chained("%made# = OpCompositeInsert %v4 %f1 %made@ 1\n", 1, 10000) +
                              "OpStore %out %made9999\n"}),
            kSteps);
  // Through a variable, as a whole and by parts.
  EXPECT_EQ(error_of({.body = "%local = OpVariable %to_v4 Function\n; begin\n" +
                              repeated("%x# = OpLoad %v4 %local\n%made# = OpCompositeInsert %v4 %f1 %x# 1\n"
                                       "OpStore %local %made#\n",
                                       0, 10000),
                      .globals = "%to_v4 = OpTypePointer Function %v4\n"}),
            kSteps);
  EXPECT_EQ(error_of({.body = "%local = OpVariable %to_v4 Function\n; begin\n" +
                              repeated("%p# = OpAccessChain %to_float %local %u1\nOpStore %p# %f1\n", 0, 10000),
                      .globals = "%to_v4 = OpTypePointer Function %v4\n%to_float = OpTypePointer Function %float\n"}),
            kSteps);
}

std::string lists_of(int elements) {
  return "%length = OpConstant %uint " + std::to_string(elements) + R"(
%list = OpTypeArray %uint %length
%to_list = OpTypePointer Function %list
%zeros = OpConstantNull %list
)";
}

// Arrays that pass through phis change places in each turn of a loop.
TEST(SpirvLimits, PhisOfLargeArrays) {
  const auto with_arrays = [](int arrays, int length) {
    const std::string last = std::to_string(arrays - 1);
    return ShaderParts{.body = R"(
%local = OpVariable %to_list Function
; begin
%times = OpCompositeExtract %uint %vi 0
%array = OpCompositeInsert %list %times %zeros 1
OpBranch %header
%header = OpLabel
%n = OpPhi %uint %u0 %entry %n1 %again
%p0 = OpPhi %list %array %entry %p)" +
                               last + " %again\n" + chained("%p# = OpPhi %list %zeros %entry %p@ %again\n", 1, arrays) +
                               R"(
%more = OpULessThan %bool %n %times
OpLoopMerge %after %again None
OpBranchConditional %more %again %after
%again = OpLabel
%n1 = OpIAdd %uint %n %u1
OpBranch %header
%after = OpLabel
OpStore %local %p1
%index = OpCompositeExtract %uint %vi 1
%place = OpAccessChain %pu %local %index
%x = OpLoad %uint %place
%r = OpCompositeConstruct %u4 %x %x %x %x
OpStore %iout %r
)",
                       .globals = lists_of(length)};
  };
  TestShader shader(with_arrays(3, 400));
  for (std::uint32_t lane = 0; lane < 9; ++lane)
    shader.set_integer(3, 0, lane, lane), shader.set_integer(3, 1, lane, 1);
  shader.run();
  for (std::uint32_t lane = 0; lane < 9; ++lane) EXPECT_EQ(shader.integer(0, lane), lane % 3 == 1 ? lane : 0);
  EXPECT_EQ(error_of(with_arrays(200, 4000)), "the shader has more than 262144 lane operations");
}

// Each change of an array is a value of 4000 parts.
TEST(SpirvLimits, ManyLargeValues) {
  EXPECT_EQ(error_of({.body = "%local = OpVariable %to_list Function\n; begin\n%x = OpCompositeExtract %uint %vi 0\n"
                              "%made0 = OpCompositeInsert %list %x %zeros 0\n" +
                              chained("%made# = OpCompositeInsert %list %x %made@ #\n", 1, 1500) + R"(
OpStore %local %made1499
%place = OpAccessChain %pu %local %x
%y = OpLoad %uint %place
%r = OpCompositeConstruct %u4 %y %y %y %y
OpStore %iout %r
)",
                      .globals = lists_of(4000)}),
            "the shader's values have more than 4194304 parts");
}

// Two parts of two parts of two parts ...: 2^30 numbers.
TEST(SpirvLimits, ConstantsOfTwoConstants) {
  EXPECT_EQ(
      error_of({.body = "%local = OpVariable %to_list29 Function\n; begin\nOpStore %local %two29\n"
                        "%x = OpCompositeExtract %uint %vi 0\n%place = OpAccessChain %pu %local" +
                        repeated(" %x", 0, 30) +
                        "\n%y = OpLoad %uint %place\n%r = OpCompositeConstruct %u4 %y %y %y %y\nOpStore %iout %r\n",
                .globals = "%list0 = OpTypeArray %uint %u2_\n%two0 = OpConstantComposite %list0 %u1 %u2_\n" +
                           chained("%list# = OpTypeArray %list@ %u2_\n"
                                   "%two# = OpConstantComposite %list# %two@ %two@\n",
                                   1, 30) +
                           "%to_list29 = OpTypePointer Function %list29\n"}),
      "expected at most 1048576 parts of values of a function, with those that it calls");
}

TEST(SpirvLimits, DeepNesting) {
  const auto with_depth = [](int depth) {
    std::string body = "%x = OpCompositeExtract %uint %vi 0\n%yes = OpINotEqual %bool %x %u0\n", ends;
    for (int i = 0; i < depth; ++i) {
      const std::string n = std::to_string(i);
      body += "OpSelectionMerge %m" + n + " None\nOpBranchConditional %yes %y" + n + " %m" + n + "\n%y" + n +
              " = OpLabel\n";
      ends = "OpBranch %m" + n + "\n%m" + n + " = OpLabel\n" + ends;
    }
    return ShaderParts{.body = body + "OpStore %iout %u1111\n" + ends};
  };
  EXPECT_EQ(error_of(with_depth(60)), "no error");
  EXPECT_EQ(error_of(with_depth(250)).substr(0, 15), "invalid SPIR-V:");
}

// The optimizer would repeat the body of the inner loop 10^18 times.
TEST(SpirvLimits, LoopsThatAskToBeUnrolled) {
  TestShader shader(ShaderParts{.body = R"(
%i_ = OpVariable %pu Function
%j_ = OpVariable %pu Function
; begin
%times = OpCompositeExtract %uint %vi 0
OpStore %i_ %u0
OpBranch %outer
%outer = OpLabel
OpLoopMerge %outer_end %outer_next Unroll
OpBranch %outer_check
%outer_check = OpLabel
%n = OpLoad %uint %i_
%outer_more = OpULessThan %bool %n %many
OpBranchConditional %outer_more %inside %outer_end
%inside = OpLabel
OpStore %j_ %u0
OpBranch %inner
%inner = OpLabel
OpLoopMerge %inner_end %inner_next Unroll
OpBranch %inner_check
%inner_check = OpLabel
%m = OpLoad %uint %j_
%inner_more = OpULessThan %bool %m %many
OpBranchConditional %inner_more %inner_inside %inner_end
%inner_inside = OpLabel
%stops = OpIEqual %bool %m %times
OpSelectionMerge %goes_on None
OpBranchConditional %stops %found %goes_on
%found = OpLabel
%r = OpCompositeConstruct %u4 %n %m %m %m
OpStore %iout %r
OpReturn
%goes_on = OpLabel
OpBranch %inner_next
%inner_next = OpLabel
%m1 = OpIAdd %uint %m %u1
OpStore %j_ %m1
OpBranch %inner
%inner_end = OpLabel
OpBranch %outer_next
%outer_next = OpLabel
%n1 = OpIAdd %uint %n %u1
OpStore %i_ %n1
OpBranch %outer
%outer_end = OpLabel
)",
                                .globals = R"(
%many = OpConstant %uint 1000000000
)"});
  EXPECT_LT(shader.program.blocks.size(), 20u);
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) shader.set_integer(3, 0, lane, lane);
  EXPECT_TRUE(shader.run());
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) EXPECT_EQ(shader.integer(1, lane), lane);
}

// A small module that has a large id must not take memory for all ids before it.
TEST(SpirvLimits, LargeIds) {
  std::vector<std::uint32_t> words = assembled(shader_text({.body = ""}));
  const std::uint32_t bound = std::exchange(words[3], 1u << 20);
  std::size_t at = kModuleHeaderWords;
  while ((words[at] & 0xffffu) != spv::OpLabel) at += words[at] >> 16;
  ASSERT_LT(words[at + 1], bound);
  words[at + 1] = (1u << 20) - 1;  // nothing branches to it
  const ShaderModule module(simplify(words, {}));
  EXPECT_LT(module.bound(), 100u);
}

}  // namespace
}  // namespace beampipe
