// GLSL.std.450 against the same functions of the C library in double precision, with bounds on the error.
#include "tests/stages/spirv/shader_text.h"

namespace beampipe {
namespace {

// How far apart, in units in the last place of the float that is nearest to `expected`.
double units_apart(float found, double expected) {
  const auto nearest = static_cast<float>(expected);
  if (std::isnan(expected) || std::isinf(nearest)) {
    const bool same = std::isnan(expected) ? std::isnan(found) : found == nearest;
    return same ? 0 : std::numeric_limits<double>::infinity();
  }
  int exponent;
  std::frexp(nearest, &exponent);
  const double unit = std::ldexp(1.0, std::max(exponent - 24, -149));
  return std::fabs(found - expected) / unit;
}

using Function = double (*)(double);

// The worst error of an instruction of one operand, over [least, most] and over all magnitudes in it.
double worst_error(const std::string& name, Function function, float least, float most) {
  TestShader shader(ShaderParts{.body = "%r = OpExtInst %v4 %glsl " + name + " %va\nOpStore %out %r"});
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(least, most), exponent(-126, 0);
  double worst = 0;
  for (int round = 0; round < 400; ++round) {
    std::array<std::array<float, 4>, kShaderLanes> x;
    for (std::size_t lane = 0; lane < kShaderLanes; ++lane)
      for (std::uint32_t component = 0; component < 4; ++component) {
        auto value = static_cast<float>(uniform(random));
        const float small = value * static_cast<float>(std::exp2(exponent(random)));
        if (component % 2 && small >= least) value = small;
        x[lane][component] = value;
        shader.set(0, component, lane, value);
      }
    shader.run();
    for (std::size_t lane = 0; lane < kShaderLanes; ++lane)
      for (std::uint32_t component = 0; component < 4; ++component) {
        const double error = units_apart(shader.number(component, lane), function(x[lane][component]));
        if (error > worst) worst = error;
      }
  }
  return worst;
}

TEST(SpirvGlsl, FunctionsOfOneNumberAreNearlyTheNearestFloats) {
  const struct {
    const char* name;
    Function function;
    float least, most;
    double bound = 0.51;
  } cases[] = {
      {"Sin", [](double x) { return std::sin(x); }, -10, 10},
      {"Sin", [](double x) { return std::sin(x); }, -1e9f, 1e9f},
      {"Cos", [](double x) { return std::cos(x); }, -10, 10},
      {"Cos", [](double x) { return std::cos(x); }, -1e9f, 1e9f},
      {"Tan", [](double x) { return std::tan(x); }, -1e6f, 1e6f},
      {"Asin", [](double x) { return std::asin(x); }, -1, 1},
      {"Acos", [](double x) { return std::acos(x); }, -1, 1},
      {"Atan", [](double x) { return std::atan(x); }, -1e30f, 1e30f},
      {"Atan", [](double x) { return std::atan(x); }, -3, 3},
      {"Exp", [](double x) { return std::exp(x); }, -110, 95},
      {"Exp2", [](double x) { return std::exp2(x); }, -160, 135},
      {"Log", [](double x) { return std::log(x); }, 1e-44f, 3e38f},
      {"Log", [](double x) { return std::log(x); }, 0.5f, 2},
      {"Log2", [](double x) { return std::log2(x); }, 1e-44f, 3e38f},
      {"Log2", [](double x) { return std::log2(x); }, 0.5f, 2},
      {"Sinh", [](double x) { return std::sinh(x); }, -95, 95},
      {"Sinh", [](double x) { return std::sinh(x); }, -1, 1},
      {"Cosh", [](double x) { return std::cosh(x); }, -95, 95},
      {"Tanh", [](double x) { return std::tanh(x); }, -30, 30},
      {"Tanh", [](double x) { return std::tanh(x); }, -0.2f, 0.2f},
      {"Asinh", [](double x) { return std::asinh(x); }, -1e30f, 1e30f},
      {"Asinh", [](double x) { return std::asinh(x); }, -1, 1},
      {"Acosh", [](double x) { return std::acosh(x); }, 1, 1e30f},
      {"Acosh", [](double x) { return std::acosh(x); }, 1, 1.01f},
      {"Atanh", [](double x) { return std::atanh(x); }, -1, 1},
      {"Atanh", [](double x) { return std::atanh(x); }, -0.01f, 0.01f},
      {"Sqrt", [](double x) { return std::sqrt(x); }, 0, 1e38f},
      {"InverseSqrt", [](double x) { return 1 / std::sqrt(x); }, 1e-38f, 1e38f, 1.5},  // two roundings
  };
  for (const auto& [name, function, least, most, bound] : cases)
    EXPECT_LT(worst_error(name, function, least, most), bound) << name;
}

TEST(SpirvGlsl, Limits) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
  const auto expect = [](const std::string& name, float x, float expected) {
    TestShader shader(ShaderParts{.body = "%r = OpExtInst %v4 %glsl " + name + " %va\nOpStore %out %r"});
    shader.set(0, 1, 3, x);
    shader.run();
    const float found = shader.number(1, 3);
    if (std::isnan(expected))
      EXPECT_TRUE(std::isnan(found)) << name << " " << x;
    else
      EXPECT_EQ(found, expected) << name << " " << x;
  };
  expect("Log2", 0, -kInfinity), expect("Log2", kInfinity, kInfinity), expect("Log2", -1, kNan);
  expect("Log2", 8, 3), expect("Log2", 0x1p-149f, -149), expect("Log", 1, 0);
  expect("Exp2", -kInfinity, 0), expect("Exp2", kInfinity, kInfinity), expect("Exp2", 10, 1024);
  expect("Exp2", -149, 0x1p-149f), expect("Exp2", kNan, kNan), expect("Exp", 0, 1);
  expect("Sin", kInfinity, kNan), expect("Sin", 0, 0), expect("Cos", 0, 1), expect("Sin", 1e38f, 0);
  expect("Asin", 1.5f, kNan), expect("Acos", -1, 3.14159274f), expect("Acos", 1, 0);
  expect("Atan", kInfinity, 1.57079637f), expect("Tanh", kInfinity, 1), expect("Tanh", -100, -1);
  expect("Acosh", 1, 0), expect("Atanh", 1, kInfinity), expect("Sinh", kInfinity, kInfinity);
  expect("InverseSqrt", 0, kInfinity), expect("Sqrt", -1, kNan), expect("FSign", -0.0f, 0);
  expect("Sin", -1e38f, 0), expect("FSign", kInfinity, 1), expect("FSign", -3, -1);
  for (const std::string round : {"Round", "RoundEven"}) {  // Round may choose, and takes the even number as well
    expect(round, 2.5f, 2), expect(round, -3.5f, -4), expect(round, 8388607.5f, 8388608);
    expect(round, 8388609, 8388609), expect(round, -1e38f, -1e38f), expect(round, -kInfinity, -kInfinity);
    expect(round, kNan, kNan);
  }
}

// SPIR-V leaves open what FMin and FMax make of what is not a number; graphics processors take the number.
TEST(SpirvGlsl, ExtremesOfWhatIsNotANumber) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::string kind : {"F", "N"})
    for (const std::string name : {"Min", "Max"}) {
      TestShader shader(ShaderParts{.body = "%r = OpExtInst %v4 %glsl " + kind + name + " %va %vb\nOpStore %out %r"});
      shader.set(0, 0, 0, nan), shader.set(1, 0, 0, 2);
      shader.set(0, 0, 1, 2), shader.set(1, 0, 1, nan);
      shader.set(0, 0, 2, nan), shader.set(1, 0, 2, nan);
      shader.run();
      EXPECT_EQ(shader.number(0, 0), 2) << kind << name;
      EXPECT_EQ(shader.number(0, 1), 2) << kind << name;
      EXPECT_TRUE(std::isnan(shader.number(0, 2))) << kind << name;
    }
  for (const std::string kind : {"F", "N"}) {
    TestShader shader(
        ShaderParts{.body = "%r = OpExtInst %v4 %glsl " + kind + "Clamp %va %vb %f1111\nOpStore %out %r"});
    shader.set(0, 0, 0, nan), shader.set(1, 0, 0, 0.25f);
    shader.run();
    EXPECT_EQ(shader.number(0, 0), 0.25f) << kind;
  }
}

