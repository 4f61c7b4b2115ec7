// Lanes that go different ways: programs of nested selections, loops and switches against an interpreter of one lane.
#include "tests/stages/spirv/shader_text.h"
#include "tests/thorough.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kVariables = 4;
using Variables = std::array<std::uint32_t, kVariables>;

struct Statement {
  enum class Kind { assign, select, loop, choose, leave, again, end, discard };
  Kind kind;
  std::uint32_t to = 0, from = 0, operation = 0, number = 0;  // assign; select and loop: condition on `from`
  std::vector<std::vector<Statement>> bodies = {};            // select: yes, no; loop: one; choose: cases
  std::vector<bool> falls = {};                               // choose: does a case go on into the next one?
};
using Body = std::vector<Statement>;
using Kind = Statement::Kind;

class Writer {
 public:
  explicit Writer(std::uint32_t seed) : random_(seed) {}

  Body body(int depth, bool in_loop) {
    Body made;
    const std::uint32_t count = 1 + random_() % 3;
    for (std::uint32_t n = 0; n < count; ++n) {
      made.push_back({Kind::assign, pick(kVariables), pick(kVariables), pick(4), 1 + pick(9)});
      if (depth == 0) continue;
      switch (pick(8)) {
        case 0:
        case 1:
          made.push_back(
              {Kind::select, 0, pick(kVariables), 0, pick(4), {body(depth - 1, in_loop), body(depth - 1, in_loop)}});
          break;
        case 2:
        case 3:
          made.push_back({Kind::loop, 0, pick(kVariables), 0, 1 + pick(5), {body(depth - 1, true)}});
          break;
        case 4: {
          Statement choose{Kind::choose, 0, pick(kVariables), 0, 0};
          for (std::uint32_t i = 0; i < 3; ++i) {
            choose.bodies.push_back(body(depth - 1, in_loop));
            choose.falls.push_back(pick(2) == 0);
          }
          made.push_back(choose);
          break;
        }
        case 5:
          if (in_loop)
            made.push_back(
                {Kind::select, 0, pick(kVariables), 0, pick(4), {{{pick(2) ? Kind::leave : Kind::again}}, {}}});
          break;
        case 6:
          if (pick(3) == 0)
            made.push_back(
                {Kind::select, 0, pick(kVariables), 0, pick(4), {{{pick(2) ? Kind::end : Kind::discard}}, {}}});
          break;
        default:
          break;
      }
    }
    return made;
  }

 private:
  std::uint32_t pick(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }
  std::mt19937 random_;
};

bool holds(const Statement& statement, const Variables& v) { return (v[statement.from] >> statement.number & 1u) != 0; }
std::uint32_t result(const Statement& s, const Variables& v) {
  switch (s.operation) {
    case 0:
      return v[s.to] + v[s.from];
    case 1:
      return v[s.to] ^ v[s.from] * s.number;
    case 2:
      return v[s.from] * s.number + 1;
    default:
      return v[s.to] >> 1;
  }
}

enum class Way { on, leave, again, end, discard };

Way interpret(const Body& body, Variables& v) {
  for (const Statement& s : body) {
    Way way = Way::on;
    switch (s.kind) {
      case Kind::assign:
        v[s.to] = result(s, v);
        break;
      case Kind::select:
        way = interpret(s.bodies[holds(s, v) ? 0 : 1], v);
        break;
      case Kind::loop: {
        const std::uint32_t times = s.number + v[s.from] % 3;
        for (std::uint32_t n = 0; n < times && (way == Way::on || way == Way::again); ++n)
          way = interpret(s.bodies[0], v);
        if (way == Way::leave || way == Way::again) way = Way::on;
        break;
      }
      case Kind::choose:
        for (std::size_t i = v[s.from] % 4; i < s.bodies.size(); ++i) {  // 3: none
          way = interpret(s.bodies[i], v);
          if (way != Way::on || !s.falls[i]) break;
        }
        break;
      case Kind::leave:
        return Way::leave;
      case Kind::again:
        return Way::again;
      case Kind::end:
        return Way::end;
      case Kind::discard:
        return Way::discard;
    }
    if (way != Way::on) return way;
  }
  return Way::on;
}

