// Each instruction of arithmetic against the same formula in C++, on numbers of all kinds.
#include "stages/data/half_bits.h"
#include "tests/stages/spirv/shader_text.h"

namespace beampipe {
namespace {

// What a lane's component has as inputs.
struct Inputs {
  float a, b, c;
  std::uint32_t i, j, k;
};

// Runs the body, which sets %r, 4 floats or integers, from %va, %vb, %vc, %vi, %vj and %vk, and compares every
// component with the formula.
template <class Result, class Formula>
void expect_each(const std::string& body, Formula&& formula, const std::string& globals = "", float tolerance = 0) {
  SCOPED_TRACE(body);
  constexpr bool is_float = std::is_same_v<Result, float>;
  TestShader shader(
      ShaderParts{.body = body + (is_float ? "\nOpStore %out %r\n" : "\nOpStore %iout %r\n"), .globals = globals});
  std::mt19937 random(7);
  for (int round = 0; round < 8; ++round) {
    std::vector<Inputs> inputs;
    for (std::size_t n = 0; n < 4 * kShaderLanes; ++n) {
      const auto component = static_cast<std::uint32_t>(n % 4);
      const Inputs in{any_float(random, n / 4),   any_float(random, n / 4 + 3),   any_float(random, n / 4 + 5),
                      any_integer(random, n / 4), any_integer(random, n / 4 + 1), any_integer(random, n / 4 + 2)};
      shader.set(0, component, n / 4, in.a), shader.set(1, component, n / 4, in.b),
          shader.set(2, component, n / 4, in.c);
      shader.set_integer(3, component, n / 4, in.i), shader.set_integer(4, component, n / 4, in.j);
      shader.set_integer(5, component, n / 4, in.k);
      inputs.push_back(in);
    }
    ASSERT_TRUE(shader.run());
    for (std::size_t n = 0; n < inputs.size(); ++n) {
      const Inputs& in = inputs[n];
      const Result expected = formula(in);
      if constexpr (is_float) {
        const float found = shader.number(n % 4, n / 4);
        if (std::isnan(expected)) {
          EXPECT_TRUE(std::isnan(found)) << in.a << " " << in.b << " " << in.c;
        } else if (tolerance == 0 || std::isinf(expected)) {
          EXPECT_EQ(std::bit_cast<std::uint32_t>(found), std::bit_cast<std::uint32_t>(expected))
              << in.a << " " << in.b << " " << in.c << " " << in.i << " " << in.j << ": " << found << " not "
              << expected;
        } else {
          EXPECT_NEAR(found, expected, tolerance * std::fabs(expected)) << in.a << " " << in.b << " " << in.c;
        }
      } else {
        EXPECT_EQ(shader.integer(n % 4, n / 4), static_cast<std::uint32_t>(expected))
            << in.a << " " << in.b << " " << in.i << " " << in.j << " " << in.k;
      }
      if (::testing::Test::HasFailure()) return;
    }
  }
}
template <class Formula>
void floats(const std::string& body, Formula&& formula, const std::string& globals = "") {
  expect_each<float>(body, formula, globals);
}
template <class Formula>
void integers(const std::string& body, Formula&& formula, const std::string& globals = "") {
  expect_each<std::uint32_t>(body, formula, globals);
}
// A comparison: 1 or 0.
template <class Formula>
void comparison(const std::string& body, Formula&& formula) {
  integers(body + "\n%r = OpSelect %u4 %t %u1111 %u0000", [&](const Inputs& in) { return formula(in) ? 1u : 0u; });
}

std::int32_t s(std::uint32_t x) { return static_cast<std::int32_t>(x); }

TEST(SpirvArithmetic, FloatsAsInCpp) {
  floats("%r = OpFAdd %v4 %va %vb", [](const Inputs& in) { return in.a + in.b; });
  floats("%r = OpFSub %v4 %va %vb", [](const Inputs& in) { return in.a - in.b; });
  floats("%r = OpFMul %v4 %va %vb", [](const Inputs& in) { return in.a * in.b; });
  floats("%r = OpFDiv %v4 %va %vb", [](const Inputs& in) { return in.a / in.b; });
  floats("%r = OpFNegate %v4 %va", [](const Inputs& in) { return -in.a; });
  floats("%r = OpFMod %v4 %va %vb", [](const Inputs& in) { return in.a - in.b * std::floor(in.a / in.b); });
  floats("%r = OpFRem %v4 %va %vb", [](const Inputs& in) { return in.a - in.b * std::trunc(in.a / in.b); });
  // A product and a sum are rounded one after the other.
  floats("%p = OpFMul %v4 %va %vb\n%r = OpFAdd %v4 %p %vc", [](const Inputs& in) {
    volatile float product = in.a * in.b;
    return product + in.c;
  });
}

TEST(SpirvArithmetic, ComparisonsAsInCpp) {
  // Of what is no number, too: 0 / 0 instead of a where i is less than j.
  const std::string nan =
      "%which = OpULessThan %b4 %vi %vj\n%n = OpFDiv %v4 %f0000 %f0000\n%m = OpSelect %v4 %which %n %va\n";
  const auto is_nan = [](const Inputs& in) { return in.i < in.j; };
  const auto ordered = [&](const std::string& name, const auto& holds) {
    comparison("%t = OpFOrd" + name + " %b4 %va %vb", [&](const Inputs& in) { return holds(in.a, in.b); });
    comparison(nan + "%t = OpFOrd" + name + " %b4 %m %vb",
               [&](const Inputs& in) { return !is_nan(in) && holds(in.a, in.b); });
    comparison(nan + "%t = OpFUnord" + name + " %b4 %m %vb",
               [&](const Inputs& in) { return is_nan(in) || holds(in.a, in.b); });
  };
  const auto less_or_greater = [&](const std::string& name, const auto& holds) {
    ordered(name, holds);
    comparison("%t = OpU" + name + " %b4 %vi %vj", [&](const Inputs& in) { return holds(in.i, in.j); });
    comparison("%t = OpS" + name + " %b4 %vi %vj", [&](const Inputs& in) { return holds(s(in.i), s(in.j)); });
  };
  ordered("Equal", std::equal_to<>()), ordered("NotEqual", std::not_equal_to<>());
  less_or_greater("LessThan", std::less<>()), less_or_greater("LessThanEqual", std::less_equal<>());
  less_or_greater("GreaterThan", std::greater<>()), less_or_greater("GreaterThanEqual", std::greater_equal<>());
  comparison(nan + "%t = OpIsNan %b4 %m", is_nan);
  comparison("%q = OpFDiv %v4 %va %f0000\n%t = OpIsInf %b4 %q", [](const Inputs& in) { return in.a != 0; });
  comparison("%t = OpIEqual %b4 %vi %vj", [](const Inputs& in) { return in.i == in.j; });
  comparison("%t = OpINotEqual %b4 %vi %vj", [](const Inputs& in) { return in.i != in.j; });

  const std::string two = "%x = OpULessThan %b4 %vi %vj\n%y = OpULessThan %b4 %vj %vk\n";
  const auto x = [](const Inputs& in) { return in.i < in.j; };
  const auto y = [](const Inputs& in) { return in.j < in.k; };
  comparison(two + "%t = OpLogicalAnd %b4 %x %y", [&](const Inputs& in) { return x(in) && y(in); });
  comparison(two + "%t = OpLogicalOr %b4 %x %y", [&](const Inputs& in) { return x(in) || y(in); });
  comparison(two + "%t = OpLogicalEqual %b4 %x %y", [&](const Inputs& in) { return x(in) == y(in); });
  comparison(two + "%t = OpLogicalNotEqual %b4 %x %y", [&](const Inputs& in) { return x(in) != y(in); });
  comparison(two + "%t = OpLogicalNot %b4 %x", [&](const Inputs& in) { return !x(in); });
}

TEST(SpirvArithmetic, IntegersAsInCpp) {
  integers("%r = OpIAdd %u4 %vi %vj", [](const Inputs& in) { return in.i + in.j; });
  integers("%r = OpISub %u4 %vi %vj", [](const Inputs& in) { return in.i - in.j; });
  integers("%r = OpIMul %u4 %vi %vj", [](const Inputs& in) { return in.i * in.j; });
  integers("%r = OpSNegate %u4 %vi", [](const Inputs& in) { return 0u - in.i; });
  integers("%r = OpUDiv %u4 %vi %vj", [](const Inputs& in) { return in.j ? in.i / in.j : ~0u; });
  integers("%r = OpUMod %u4 %vi %vj", [](const Inputs& in) { return in.j ? in.i % in.j : ~0u; });
  const auto wide = [](std::uint32_t value) { return std::int64_t{s(value)}; };
  integers("%r = OpSDiv %u4 %vi %vj",
           [&](const Inputs& in) { return static_cast<std::uint32_t>(in.j ? wide(in.i) / wide(in.j) : -1); });
  integers("%r = OpSRem %u4 %vi %vj",
           [&](const Inputs& in) { return static_cast<std::uint32_t>(in.j ? wide(in.i) % wide(in.j) : -1); });
  integers("%r = OpSMod %u4 %vi %vj", [&](const Inputs& in) {  // the sign of the divisor
    if (in.j == 0) return ~0u;
    return static_cast<std::uint32_t>(((wide(in.i) % wide(in.j)) + wide(in.j)) % wide(in.j));
  });
  const auto shift = [](const std::string& name, auto&& formula) {
    integers(
        "%n = OpBitwiseAnd %u4 %vj %mask\n%r = OpShift" + name + " %u4 %vi %n",
        [&](const Inputs& in) { return static_cast<std::uint32_t>(formula(in.i, in.j & 31)); },
        "%u31 = OpConstant %uint 31\n%mask = OpConstantComposite %u4 %u31 %u31 %u31 %u31");
  };
  shift("LeftLogical", [](std::uint32_t x, std::uint32_t n) { return x << n; });
  shift("RightLogical", [](std::uint32_t x, std::uint32_t n) { return x >> n; });
  shift("RightArithmetic", [](std::uint32_t x, std::uint32_t n) { return s(x) >> n; });
  integers("%r = OpBitwiseOr %u4 %vi %vj", [](const Inputs& in) { return in.i | in.j; });
  integers("%r = OpBitwiseXor %u4 %vi %vj", [](const Inputs& in) { return in.i ^ in.j; });
  integers("%r = OpNot %u4 %vi", [](const Inputs& in) { return ~in.i; });
  integers("%r = OpBitCount %u4 %vi", [](const Inputs& in) { return static_cast<std::uint32_t>(std::popcount(in.i)); });
  integers("%r = OpBitReverse %u4 %vi", [](const Inputs& in) {
    std::uint32_t reversed = 0;
    for (int bit = 0; bit < 32; ++bit) reversed |= (in.i >> bit & 1u) << (31 - bit);
    return reversed;
  });
}

TEST(SpirvArithmetic, BitFieldsAndLongProducts) {
  const auto mask = [](std::uint32_t count) { return static_cast<std::uint32_t>((std::uint64_t{1} << count) - 1); };
  integers("%r = OpBitFieldUExtract %u4 %vi %u3_ %u4_", [&](const Inputs& in) { return in.i >> 3 & mask(4); });
  integers("%r = OpBitFieldSExtract %u4 %vi %u3_ %u4_",
           [&](const Inputs& in) { return static_cast<std::uint32_t>(s(in.i << 25) >> 28); });
  integers("%r = OpBitFieldInsert %u4 %vi %vj %u3_ %u4_",
           [&](const Inputs& in) { return (in.i & ~(mask(4) << 3)) | (in.j & mask(4)) << 3; });
  // An offset and a number of bits that are not constant.
  const std::string field =
      "%k0 = OpCompositeExtract %uint %vk 0\n%offset = OpUMod %uint %k0 %u4_\n%count = OpShiftLeftLogical %uint %u3_ "
      "%offset\n";
  TestShader shader(ShaderParts{.body = field + R"(
%x = OpBitFieldUExtract %u4 %vi %offset %count
%y = OpBitFieldSExtract %u4 %vi %offset %count
%z = OpBitFieldInsert %u4 %vi %vj %offset %count
%s = OpIAdd %u4 %x %y
%r = OpBitwiseXor %u4 %s %z
OpStore %iout %r
)"});
  std::mt19937 random(3);
  std::vector<Inputs> inputs(kShaderLanes);
  for (std::size_t lane = 0; lane < kShaderLanes; ++lane) {
    Inputs& in = inputs[lane];
    in.i = any_integer(random, lane), in.j = any_integer(random, lane + 1), in.k = static_cast<std::uint32_t>(lane);
    shader.set_integer(3, 2, lane, in.i), shader.set_integer(4, 2, lane, in.j), shader.set_integer(5, 0, lane, in.k);
  }
  shader.run();
  for (std::size_t lane = 0; lane < kShaderLanes; ++lane) {
    const Inputs& in = inputs[lane];
    const std::uint32_t offset = in.k % 4, count = 3u << offset, field_mask = mask(count);
    const std::uint32_t u = in.i >> offset & field_mask;
    const std::uint32_t sign = u >> (count - 1) & 1u ? u | ~field_mask : u;
    const std::uint32_t inserted = (in.i & ~(field_mask << offset)) | (in.j & field_mask) << offset;
    EXPECT_EQ(shader.integer(2, lane), (u + sign) ^ inserted);
  }

  const auto part = [](const std::string& name, char part_of_pair, auto&& formula) {
    integers(
        "%p = Op" + name + " %pair %vi %vj\n%r = OpCompositeExtract %u4 %p " + part_of_pair,
        [&](const Inputs& in) { return static_cast<std::uint32_t>(formula(in.i, in.j)); },
        "%pair = OpTypeStruct %u4 %u4");
  };
  part("UMulExtended", '1', [](std::uint64_t x, std::uint64_t y) { return x * y >> 32; });
  part("SMulExtended", '1', [](std::uint32_t x, std::uint32_t y) { return std::int64_t{s(x)} * s(y) >> 32; });
  part("UMulExtended", '0', [](std::uint32_t x, std::uint32_t y) { return x * y; });
  part("IAddCarry", '1', [](std::uint64_t x, std::uint64_t y) { return (x + y) >> 32; });
  part("ISubBorrow", '1', [](std::uint32_t x, std::uint32_t y) { return x < y; });
}

TEST(SpirvArithmetic, Conversions) {
  const auto to_signed = [](float a) {
    return a >= 2147483648.0f   ? 2147483520u
           : a < -2147483648.0f ? 0x80000000u
                                : static_cast<std::uint32_t>(static_cast<std::int32_t>(a));
  };
  integers("%q = OpConvertFToS %i4 %va\n%r = OpBitcast %u4 %q", [&](const Inputs& in) { return to_signed(in.a); });
  integers("%r = OpConvertFToU %u4 %va", [](const Inputs& in) {
    return in.a >= 4294967296.0f ? 4294967040u : in.a < 0 ? 0u : static_cast<std::uint32_t>(in.a);
  });
  floats("%q = OpBitcast %i4 %vi\n%r = OpConvertSToF %v4 %q",
         [](const Inputs& in) { return static_cast<float>(s(in.i)); });
  floats("%r = OpConvertUToF %v4 %vi", [](const Inputs& in) { return static_cast<float>(in.i); });
  integers("%r = OpBitcast %u4 %va", [](const Inputs& in) { return std::bit_cast<std::uint32_t>(in.a); });
  // Narrow integers wrap, and keep their sign where it matters.
  integers("%q = OpSConvert %s4 %vi\n%p = OpSConvert %i4 %q\n%r = OpBitcast %u4 %p",
           [](const Inputs& in) { return static_cast<std::uint32_t>(std::int32_t{static_cast<std::int16_t>(in.i)}); });
  integers("%q = OpUConvert %us4 %vi\n%p = OpIMul %us4 %q %q\n%r = OpUConvert %u4 %p",
           [](const Inputs& in) { return (in.i & 0xffffu) * (in.i & 0xffffu) & 0xffffu; });
  integers(
      "%q = OpSConvert %c4 %vi\n%p = OpSConvert %c4 %vj\n%d = OpISub %c4 %q %p\n%e = OpSConvert %i4 %d\n%r = "
      "OpBitcast %u4 %e",
      [](const Inputs& in) { return static_cast<std::uint32_t>(std::int32_t{static_cast<std::int8_t>(in.i - in.j)}); });
  integers(
      "%q = OpSConvert %s4 %vi\n%p = OpSConvert %s4 %vj\n%t = OpSLessThan %b4 %q %p\n%r = OpSelect %u4 %t %u1111 "
      "%u0000",
      [](const Inputs& in) { return static_cast<std::int16_t>(in.i) < static_cast<std::int16_t>(in.j) ? 1u : 0u; });
  integers(
      "%q = OpSConvert %s4 %vi\n%p = OpShiftRightArithmetic %s4 %q %three\n%e = OpSConvert %i4 %p\n%r = OpBitcast "
      "%u4 %e",
      [](const Inputs& in) { return static_cast<std::uint32_t>(static_cast<std::int16_t>(in.i) >> 3); },
      "%s3 = OpConstant %short 3\n%three = OpConstantComposite %s4 %s3 %s3 %s3 %s3");
}

// 16-bit floats: each result is the nearest one.
TEST(SpirvArithmetic, HalfFloats) {
  const std::string both = "%x = OpFConvert %h4 %va\n%y = OpFConvert %h4 %vb\n";
  floats("%x = OpFConvert %h4 %va\n%r = OpFConvert %v4 %x", [&](const Inputs& in) { return nearest_half(in.a); });
  floats("%r = OpQuantizeToF16 %v4 %va", [&](const Inputs& in) { return nearest_half(in.a); });
  const auto two = [&](const std::string& name, const auto& formula) {
    floats(both + "%z = OpF" + name + " %h4 %x %y\n%r = OpFConvert %v4 %z",
           [&](const Inputs& in) { return nearest_half(formula(nearest_half(in.a), nearest_half(in.b))); });
  };
  two("Add", std::plus<>()), two("Mul", std::multiplies<>()), two("Div", std::divides<>());
  // Through the bits, as zink writes it.
  integers("%x = OpFConvert %h4 %va\n%y = OpBitcast %us4 %x\n%r = OpUConvert %u4 %y",
           [](const Inputs& in) { return std::uint32_t{half_of(in.a)}; });
  floats("%x = OpUConvert %us4 %vi\n%y = OpBitcast %h4 %x\n%r = OpFConvert %v4 %y",
         [](const Inputs& in) { return half_value(static_cast<std::uint16_t>(in.i)); });
}

// Halves as codes: around the largest one, ties between small ones, and what is not finite.
TEST(SpirvArithmetic, EdgesOfHalfFloats) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<std::pair<float, std::uint32_t>> codes{
      {kInfinity, 0x7c00}, {-kInfinity, 0xfc00},  {65519.996f, 0x7bff}, {65520, 0x7c00}, {-1e38f, 0xfc00},
      {-0.0f, 0x8000},     {0x1p-25f, 0},         {0x1.000002p-25f, 1}, {0x1.8p-24f, 2}, {-0x1p-14f, 0x8400},
      {0x1p-149f, 0},      {0x1.ff8p-15f, 0x3ff}, {0x1.ffcp-15f, 0x400}};
  TestShader shader(
      ShaderParts{.body = "%x = OpFConvert %h4 %va\n%y = OpBitcast %us4 %x\n%r = OpUConvert %u4 %y\nOpStore %iout %r"});
  for (std::uint32_t lane = 0; lane < codes.size(); ++lane) shader.set(0, 0, lane, codes[lane].first);
  const auto after_all = static_cast<std::uint32_t>(codes.size());
  shader.set(0, 0, after_all, std::numeric_limits<float>::quiet_NaN());
  shader.run();
  for (std::uint32_t lane = 0; lane < codes.size(); ++lane)
    EXPECT_EQ(shader.integer(0, lane), codes[lane].second) << codes[lane].first;
  EXPECT_GT(shader.integer(0, after_all) & 0x7fffu, 0x7c00u);
}

// SPIR-V leaves open what becomes of a number that no integer is near. Here NaN becomes 0, and an infinity the least
// integer or the largest one that is a float.
TEST(SpirvArithmetic, IntegersOfWhatIsNotFinite) {
  TestShader shader(ShaderParts{.body =
                                    "%x = OpConvertFToS %i4 %va\n%y = OpBitcast %u4 %x\n%z = OpConvertFToU %u4 %va\n"
                                    "%r = OpVectorShuffle %u4 %y %z 0 4 0 4\nOpStore %iout %r"});
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  shader.set(0, 0, 0, std::numeric_limits<float>::quiet_NaN());
  shader.set(0, 0, 1, kInfinity), shader.set(0, 0, 2, -kInfinity);
  shader.run();
  EXPECT_EQ(shader.integer(0, 0), 0u);
  EXPECT_EQ(shader.integer(1, 0), 0u);
  EXPECT_EQ(shader.integer(0, 1), 2147483520u);
  EXPECT_EQ(shader.integer(1, 1), 4294967040u);
  EXPECT_EQ(shader.integer(0, 2), 0x80000000u);
  EXPECT_EQ(shader.integer(1, 2), 0u);
}

TEST(SpirvArithmetic, BitFieldsMayBeWholeOrEmpty) {
  TestShader shader(ShaderParts{.body = R"(
%offset = OpCompositeExtract %uint %vk 0
%count = OpCompositeExtract %uint %vk 1
%x = OpBitFieldUExtract %uint %vi0 %offset %count
%y = OpBitFieldSExtract %uint %vi0 %offset %count
%z = OpBitFieldInsert %uint %vi0 %vi1 %offset %count
)",
                                .integers = "%x %y %z %u0"});
  constexpr std::uint32_t kBase = 0x89abcdefu, kInserted = 0x13572468u;
  struct Field {
    std::uint32_t offset, count, extracted, with_sign, inserted;
  };
  const std::vector<Field> fields{{0, 32, kBase, kBase, kInserted},
                                  {0, 0, 0, 0, kBase},
                                  {32, 0, 0, 0, kBase},
                                  {7, 0, 0, 0, kBase},
                                  {31, 1, 1, ~0u, 0x09abcdefu},
                                  {16, 16, 0x89abu, 0xffff89abu, 0x2468cdefu}};
  for (std::uint32_t lane = 0; lane < fields.size(); ++lane) {
    shader.set_integer(3, 0, lane, kBase), shader.set_integer(3, 1, lane, kInserted);
    shader.set_integer(5, 0, lane, fields[lane].offset), shader.set_integer(5, 1, lane, fields[lane].count);
  }
  shader.run();
  for (std::uint32_t lane = 0; lane < fields.size(); ++lane) {
    EXPECT_EQ(shader.integer(0, lane), fields[lane].extracted) << "field " << lane;
    EXPECT_EQ(shader.integer(1, lane), fields[lane].with_sign) << "field " << lane;
    EXPECT_EQ(shader.integer(2, lane), fields[lane].inserted) << "field " << lane;
  }
}

// The first of several narrow numbers is the lowest part of a wide one.
TEST(SpirvArithmetic, BitsOfSeveralNumbersAreThoseOfOne) {
  const std::string wide = "%x = OpUConvert %us4 %vi\n%y = OpBitcast %u2 %x\n";
  integers(
      wide +
          "%w = OpVectorShuffle %u4 %y %y 0 0 1 1\n%h = OpShiftRightLogical %u4 %w %shifts\n"
          "%r = OpBitwiseAnd %u4 %h %low",
      [](const Inputs& in) { return in.i & 0xffffu; },
      "%u16 = OpConstant %uint 16\n%umask = OpConstant %uint 65535\n"
      "%shifts = OpConstantComposite %u4 %u0 %u16 %u0 %u16\n"
      "%low = OpConstantComposite %u4 %umask %umask %umask %umask");
  integers(wide + "%z = OpBitcast %us4 %y\n%r = OpUConvert %u4 %z", [](const Inputs& in) { return in.i & 0xffffu; });
  floats("%x = OpFConvert %h4 %va\n%y = OpBitcast %u2 %x\n%z = OpBitcast %h4 %y\n%r = OpFConvert %v4 %z",
         [](const Inputs& in) { return nearest_half(in.a); });
}

TEST(SpirvArithmetic, CopiesAreTheSame) {
  floats("%q = OpCopyObject %v4 %va\n%r = OpFAdd %v4 %q %vb", [](const Inputs& in) { return in.a + in.b; });
}

TEST(SpirvArithmetic, SelectsPartByPart) {
  floats("%t = OpULessThan %b4 %vi %vj\n%r = OpSelect %v4 %t %va %vb",
         [](const Inputs& in) { return in.i < in.j ? in.a : in.b; });
}

}  // namespace
}  // namespace beampipe