// Of up to three operands, on numbers within `least` and `most`.
TEST(SpirvGlsl, FunctionsOfSeveralNumbers) {
  const struct {
    const char* instruction;
    double (*function)(double, double, double);
    float least, most;
    double units;
  } cases[] = {
      {"Pow %va %vb", [](double x, double y, double) { return std::pow(x, y); }, 0, 20, 0.51},
      {"Atan2 %va %vb", [](double y, double x, double) { return std::atan2(y, x); }, -3, 3, 0.51},
      {"FMin %va %vb", [](double x, double y, double) { return std::min(x, y); }, -3, 3, 0.01},
      {"FMax %va %vb", [](double x, double y, double) { return std::max(x, y); }, -3, 3, 0.01},
      {"NMin %va %vb", [](double x, double y, double) { return std::min(x, y); }, -3, 3, 0.01},
      {"NMax %va %vb", [](double x, double y, double) { return std::max(x, y); }, -3, 3, 0.01},
      {"FClamp %va %f0000 %f1111", [](double x, double, double) { return std::clamp(x, 0.0, 1.0); }, -3, 3, 0.01},
      {"NClamp %va %f0000 %f1111", [](double x, double, double) { return std::clamp(x, 0.0, 1.0); }, -3, 3, 0.01},
      {"Step %va %vb", [](double edge, double x, double) { return x < edge ? 0.0 : 1.0; }, -3, 3, 0.01},
      {"Floor %va", [](double x, double, double) { return std::floor(x); }, -9, 9, 0.01},
      {"Ceil %va", [](double x, double, double) { return std::ceil(x); }, -9, 9, 0.01},
      {"Trunc %va", [](double x, double, double) { return std::trunc(x); }, -9, 9, 0.01},
      {"RoundEven %va", [](double x, double, double) { return std::nearbyint(x); }, -9, 9, 0.01},
      {"Fract %va", [](double x, double, double) { return x - std::floor(x); }, -9, 9, 0.51},
      {"FAbs %va", [](double x, double, double) { return std::fabs(x); }, -9, 9, 0.01},
      {"Radians %va", [](double x, double, double) { return x * M_PI / 180; }, -9, 9, 1.01},
      {"Degrees %va", [](double x, double, double) { return x * 180 / M_PI; }, -9, 9, 1.01},
      {"Fma %va %vb %vc", [](double x, double y, double z) { return x * y + z; }, 0, 9, 1.01},
      {"FMix %va %vb %vc", [](double x, double y, double a) { return x * (1 - a) + y * a; }, 0, 1, 2.01},
      {"SmoothStep %va %vb %vc",
       [](double low, double high, double x) {
         const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
         return t * t * (3 - 2 * t);
       },
       0, 1, 8},
  };
  for (const auto& [instruction, function, least, most, units] : cases) {
    TestShader shader(
        ShaderParts{.body = std::string("%r = OpExtInst %v4 %glsl ") + instruction + "\nOpStore %out %r"});
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(least, most);
    double worst = 0;
    for (int round = 0; round < 40; ++round) {
      std::array<std::array<float, 3>, kShaderLanes> x;
      for (std::size_t lane = 0; lane < kShaderLanes; ++lane)
        for (std::uint32_t input = 0; input < 3; ++input) shader.set(input, 2, lane, x[lane][input] = uniform(random));
      shader.run();
      for (std::size_t lane = 0; lane < kShaderLanes; ++lane)
        worst = std::max(worst, units_apart(shader.number(2, lane), function(x[lane][0], x[lane][1], x[lane][2])));
    }
    EXPECT_LT(worst, units) << instruction;
  }
}