// The same program as SPIR-V.
class Assembler {
 public:
  ShaderParts parts(const Body& body) {
    for (std::uint32_t i = 0; i < kVariables; ++i) {
      const std::string n = std::to_string(i);
      line("%init" + n + " = OpCompositeExtract %uint %vi " + n);
      line("OpStore %x" + n + " %init" + n);
    }
    write(body, "", "");
    store();
    for (std::uint32_t i = 0; i < kVariables; ++i)
      variables_ += "%x" + std::to_string(i) + " = OpVariable %pu Function\n";
    std::string globals;
    for (std::uint32_t i = 5; i < 16; ++i)
      globals += "%n" + std::to_string(i) + " = OpConstant %uint " + std::to_string(i) + "\n";
    return {.body = variables_ + "; begin\n" + text_, .globals = globals};
  }

 private:
  std::string id() { return "%t" + std::to_string(next_++); }
  void line(const std::string& text) { text_ += text + "\n"; }
  std::string op(const std::string& text, const std::string& type = "%uint") {
    const std::string made = id(), name = text.substr(0, text.find(' '));
    line(made + " = " + name + " " + type + text.substr(name.size()));
    return made;
  }
  std::string load(std::uint32_t variable) { return op("OpLoad %x" + std::to_string(variable)); }
  std::string number(std::uint32_t value) {
    static const char* const kNames[] = {"%u0", "%u1", "%u2_", "%u3_", "%u4_"};
    return value < 5 ? kNames[value] : "%n" + std::to_string(value);
  }
  void store() {
    std::string all;
    for (std::uint32_t i = 0; i < kVariables; ++i) all += " " + load(i);
    line("OpStore %iout " + op("OpCompositeConstruct" + all, "%u4"));
  }

  // False if the end of the body is never reached: its block has ended.
  bool write(const Body& body, const std::string& merge, const std::string& next) {
    for (const Statement& s : body) {
      const std::string to = "%x" + std::to_string(s.to);
      switch (s.kind) {
        case Kind::assign: {
          std::string made;
          if (s.operation == 0) made = op("OpIAdd " + load(s.to) + " " + load(s.from));
          if (s.operation == 1)
            made = op("OpBitwiseXor " + load(s.to) + " " + op("OpIMul " + load(s.from) + " " + number(s.number)));
          if (s.operation == 2) made = op("OpIAdd " + op("OpIMul " + load(s.from) + " " + number(s.number)) + " %u1");
          if (s.operation == 3) made = op("OpShiftRightLogical " + load(s.to) + " %u1");
          line("OpStore " + to + " " + made);
          break;
        }
        case Kind::select: {
          const std::string yes = id(), no = id(), after = id();
          const std::string bit =
              op("OpBitwiseAnd " + op("OpShiftRightLogical " + load(s.from) + " " + number(s.number)) + " %u1");
          const std::string condition = op("OpINotEqual " + bit + " %u0", "%bool");
          line("OpSelectionMerge " + after + " None");
          line("OpBranchConditional " + condition + " " + yes + " " + no);
          line(yes + " = OpLabel");
          if (write(s.bodies[0], merge, next)) line("OpBranch " + after);
          line(no + " = OpLabel");
          if (write(s.bodies[1], merge, next)) line("OpBranch " + after);
          line(after + " = OpLabel");
          break;
        }
        case Kind::loop: {
          const std::string header = id(), check = id(), inside = id(), go_on = id(), after = id(), counter = id();
          variables_ += counter + " = OpVariable %pu Function\n";
          const std::string times = op("OpIAdd " + op("OpUMod " + load(s.from) + " %u3_") + " " + number(s.number));
          line("OpStore " + counter + " %u0");
          line("OpBranch " + header);
          line(header + " = OpLabel");
          line("OpLoopMerge " + after + " " + go_on + " None");
          line("OpBranch " + check);
          line(check + " = OpLabel");
          line("OpBranchConditional " + op("OpULessThan " + op("OpLoad " + counter) + " " + times, "%bool") + " " +
               inside + " " + after);
          line(inside + " = OpLabel");
          if (write(s.bodies[0], after, go_on)) line("OpBranch " + go_on);
          line(go_on + " = OpLabel");
          line("OpStore " + counter + " " + op("OpIAdd " + op("OpLoad " + counter) + " %u1"));
          line("OpBranch " + header);
          line(after + " = OpLabel");
          break;
        }
        case Kind::choose: {
          std::vector<std::string> labels{id(), id(), id()};
          const std::string after = id();
          const std::string which = op("OpUMod " + load(s.from) + " %u4_");
          line("OpSelectionMerge " + after + " None");
          line("OpSwitch " + which + " " + after + " 0 " + labels[0] + " 1 " + labels[1] + " 2 " + labels[2]);
          for (std::size_t i = 0; i < labels.size(); ++i) {
            line(labels[i] + " = OpLabel");
            if (write(s.bodies[i], merge, next))
              line("OpBranch " + (s.falls[i] && i + 1 < labels.size() ? labels[i + 1] : after));
          }
          line(after + " = OpLabel");
          break;
        }
        case Kind::leave:
          line("OpBranch " + merge);
          return false;
        case Kind::again:
          line("OpBranch " + next);
          return false;
        case Kind::end:
          store();
          line("OpReturn");
          return false;
        case Kind::discard:
          line("OpKill");
          return false;
      }
    }
    return true;
  }

  std::string text_, variables_;
  std::uint32_t next_ = 0;
};

TEST(SpirvFlow, RandomProgramsDoWhatAnInterpreterDoes) {
  std::size_t ended = 0, discarded = 0, most_blocks = 0;
  for (std::uint32_t seed = 0; seed < 80u * static_cast<unsigned>(thoroughness()); ++seed) {
    SCOPED_TRACE(seed);
    const Body body = Writer(seed).body(4, false);
    TestShader shader(Assembler().parts(body));
    most_blocks = std::max(most_blocks, shader.program.blocks.size());
    std::mt19937 random(seed);
    std::array<Variables, kShaderLanes> inputs;
    for (std::size_t lane = 0; lane < kShaderLanes; ++lane)
      for (std::uint32_t i = 0; i < kVariables; ++i)
        shader.set_integer(3, i, lane, inputs[lane][i] = static_cast<std::uint32_t>(random()));
    ASSERT_TRUE(shader.run());
    for (std::size_t lane = 0; lane < kShaderLanes; ++lane) {
      Variables expected = inputs[lane];
      const Way way = interpret(body, expected);
      const bool is_kept = (shader.executor.kept() >> lane & 1) != 0;
      ASSERT_EQ(is_kept, way != Way::discard) << lane;
      ended += way == Way::end, discarded += way == Way::discard;
      if (!is_kept) continue;
      for (std::uint32_t i = 0; i < kVariables; ++i) ASSERT_EQ(shader.integer(i, lane), expected[i]) << lane;
    }
  }
  EXPECT_GT(ended, 100u);  // each kind of way occurs
  EXPECT_GT(discarded, 100u);
  EXPECT_GT(most_blocks, 30u);
}