// Whole results, of lanes' vectors.
TEST(SpirvGlsl, Vectors) {
  // Components of an input, a float each.
  const auto set = [](TestShader& to, std::uint32_t location, std::size_t lane, std::initializer_list<float> numbers) {
    for (std::uint32_t component = 0; const float number : numbers) to.set(location, component++, lane, number);
  };
  TestShader shader(ShaderParts{.body = R"(
%length = OpExtInst %float %glsl Length %va
%distance = OpExtInst %float %glsl Distance %va %vb
%unit = OpExtInst %v4 %glsl Normalize %va
%dot = OpDot %float %va %vb
%first = OpCompositeExtract %float %unit 0
)",
                                .floats = "%length %distance %first %dot"});
  set(shader, 0, 9, {1, -2, 4, 10}), set(shader, 1, 9, {1, 1, 0, 13});
  shader.run();
  EXPECT_EQ(shader.number(0, 9), 11);
  EXPECT_FLOAT_EQ(shader.number(1, 9), std::sqrt(34.0f));
  EXPECT_FLOAT_EQ(shader.number(2, 9), 1.0f / 11);
  EXPECT_EQ(shader.number(3, 9), 129);

  TestShader cross(ShaderParts{.body = R"(
%x = OpVectorShuffle %v3 %va %va 0 1 2
%y = OpVectorShuffle %v3 %vb %vb 0 1 2
%z = OpExtInst %v3 %glsl Cross %x %y
%mirrored = OpExtInst %v3 %glsl Reflect %x %y
%m1 = OpCompositeExtract %float %mirrored 1
)",
                               .floats = "%z %m1"});
  set(cross, 0, 0, {1, 2, 3}), set(cross, 1, 0, {0, 1, 0});
  cross.run();
  EXPECT_EQ(cross.number(0, 0), -3);
  EXPECT_EQ(cross.number(1, 0), 0);
  EXPECT_EQ(cross.number(2, 0), 1);
  EXPECT_EQ(cross.number(3, 0), -2);

  TestShader facing(ShaderParts{.body = "%f = OpExtInst %v4 %glsl FaceForward %va %vb %vc\nOpStore %out %f"});
  for (const std::size_t lane : {0, 1}) {
    const float seen = lane == 0 ? -1 : 1;
    set(facing, 0, lane, {5, 5, 5, 5}), set(facing, 1, lane, {1, 1, 1, 1}),
        set(facing, 2, lane, {seen, seen, seen, seen});
  }
  facing.run();
  EXPECT_EQ(facing.number(0, 0), 5);
  EXPECT_EQ(facing.number(0, 1), -5);

  // Snell's law: sin of the refracted angle is eta times that of the other; beyond, nothing is refracted.
  TestShader refract(ShaderParts{
      .body = "%e = OpCompositeExtract %float %vc 0\n%f = OpExtInst %v4 %glsl Refract %va %vb %e\nOpStore %out %f"});
  const double angle = 0.6;
  for (const std::size_t lane : {0, 1}) {
    set(refract, 0, lane, {static_cast<float>(std::sin(angle)), static_cast<float>(-std::cos(angle))});
    set(refract, 1, lane, {0, 1}), set(refract, 2, lane, {lane == 0 ? 0.75f : 1.9f});
  }
  refract.run();
  EXPECT_NEAR(refract.number(0, 0), 0.75 * std::sin(angle), 1e-6);
  EXPECT_NEAR(refract.number(1, 0), -std::sqrt(1 - std::pow(0.75 * std::sin(angle), 2)), 1e-6);
  EXPECT_EQ(refract.number(0, 1), 0);
  EXPECT_EQ(refract.number(1, 1), 0);
}

TEST(SpirvGlsl, PartsOfNumbers) {
  TestShader shader(ShaderParts{.body = R"(
%whole = OpVariable %p4 Function
; begin
%rest = OpExtInst %v4 %glsl Modf %va %whole
%w = OpLoad %v4 %whole
%f = OpExtInst %frexp %glsl FrexpStruct %vb
%f0_ = OpCompositeExtract %v4 %f 0
%f1_ = OpCompositeExtract %i4 %f 1
%again = OpExtInst %v4 %glsl Ldexp %f0_ %f1_
%r0 = OpCompositeExtract %float %rest 0
%r1 = OpCompositeExtract %float %w 0
%r2 = OpCompositeExtract %float %f0_ 0
%r3 = OpCompositeExtract %float %again 0
%g = OpBitcast %u4 %f1_
OpStore %iout %g
)",
                                .floats = "%r0 %r1 %r2 %r3",
                                .globals = "%p4 = OpTypePointer Function %v4\n%frexp = OpTypeStruct %v4 %i4\n"});
  std::mt19937 random(2);
  std::array<float, kShaderLanes> x, y;
  for (std::size_t lane = 0; lane < kShaderLanes; ++lane) {
    x[lane] = any_float(random, lane), y[lane] = lane == 0 ? 1e-42f : any_float(random, lane + 3);
    shader.set(0, 0, lane, x[lane]), shader.set(1, 0, lane, y[lane]);
  }
  shader.run();
  for (std::size_t lane = 0; lane < kShaderLanes; ++lane) {
    float whole;
    int exponent;
    EXPECT_EQ(shader.number(0, lane), std::modf(x[lane], &whole));
    EXPECT_EQ(shader.number(1, lane), whole);
    EXPECT_EQ(shader.number(2, lane), std::frexp(y[lane], &exponent));
    EXPECT_EQ(shader.integer(0, lane), static_cast<std::uint32_t>(exponent));
    EXPECT_EQ(shader.number(3, lane), y[lane]);
  }
}