// What a lane finds does not depend on its neighbours, or on how many there are.
TEST(SpirvFlow, LanesDoNotDisturbEachOther) {
  const Body body = Writer(5).body(4, false);
  TestShader shader(Assembler().parts(body));
  std::mt19937 random(1);
  std::array<Variables, kShaderLanes> inputs, together;
  for (Variables& in : inputs)
    for (std::uint32_t& value : in) value = static_cast<std::uint32_t>(random());
  const auto set = [&](std::size_t lane, const Variables& in) {
    for (std::uint32_t i = 0; i < kVariables; ++i) shader.set_integer(3, i, lane, in[i]);
  };
  for (std::size_t lane = 0; lane < kShaderLanes; ++lane) set(lane, inputs[lane]);
  shader.run();
  const std::uint64_t kept = shader.executor.kept();
  for (std::size_t lane = 0; lane < kShaderLanes; ++lane)
    for (std::uint32_t i = 0; i < kVariables; ++i) together[lane][i] = shader.integer(i, lane);
  const ShaderCounts all = shader.counts;
  shader.counts = {};
  for (std::size_t lane = 0; lane < kShaderLanes; ++lane) {
    set(0, inputs[lane]);
    shader.run(1);
    EXPECT_EQ(shader.executor.kept(), kept >> lane & 1);
    for (std::uint32_t i = 0; i < kVariables; ++i) EXPECT_EQ(shader.integer(i, 0), together[lane][i]);
  }
  EXPECT_EQ(shader.counts.ops, all.ops);
  EXPECT_EQ(shader.counts.instructions, all.instructions);
  EXPECT_EQ(shader.counts.invocations, all.invocations);
}

// Two variables change places in each turn of a loop, so that their phis are copied to each other. Lines of a source
// may stand between them.
TEST(SpirvFlow, PhisOfALoopAreCopiedAllAtOnce) {
  TestShader shader(ShaderParts{
      .body = "%times = OpCompositeExtract %uint %vi 2\n" + loop_text(R"(
OpLine %file 1 1
%x = OpPhi %uint %vi0 %entry %y %again
OpNoLine
%y = OpPhi %uint %vi1 %entry %x %again
%n = OpPhi %uint %u0 %entry %n1 %again
)",
                                                                      "%goes_on = OpULessThan %bool %n %times\n",
                                                                      "%n1 = OpIAdd %uint %n %u1\n"),
      .integers = "%x %y %n %u0",
      .modes = "%file = OpString \"a file\"\n"});
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) {
    shader.set_integer(3, 0, lane, 100 + lane), shader.set_integer(3, 1, lane, 200 + lane);
    shader.set_integer(3, 2, lane, lane);
  }
  shader.run();
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) {
    EXPECT_EQ(shader.integer(0, lane), (lane % 2 ? 200 : 100) + lane);
    EXPECT_EQ(shader.integer(1, lane), (lane % 2 ? 100 : 200) + lane);
    EXPECT_EQ(shader.integer(2, lane), lane);
  }
}

TEST(SpirvFlow, FunctionsWithEarlyReturns) {
  TestShader shader(ShaderParts{.body = R"(
%y = OpFunctionCall %uint %collatz %vi0
)",
                                .integers = "%y %y %y %y",
                                .globals = "%number_to_number = OpTypeFunction %uint %uint",
                                .functions = R"(
%collatz = OpFunction %uint None %number_to_number
%start = OpFunctionParameter %uint
%begin = OpLabel
%steps = OpVariable %pu Function
%x_ = OpVariable %pu Function
OpStore %steps %u0
OpStore %x_ %start
OpBranch %loop
%loop = OpLabel
OpLoopMerge %never %continue None
OpBranch %inside
%inside = OpLabel
%now = OpLoad %uint %x_
%count = OpLoad %uint %steps
%is_one = OpIEqual %bool %now %u1
OpSelectionMerge %more None
OpBranchConditional %is_one %done %more
%done = OpLabel
OpReturnValue %count
%more = OpLabel
%half_ = OpUDiv %uint %now %u2_
%triple = OpIMul %uint %now %u3_
%up = OpIAdd %uint %triple %u1
%odd = OpBitwiseAnd %uint %now %u1
%is_odd = OpIEqual %bool %odd %u1
%next = OpSelect %uint %is_odd %up %half_
OpStore %x_ %next
%count1 = OpIAdd %uint %count %u1
OpStore %steps %count1
OpBranch %continue
%continue = OpLabel
OpBranch %loop
%never = OpLabel
OpUnreachable
OpFunctionEnd
)"});
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) shader.set_integer(3, 0, lane, lane + 1);
  ASSERT_TRUE(shader.run());
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) {
    std::uint32_t steps = 0;
    for (std::uint32_t x = lane + 1; x != 1; ++steps) x = x % 2 ? 3 * x + 1 : x / 2;
    EXPECT_EQ(shader.integer(0, lane), steps);
  }
}