// The specification leaves infinities and NaN open; here each is its own significand, with an exponent of 0.
TEST(SpirvGlsl, PartsOfZeroAndOfWhatIsNotFinite) {
  TestShader shader(ShaderParts{.body = R"(
%f = OpExtInst %frexp %glsl FrexpStruct %va
%significand = OpCompositeExtract %v4 %f 0
%exponent = OpCompositeExtract %i4 %f 1
%e = OpBitcast %u4 %exponent
OpStore %out %significand
OpStore %iout %e
)",
                                .globals = "%frexp = OpTypeStruct %v4 %i4\n"});
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<float> same{0.0f, -0.0f, kInfinity, -kInfinity};
  for (std::uint32_t lane = 0; lane < 4; ++lane) shader.set(0, 0, lane, same[lane]);
  shader.set(0, 0, 4, std::numeric_limits<float>::quiet_NaN());
  shader.run();
  for (std::uint32_t lane = 0; lane < 4; ++lane) {
    EXPECT_EQ(shader.number(0, lane), same[lane]);
    EXPECT_EQ(std::signbit(shader.number(0, lane)), std::signbit(same[lane]));
  }
  EXPECT_TRUE(std::isnan(shader.number(0, 4)));
  for (std::uint32_t lane = 0; lane < 5; ++lane) EXPECT_EQ(shader.integer(0, lane), 0u);
}

// The specification leaves large exponents open; here the result is the nearest float all the same.
TEST(SpirvGlsl, PowersOfTwoOutsideTheRangeOfFloats) {
  TestShader shader(
      ShaderParts{.body = "%e = OpBitcast %i4 %vi\n%r = OpExtInst %v4 %glsl Ldexp %va %e\nOpStore %out %r"});
  struct Case {
    float a;
    std::int32_t exponent;
    float expected;
  };
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<Case> cases{{1, 1000, kInfinity},
                                {1, -1000, 0},
                                {0x1p-149f, 276, 0x1p127f},
                                {0x1p127f, -276, 0x1p-149f},
                                {-1.5f, std::numeric_limits<std::int32_t>::max(), -kInfinity},
                                {1.5f, std::numeric_limits<std::int32_t>::min(), 0},
                                {0, 1000, 0}};
  for (std::uint32_t lane = 0; lane < cases.size(); ++lane) {
    shader.set(0, 0, lane, cases[lane].a);
    shader.set_integer(3, 0, lane, static_cast<std::uint32_t>(cases[lane].exponent));
  }
  shader.run();
  for (std::uint32_t lane = 0; lane < cases.size(); ++lane)
    EXPECT_EQ(shader.number(0, lane), cases[lane].expected) << cases[lane].a << " " << cases[lane].exponent;
}

// Where both sides are equally long, and where both are 0, which the specification leaves open.
TEST(SpirvGlsl, AnglesOfEqualSides) {
  TestShader shader(ShaderParts{.body = "%r = OpExtInst %v4 %glsl Atan2 %va %vb\nOpStore %out %r"});
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kEighth = 0.785398163f;
  shader.set(0, 0, 0, 3), shader.set(1, 0, 0, 3);
  shader.set(0, 0, 1, kInfinity), shader.set(1, 0, 1, kInfinity);
  shader.set(0, 0, 2, -2), shader.set(1, 0, 2, -2);
  shader.set(0, 0, 3, 0), shader.set(1, 0, 3, 0);
  shader.run();
  EXPECT_EQ(shader.number(0, 0), kEighth);
  EXPECT_EQ(shader.number(0, 1), kEighth);
  EXPECT_EQ(shader.number(0, 2), -2.35619449f);
  EXPECT_EQ(shader.number(0, 3), 0);
}