// A loop of 20 turns calls, in its continue construct, a function that ends odd lanes in the turn of their number.
ShaderParts ending_in_continue(const std::string& how) {
  return {.body = loop_text("%n = OpPhi %uint %u0 %entry %n1 %again\n", "%goes_on = OpULessThan %bool %n %u20\n",
                            "%n1 = OpFunctionCall %uint %next_after %n %vi0\n"),
          .integers = "%n %vi0 %u0 %u0",
          .globals = R"(
%u20 = OpConstant %uint 20
%of_two = OpTypeFunction %uint %uint %uint
)",
          .functions = R"(
%next_after = OpFunction %uint None %of_two
%turn = OpFunctionParameter %uint
%number = OpFunctionParameter %uint
%begin = OpLabel
%odd = OpBitwiseAnd %uint %number %u1
%is_odd = OpIEqual %bool %odd %u1
%is_here = OpIEqual %bool %turn %number
%ends = OpLogicalAnd %bool %is_odd %is_here
OpSelectionMerge %stays None
OpBranchConditional %ends %leaves %stays
%leaves = OpLabel
)" + how + R"(
%stays = OpLabel
%next = OpIAdd %uint %turn %u1
OpReturnValue %next
OpFunctionEnd
)",
          .capabilities = "OpCapability DemoteToHelperInvocationEXT\nOpExtension \"SPV_KHR_terminate_invocation\"\n"};
}

TEST(SpirvFlow, InvocationsEndInFunctionsOfContinueConstructs) {
  std::uint64_t instructions = 0;
  for (const char* how : {"OpKill", "OpTerminateInvocation", "OpDemoteToHelperInvocation\nOpBranch %stays"}) {
    SCOPED_TRACE(how);
    TestShader shader(ending_in_continue(how));
    EXPECT_TRUE(shader.program.discards);
    for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) shader.set_integer(3, 0, lane, lane);
    EXPECT_TRUE(shader.run());
    EXPECT_EQ(shader.executor.kept(), ~std::uint64_t{0xaaaaa});
    for (std::uint32_t lane = 0; lane < kShaderLanes; lane += 2) {
      EXPECT_EQ(shader.integer(0, lane), 20u);
      EXPECT_EQ(shader.integer(1, lane), lane);
    }
    if (how == std::string("OpKill")) instructions = shader.counts.instructions;
  }
  TestShader goes_on(ending_in_continue("OpDemoteToHelperInvocation\nOpBranch %stays"));
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) goes_on.set_integer(3, 0, lane, lane);
  goes_on.run();
  EXPECT_LT(instructions, goes_on.counts.instructions);
}

// The compiler's hint changes nothing.
TEST(SpirvFlow, FunctionsThatAskNotToBeInlined) {
  TestShader shader(ShaderParts{.body = R"(
%y = OpFunctionCall %uint %twice %vi0
)",
                                .integers = "%y %y %y %y",
                                .globals = "%number_to_number = OpTypeFunction %uint %uint\n",
                                .functions = R"(
%twice = OpFunction %uint DontInline %number_to_number
%start = OpFunctionParameter %uint
%begin = OpLabel
%sum = OpIAdd %uint %start %start
OpReturnValue %sum
OpFunctionEnd
)"});
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) shader.set_integer(3, 0, lane, lane);
  shader.run();
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) EXPECT_EQ(shader.integer(2, lane), 2 * lane);
}

// Three times an odd number is never 0.
TEST(SpirvFlow, EndlessLoopsAreStopped) {
  TestShader shader(
      ShaderParts{.body = loop_text("%x = OpPhi %uint %vi0 %entry %x3 %again\n",
                                    "%goes_on = OpINotEqual %bool %x %u0\n", "%x3 = OpIMul %uint %x %u3_\n"),
                  .integers = "%x %u1 %u1 %u1"});
  EXPECT_TRUE(shader.run());
  shader.set_integer(3, 0, 5, 1), shader.set_integer(3, 0, 9, 1);
  EXPECT_FALSE(shader.run());
  EXPECT_EQ(shader.counts.stopped, 2u);
  EXPECT_EQ(shader.executor.kept(), ~(std::uint64_t{1} << 5 | std::uint64_t{1} << 9));
  EXPECT_EQ(shader.integer(1, 4), 1u);
}