TEST(SpirvGlsl, Integers) {
  const auto expect = [](const std::string& instruction,
                         const std::function<std::uint32_t(std::uint32_t, std::uint32_t)>& function) {
    TestShader shader(
        ShaderParts{.body = "%si = OpBitcast %i4 %vi\n%sj = OpBitcast %i4 %vj\n%r = OpExtInst %u4 %glsl " +
                            instruction + "\nOpStore %iout %r"});
    std::mt19937 random(4);
    std::array<std::array<std::uint32_t, 2>, kShaderLanes> x;
    for (std::size_t lane = 0; lane < kShaderLanes; ++lane) {
      x[lane] = {any_integer(random, lane), any_integer(random, lane + 1)};
      shader.set_integer(3, 0, lane, x[lane][0]), shader.set_integer(4, 0, lane, x[lane][1]);
    }
    shader.run();
    for (std::size_t lane = 0; lane < kShaderLanes; ++lane)
      EXPECT_EQ(shader.integer(0, lane), function(x[lane][0], x[lane][1])) << instruction << " " << x[lane][0];
  };
  const auto s = [](std::uint32_t x) { return static_cast<std::int32_t>(x); };
  const auto u = [](std::int32_t x) { return static_cast<std::uint32_t>(x); };
  expect("SAbs %vi", [&](std::uint32_t x, std::uint32_t) { return s(x) < 0 ? 0u - x : x; });
  expect("SSign %vi", [&](std::uint32_t x, std::uint32_t) { return u((s(x) > 0) - (s(x) < 0)); });
  expect("UMin %vi %vj", [](std::uint32_t x, std::uint32_t y) { return std::min(x, y); });
  expect("UMax %vi %vj", [](std::uint32_t x, std::uint32_t y) { return std::max(x, y); });
  expect("SMin %vi %vj", [&](std::uint32_t x, std::uint32_t y) { return u(std::min(s(x), s(y))); });
  expect("SMax %vi %vj", [&](std::uint32_t x, std::uint32_t y) { return u(std::max(s(x), s(y))); });
  expect("UClamp %vi %u0000 %u1111", [](std::uint32_t x, std::uint32_t) { return std::clamp(x, 0u, 1u); });
  expect("SClamp %vi %u0000 %u1111", [&](std::uint32_t x, std::uint32_t) { return u(std::clamp(s(x), 0, 1)); });
  expect("FindILsb %vi", [&](std::uint32_t x, std::uint32_t) { return x == 0 ? ~0u : u(std::countr_zero(x)); });
  expect("FindUMsb %vi", [&](std::uint32_t x, std::uint32_t) { return 31u - u(std::countl_zero(x)); });
  expect("FindSMsb %vi", [&](std::uint32_t x, std::uint32_t) { return 31u - u(std::countl_zero(s(x) < 0 ? ~x : x)); });
}