// The number in the lane is counted down, in steps of about ten.
TEST(SpirvFlow, LanesMayBeStoppedSooner) {
  TestShader shader(
      ShaderParts{.body = loop_text("%x = OpPhi %uint %vi0 %entry %x1 %again\n",
                                    "%goes_on = OpINotEqual %bool %x %u0\n", "%x1 = OpISub %uint %x %u1\n"),
                  .integers = "%x %u1 %u1 %u1"});
  shader.set_integer(3, 0, 3, 50), shader.set_integer(3, 0, 4, 500);
  EXPECT_TRUE(shader.run());
  shader.executor.run(shader.resources, kShaderLanes, ~std::uint64_t{0}, 0, shader.counts, 2000);
  EXPECT_EQ(shader.counts.stopped, 1u);
  EXPECT_EQ(shader.executor.kept(), ~(std::uint64_t{1} << 4));
}

// A loop that only moves values around: 100 of them, which the last one enters at the front.
TEST(SpirvFlow, WhatLoopsMoveAroundIsBoundedToo) {
  constexpr int kValues = 100;
  std::string phis;
  for (int i = 0; i < kValues; ++i)
    phis +=
        "%x" + std::to_string(i) + " = OpPhi %uint %vi0 %entry %x" + std::to_string((i + 1) % kValues) + " %again\n";
  TestShader shader(ShaderParts{.body = loop_text(phis, "%goes_on = OpINotEqual %bool %x0 %u1\n", ""),
                                .integers = "%x0 %x1 %x2 %x3"});
  EXPECT_FALSE(shader.run(1));
  EXPECT_LE(shader.counts.instructions, ShaderExecutor::kMostSteps / kValues);  // one comparison each time
}

TEST(SpirvFlow, DemotedInvocationsGoOnAsHelpers) {
  TestShader shader(ShaderParts{.body = R"(
%goes = OpIEqual %bool %vi0 %u0
%before = OpIsHelperInvocationEXT %bool
OpSelectionMerge %end None
OpBranchConditional %goes %gone %end
%gone = OpLabel
OpDemoteToHelperInvocation
OpBranch %end
%end = OpLabel
%after_ = OpIsHelperInvocationEXT %bool
%y = OpSelect %uint %before %u1 %u0
%z = OpSelect %uint %after_ %u1 %u0
%f = OpCompositeExtract %float %va 0
%dx = OpDPdx %float %f
)",
                                .floats = "%dx %dx %dx %dx",
                                .integers = "%y %z %u0 %u0",
                                .capabilities = "OpCapability DemoteToHelperInvocationEXT\n"});
  EXPECT_TRUE(shader.program.discards);
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) {
    shader.set_integer(3, 0, lane, lane % 4), shader.set(0, 0, lane, static_cast<float>(lane * lane));
  }
  constexpr std::uint64_t kEvery = ~std::uint64_t{0};
  const std::uint64_t helpers = 0x2;  // lane 1
  shader.executor.run(shader.resources, kShaderLanes, kEvery, helpers, shader.counts);
  EXPECT_EQ(shader.counts.stopped, 0u);
  EXPECT_EQ(shader.executor.kept(), 0xeeeeeeeeeeeeeeeeu & ~helpers);
  EXPECT_EQ(shader.integer(0, 0), 0u);
  EXPECT_EQ(shader.integer(1, 0), 1u);
  EXPECT_EQ(shader.integer(0, 1), 1u);
  EXPECT_EQ(shader.integer(1, 2), 0u);
  EXPECT_EQ(shader.number(0, 5), 25 - 16);  // lane 4 still takes part
}

}  // namespace
}  // namespace beampipe