TEST(SpirvGlsl, Packing) {
  TestShader shader(ShaderParts{.body = R"(
%p0 = OpExtInst %uint %glsl PackUnorm4x8 %va
%p1 = OpExtInst %uint %glsl PackSnorm4x8 %va
%xy = OpVectorShuffle %v2 %va %va 0 1
%p2 = OpExtInst %uint %glsl PackUnorm2x16 %xy
%p3 = OpExtInst %uint %glsl PackHalf2x16 %xy
%u0_ = OpExtInst %v4 %glsl UnpackUnorm4x8 %vi0
%u1_ = OpExtInst %v4 %glsl UnpackSnorm4x8 %vi0
%u2__ = OpExtInst %v2 %glsl UnpackHalf2x16 %vi0
%u3__ = OpExtInst %v2 %glsl UnpackSnorm2x16 %vi0
%x = OpCompositeExtract %float %u0_ 1
%y = OpCompositeExtract %float %u1_ 3
%z = OpCompositeExtract %float %u2__ 1
%w = OpCompositeExtract %float %u3__ 0
)",
                                .floats = "%x %y %z %w",
                                .integers = "%p0 %p1 %p2 %p3"});
  for (std::uint32_t i = 0; i < 4; ++i) shader.set(0, i, 0, std::array<float, 4>{1.0f, -0.5f, 0.2f, 7.0f}[i]);
  shader.set_integer(3, 0, 0, 0x8000ff80u);
  shader.run();
  EXPECT_EQ(shader.integer(0, 0), 0xff3300ffu);  // 0.2 * 255 = 51
  EXPECT_EQ(shader.integer(1, 0), 0x7f19c07fu);  // -63.5 becomes -64, 25.4 becomes 25
  EXPECT_EQ(shader.integer(2, 0), 0x0000ffffu);
  EXPECT_EQ(shader.integer(3, 0), 0xb8003c00u);
  EXPECT_EQ(shader.number(0, 0), 1.0f);
  EXPECT_EQ(shader.number(1, 0), -1.0f);  // -128 / 127 is bounded
  EXPECT_EQ(shader.number(2, 0), -0.0f);
  EXPECT_EQ(shader.number(3, 0), -128.0f / 32767);
}

TEST(SpirvGlsl, MatricesAndTheirInverse) {
  // m = columns a, b, c and (1, 2, 3, 4); m inverse(m) = 1.
  TestShader shader(ShaderParts{.body = R"(
%m = OpCompositeConstruct %m4 %va %vb %vc %last
%n = OpExtInst %m4 %glsl MatrixInverse %m
%one = OpMatrixTimesMatrix %m4 %m %n
%x = OpMatrixTimesVector %v4 %one %last
OpStore %out %x
)",
                                .globals = R"(
%m4 = OpTypeMatrix %v4 4
%f3 = OpConstant %float 3
%f4 = OpConstant %float 4
%last = OpConstantComposite %v4 %f1 %f2 %f3 %f4
)"});
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (std::size_t lane = 0; lane < kShaderLanes; ++lane)
    for (std::uint32_t i = 0; i < 12; ++i) shader.set(i / 4, i % 4, lane, uniform(random) + (i % 5 == 0 ? 3.0f : 0.0f));
  shader.run();
  for (std::size_t lane = 0; lane < kShaderLanes; ++lane)
    for (std::uint32_t i = 0; i < 4; ++i) EXPECT_NEAR(shader.number(i, lane), static_cast<float>(i + 1), 1e-4);

  TestShader small(ShaderParts{.body = R"(
%a2 = OpVectorShuffle %v2 %va %va 0 1
%b2 = OpVectorShuffle %v2 %vb %vb 0 1
%m = OpCompositeConstruct %m2 %a2 %b2
%t = OpTranspose %m2 %m
%d = OpExtInst %float %glsl Determinant %m
%l = OpVectorTimesMatrix %v2 %a2 %m
%o = OpOuterProduct %m2 %a2 %b2
%o10 = OpCompositeExtract %float %o 1 0
%t10 = OpCompositeExtract %float %t 1 0
%s = OpMatrixTimesScalar %m2 %m %f2
%s11 = OpCompositeExtract %float %s 1 1
%l1 = OpCompositeExtract %float %l 1
%e = OpFAdd %float %d %s11
)",
                               .floats = "%e %l1 %o10 %t10",
                               .globals = "%m2 = OpTypeMatrix %v2 2"});
  small.set(0, 0, 0, 2), small.set(0, 1, 0, 3), small.set(1, 0, 0, 5), small.set(1, 1, 0, 7);
  small.run();
  EXPECT_EQ(small.number(0, 0), 2 * 7 - 5 * 3 + 14);
  EXPECT_EQ(small.number(1, 0), 2 * 5 + 3 * 7);  // a . b
  EXPECT_EQ(small.number(2, 0), 2 * 7);          // column 1 is a b[1]
  EXPECT_EQ(small.number(3, 0), 3);              // of the transposed matrix: a[1]
}

}  // namespace
}  // namespace beampipe
