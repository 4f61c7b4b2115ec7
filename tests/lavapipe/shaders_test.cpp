// The executor of shaders against Mesa's lavapipe, on random numbers, buffers and images: all outputs agree to 1e-5 of
// the larger of 1 and the number, unless a test says why they do not.
#include "tests/lavapipe/lavapipe_test.h"

namespace beampipe {
namespace {

class LavapipeShaders : public LavapipeTest {
 protected:
  // Instructions that make %r of 4 floats or 4 unsigned integers.
  void floats(const std::string& body, float least = -10, float most = 10, double tolerance = 1e-5,
              const std::string& globals = "") {
    expect_near(points({.body = body + "\nOpStore %out %r\nOpStore %iout %u0000", .globals = globals}, least, most),
                body, tolerance);
  }
  void integers(const std::string& body, const std::string& globals = "") {
    expect_near(points({.body = body + "\nOpStore %iout %r\nOpStore %out %f0000", .globals = globals}), body);
  }
};

TEST_F(LavapipeShaders, ArithmeticOfFloats) {
  for (const std::string op : {"FAdd", "FSub", "FMul", "FDiv"}) floats("%r = Op" + op + " %v4 %va %vb");
  floats("%r = OpFNegate %v4 %va");
  // Where a quotient is nearly whole, the driver may find the next multiple.
  floats("%r = OpFMod %v4 %va %vb");
  floats("%r = OpFRem %v4 %va %vb");
  floats("%x = OpCompositeExtract %float %vb 1\n%r = OpVectorTimesScalar %v4 %va %x");
  floats("%x = OpDot %float %va %vb\n%r = OpCompositeConstruct %v4 %x %x %f0 %f1");
}

TEST_F(LavapipeShaders, Comparisons) {
  // Of numbers of which many are the same.
  for (const std::string op : {"FOrdEqual", "FOrdNotEqual", "FOrdLessThan", "FOrdGreaterThan", "FOrdLessThanEqual",
                               "FOrdGreaterThanEqual", "FUnordEqual", "FUnordNotEqual", "FUnordLessThan",
                               "FUnordGreaterThan", "FUnordLessThanEqual", "FUnordGreaterThanEqual"})
    integers("%x = OpExtInst %v4 %glsl Floor %va\n%y = OpExtInst %v4 %glsl Floor %vb\n%q = Op" + op +
             " %b4 %x %y\n%r = OpSelect %u4 %q %vi %vj");
  for (const std::string op : {"IEqual", "INotEqual", "ULessThan", "UGreaterThan", "ULessThanEqual",
                               "UGreaterThanEqual", "SLessThan", "SGreaterThan", "SLessThanEqual", "SGreaterThanEqual"})
    integers("%q = Op" + op + " %b4 %vi %vj\n%r = OpSelect %u4 %q %u1111 %u0000");
  const std::string both = "%x = OpSLessThan %b4 %vi %vj\n%y = OpULessThan %b4 %vj %vk\n";
  for (const std::string op : {"LogicalAnd", "LogicalOr", "LogicalEqual", "LogicalNotEqual"})
    integers(both + "%q = Op" + op + " %b4 %x %y\n%r = OpSelect %u4 %q %u1111 %u0000");
  for (const std::string op : {"Any", "All"})
    integers(both + "%q = Op" + op +
             " %bool %x\n%n = OpLogicalNot %bool %q\n%z = OpSelect %uint %n %u1 %u2_\n"
             "%r = OpCompositeConstruct %u4 %z %z %z %z");
  const std::string nothing =
      "%z = OpFDiv %v4 %f0000 %f0000\n%s = OpFOrdLessThan %b4 %va %vb\n%x = OpSelect %v4 %s %z %va\n";
  integers(nothing + "%q = OpIsNan %b4 %x\n%r = OpSelect %u4 %q %u1111 %u0000");
  integers(nothing + "%q = OpFUnordLessThan %b4 %x %vb\n%r = OpSelect %u4 %q %u1111 %u0000");
  integers(nothing + "%q = OpFUnordNotEqual %b4 %x %x\n%r = OpSelect %u4 %q %u1111 %u0000");
  integers(
      "%w = OpFDiv %v4 %f1111 %f0000\n%s = OpFOrdLessThan %b4 %va %vb\n%x = OpSelect %v4 %s %w %va\n"
      "%q = OpIsInf %b4 %x\n%r = OpSelect %u4 %q %u1111 %u0000");
}

TEST_F(LavapipeShaders, Integers) {
  for (const std::string op : {"IAdd", "ISub", "IMul", "BitwiseAnd", "BitwiseOr", "BitwiseXor"})
    integers("%r = Op" + op + " %u4 %vi %vj");
  for (const std::string op : {"SNegate", "Not", "BitCount", "BitReverse"}) integers("%r = Op" + op + " %u4 %vi");
  // Neither by 0 nor, of signed ones, by -1.
  const std::string divisor = "%d = OpBitwiseOr %u4 %vj %two\n",
                    two = "%two = OpConstantComposite %u4 %u2_ %u2_ %u2_ %u2_";
  for (const std::string op : {"UDiv", "UMod"}) integers(divisor + "%r = Op" + op + " %u4 %vi %d", two);
  // OpSMod is left out: Mesa 22.3 gives it the sign of the dividend.
  const std::string positive =
      "%d0 = OpBitwiseOr %u4 %vj %two\n%d = OpShiftRightLogical %u4 %d0 %u1111\n%x = OpBitcast %i4 %vi\n%y = OpBitcast "
      "%i4 %d\n";
  for (const std::string op : {"SDiv", "SRem"})
    integers(positive + "%q = Op" + op + " %i4 %x %y\n%r = OpBitcast %u4 %q", two);
  for (const std::string op : {"ShiftLeftLogical", "ShiftRightLogical", "ShiftRightArithmetic"})
    integers("%n = OpBitwiseAnd %u4 %vj %mask\n%r = Op" + op + " %u4 %vi %n",
             "%u31 = OpConstant %uint 31\n%mask = OpConstantComposite %u4 %u31 %u31 %u31 %u31");
  const std::string pair = "%pair = OpTypeStruct %u4 %u4";
  for (const std::string op : {"UMulExtended", "SMulExtended", "IAddCarry", "ISubBorrow"})
    for (const std::string part : {"0", "1"})
      integers("%p = Op" + op + " %pair %vi %vj\n%r = OpCompositeExtract %u4 %p " + part, pair);
  const std::string field =
      "%k0 = OpCompositeExtract %uint %vk 0\n%offset = OpUMod %uint %k0 %u4_\n"
      "%count = OpShiftLeftLogical %uint %u3_ %offset\n";
  integers(field + "%r = OpBitFieldUExtract %u4 %vi %offset %count");
  integers(field + "%r = OpBitFieldSExtract %u4 %vi %offset %count");
  integers(field + "%r = OpBitFieldInsert %u4 %vi %vj %offset %count");
}

TEST_F(LavapipeShaders, Conversions) {
  integers("%q = OpConvertFToS %i4 %va\n%r = OpBitcast %u4 %q");
  integers("%x = OpExtInst %v4 %glsl FAbs %va\n%r = OpConvertFToU %u4 %x");
  floats("%q = OpBitcast %i4 %vi\n%r = OpConvertSToF %v4 %q");
  floats("%r = OpConvertUToF %v4 %vi");
  integers("%r = OpBitcast %u4 %va");
  integers("%q = OpSConvert %s4 %vi\n%p = OpSConvert %i4 %q\n%r = OpBitcast %u4 %p");
  integers("%q = OpUConvert %us4 %vi\n%p = OpIMul %us4 %q %q\n%r = OpUConvert %u4 %p");
  integers(
      "%q = OpSConvert %c4 %vi\n%p = OpSConvert %c4 %vj\n%d = OpISub %c4 %q %p\n%e = OpSConvert %i4 %d\n"
      "%r = OpBitcast %u4 %e");
  integers(
      "%q = OpSConvert %s4 %vi\n%p = OpSConvert %s4 %vj\n%t = OpSLessThan %b4 %q %p\n"
      "%r = OpSelect %u4 %t %u1111 %u0000");
  floats("%x = OpFConvert %h4 %va\n%r = OpFConvert %v4 %x");
  floats("%r = OpQuantizeToF16 %v4 %va");
  floats("%x = OpSConvert %s4 %vi\n%y = OpConvertSToF %h4 %x\n%r = OpFConvert %v4 %y");
}

TEST_F(LavapipeShaders, HalfFloats) {
  const std::string both = "%x = OpFConvert %h4 %va\n%y = OpFConvert %h4 %vb\n%w = OpFConvert %h4 %vc\n",
                    back = "\n%r = OpFConvert %v4 %z";
  for (const std::string op : {"FAdd", "FSub", "FMul", "FDiv"}) floats(both + "%z = Op" + op + " %h4 %x %y" + back);
  floats(both + "%p = OpFMul %h4 %x %y\n%z = OpFAdd %h4 %p %w" + back);
  for (const std::string op : {"FMin", "FMax"}) floats(both + "%z = OpExtInst %h4 %glsl " + op + " %x %y" + back);
  for (const std::string op : {"Floor", "Ceil", "Trunc", "RoundEven", "FAbs", "FSign", "Fract"})
    floats(both + "%z = OpExtInst %h4 %glsl " + op + " %x" + back);
  floats(both + "%z = OpExtInst %h4 %glsl FMix %x %y %w" + back, 0, 1);
  floats(both + "%d = OpDot %half %x %y\n%z = OpCompositeConstruct %h4 %d %d %d %d" + back);
  floats(both + "%z = OpExtInst %h4 %glsl Sqrt %x" + back, 0, 100);
  floats(both + "%z = OpExtInst %h4 %glsl InverseSqrt %x" + back, 0.01f, 100);
  integers(both + "%t = OpFOrdLessThan %b4 %x %y\n%r = OpSelect %u4 %t %u1111 %u0000");
}

TEST_F(LavapipeShaders, LinearAlgebra) {
  const std::string types =
      "%m4 = OpTypeMatrix %v4 4\n%m32 = OpTypeMatrix %v2 3\n%m23 = OpTypeMatrix %v3 2\n"
      "%m2 = OpTypeMatrix %v2 2\n%m3 = OpTypeMatrix %v3 3\n";
  const std::string matrix = "%d = OpFAdd %v4 %va %vb\n%m = OpCompositeConstruct %m4 %va %vb %vc %d\n";
  floats(matrix + "%r = OpMatrixTimesVector %v4 %m %vb", -10, 10, 1e-5, types);
  floats(matrix + "%r = OpVectorTimesMatrix %v4 %vb %m", -10, 10, 1e-5, types);
  floats(matrix +
             "%t = OpTranspose %m4 %m\n%p = OpMatrixTimesMatrix %m4 %m %t\n%s = OpMatrixTimesScalar %m4 %p %f2\n"
             "%r = OpCompositeExtract %v4 %s 2",
         -10, 10, 1e-5, types);
  floats("%o = OpOuterProduct %m4 %va %vb\n%r = OpCompositeExtract %v4 %o 1", -10, 10, 1e-5, types);
  // Far from matrices without an inverse.
  const std::string far =
      "%e0 = OpCompositeConstruct %v4 %f2 %f0 %f0 %f0\n%e1 = OpCompositeConstruct %v4 %f0 %f2 %f0 %f0\n"
      "%e2 = OpCompositeConstruct %v4 %f0 %f0 %f2 %f0\n%e3 = OpCompositeConstruct %v4 %f0 %f0 %f0 %f2\n"
      "%c0 = OpFAdd %v4 %va %e0\n%c1 = OpFAdd %v4 %vb %e1\n%c2 = OpFAdd %v4 %vc %e2\n"
      "%c3 = OpFSub %v4 %e3 %va\n%m = OpCompositeConstruct %m4 %c0 %c1 %c2 %c3\n";
  floats(far + "%n = OpExtInst %m4 %glsl MatrixInverse %m\n%r = OpCompositeExtract %v4 %n 1", -0.3f, 0.3f, 1e-5, types);
  floats(far + "%x = OpExtInst %float %glsl Determinant %m\n%r = OpCompositeConstruct %v4 %x %x %x %x", -0.3f, 0.3f,
         1e-5, types);
}

TEST_F(LavapipeShaders, FunctionsThatRoundOnce) {
  const auto one = [&](const std::string& name, float least = -10, float most = 10) {
    floats("%r = OpExtInst %v4 %glsl " + name, least, most);
  };
  for (const std::string name : {"RoundEven", "Trunc", "FAbs", "FSign", "Floor", "Ceil", "Fract", "Radians", "Degrees"})
    one(name + " %va");
  for (const std::string name : {"FMin", "FMax", "NMin", "NMax", "Step"}) one(name + " %va %vb");
  one("Sqrt %va", 0, 100), one("InverseSqrt %va", 0.01f, 100);
  for (const std::string name : {"FMix", "Fma"}) one(name + " %va %vb %vc");
  one("FClamp %va %f0000 %f1111"), one("NClamp %va %f0000 %f1111");
  const std::string nothing =
      "%s = OpFOrdLessThan %b4 %va %vb\n%q = OpFDiv %v4 %f0000 %f0000\n%x = OpSelect %v4 %s %q %va\n";
  for (const std::string name : {"FMin %x %vc", "FMax %vc %x", "NMin %vc %x", "NMax %x %vc", "FClamp %x %f0000 %f1111"})
    floats(nothing + "%r = OpExtInst %v4 %glsl " + name);
  one("SmoothStep %f0000 %f1111 %va", -0.5f, 1.5f);
}

TEST_F(LavapipeShaders, FunctionsOfVectors) {
  const auto number = [&](const std::string& name) {
    floats("%x = OpExtInst %float %glsl " + name + "\n%r = OpCompositeConstruct %v4 %x %x %x %x");
  };
  number("Length %va"), number("Distance %va %vb");
  for (const std::string name : {"Normalize %va", "FaceForward %va %vb %vc", "Reflect %va %vb"})
    floats("%r = OpExtInst %v4 %glsl " + name);
  floats(
      "%n = OpExtInst %v4 %glsl Normalize %va\n%i_ = OpExtInst %v4 %glsl Normalize %vb\n"
      "%r = OpExtInst %v4 %glsl Refract %i_ %n %eta",
      -10, 10, 1e-5, "%eta = OpConstant %float 0.75");
  floats(
      "%x = OpVectorShuffle %v3 %va %va 0 1 2\n%y = OpVectorShuffle %v3 %vb %vb 1 2 3\n"
      "%z = OpExtInst %v3 %glsl Cross %x %y\n%r = OpCompositeConstruct %v4 %z %f1");
}

TEST_F(LavapipeShaders, TranscendentalFunctions) {
  const auto one = [&](const std::string& name, float least, float most, double tolerance = 1e-5) {
    floats("%r = OpExtInst %v4 %glsl " + name, least, most, tolerance);
  };
  one("Sin %va", -10, 10), one("Cos %va", -10, 10), one("Tan %va", -1.5f, 1.5f);
  one("Atan %va", -10, 10), one("Atan2 %va %vb", -10, 10);
  constexpr double kPolynomial = 4e-4;  // how far the driver's is from these two
  one("Asin %va", -1, 1, kPolynomial), one("Acos %va", -1, 1, kPolynomial);
  one("Sinh %va", -3, 3), one("Cosh %va", -3, 3), one("Tanh %va", -3, 3);
  one("Asinh %va", -3, 3), one("Acosh %va", 1, 10), one("Atanh %va", -0.9f, 0.9f);
  one("Exp %va", -10, 10), one("Exp2 %va", -10, 10), one("Log %va", 0.01f, 100), one("Log2 %va", 0.01f, 100);
  one("Pow %va %vb", 0.1f, 3);
}

TEST_F(LavapipeShaders, FunctionsOfIntegersAndBits) {
  for (const std::string name : {"UMin %vi %vj", "UMax %vi %vj", "FindILsb %vi", "FindUMsb %vi"})
    integers("%r = OpExtInst %u4 %glsl " + name);
  const std::string both = "%x = OpBitcast %i4 %vi\n%y = OpBitcast %i4 %vj\n";
  for (const std::string name : {"SMin %x %y", "SMax %x %y", "SAbs %x", "SSign %x", "FindSMsb %x"})
    integers(both + "%q = OpExtInst %i4 %glsl " + name + "\n%r = OpBitcast %u4 %q");
  integers("%r = OpExtInst %u4 %glsl UClamp %vi %u0000 %u1111");
  const auto packs = [&](const std::string& name, const std::string& from) {
    integers("%w = OpExtInst %uint %glsl Pack" + name + " " + from + "\n%r = OpCompositeConstruct %u4 %w %w %w %w");
  };
  for (const std::string name : {"Snorm4x8", "Unorm4x8"}) packs(name, "%va");
  for (const std::string name : {"Snorm2x16", "Unorm2x16", "Half2x16"}) {
    expect_near(
        points({.body = "%p = OpVectorShuffle %v2 %va %va 0 1\n%w = OpExtInst %uint %glsl Pack" + name +
                        " %p\n%r = OpCompositeConstruct %u4 %w %w %w %w\nOpStore %iout %r\nOpStore %out %f0000"},
               -1.2f, 1.2f),
        name);
    floats("%w = OpCompositeExtract %uint %vk 1\n%m = OpBitwiseAnd %uint %w %small\n%p = OpExtInst %v2 %glsl Unpack" +
               name + " %m\n%r = OpVectorShuffle %v4 %p %p 0 1 0 1",
           -1, 1, 1e-5,
           "%small = OpConstant %uint 0x6fff6fff");  // finite half floats
  }
  for (const std::string name : {"Snorm4x8", "Unorm4x8"})
    floats("%w = OpCompositeExtract %uint %vk 1\n%r = OpExtInst %v4 %glsl Unpack" + name + " %w");
  floats("%n = OpBitwiseAnd %u4 %vi %seven\n%e = OpBitcast %i4 %n\n%r = OpExtInst %v4 %glsl Ldexp %va %e", -10, 10,
         1e-5, "%u7 = OpConstant %uint 7\n%seven = OpConstantComposite %u4 %u7 %u7 %u7 %u7");
  const std::string results = "%parts = OpTypeStruct %v4 %i4\n%wholes = OpTypeStruct %v4 %v4";
  floats("%p = OpExtInst %parts %glsl FrexpStruct %va\n%r = OpCompositeExtract %v4 %p 0", -10, 10, 1e-5, results);
  integers("%p = OpExtInst %parts %glsl FrexpStruct %va\n%q = OpCompositeExtract %i4 %p 1\n%r = OpBitcast %u4 %q",
           results);
  for (const std::string part : {"0", "1"})
    floats("%p = OpExtInst %wholes %glsl ModfStruct %va\n%r = OpCompositeExtract %v4 %p " + part, -10, 10, 1e-5,
           results);
}

TEST_F(LavapipeShaders, Composites) {
  floats(
      "%n = OpBitwiseAnd %u4 %vi %u3333\n%k0 = OpCompositeExtract %uint %n 0\n%k1 = OpCompositeExtract %uint %n 1\n"
      "%x = OpVectorExtractDynamic %float %va %k0\n%r = OpVectorInsertDynamic %v4 %vb %x %k1",
      -10, 10, 1e-5, "%u3333 = OpConstantComposite %u4 %u3_ %u3_ %u3_ %u3_");
  floats(
      "%s = OpCompositeConstruct %pair %va %f1\n%x = OpCompositeExtract %float %s 0 2\n"
      "%t = OpCompositeInsert %pair %x %s 0 1\n%v = OpCompositeExtract %v4 %t 0\n%copy = OpCopyObject %v4 %v\n"
      "%r = OpVectorShuffle %v4 %copy %vb 7 1 4 2",
      -10, 10, 1e-5, "%pair = OpTypeStruct %v4 %float");
}

// Of a buffer: a number, an array, matrices by rows and by columns, and an array without end; and push constants.
TEST_F(LavapipeShaders, BuffersAndPushConstants) {
  for (const std::string storage : {"Uniform", "StorageBuffer"}) {
    const std::string tail =
        storage == "Uniform" ? "%pairs = OpTypeArray %v2 %n8\n" : "%pairs = OpTypeRuntimeArray %v2\n";
    const std::string stride = storage == "Uniform" ? "16" : "8";
    ShaderCase shader = points(
        {.body = R"(
%element = OpBitwiseAnd %uint %vi0 %u3_
%p = OpAccessChain %to_float %buffer %i1 %element %i1
%x = OpLoad %float %p
%q = OpAccessChain %to_m23 %buffer %i2_
%m = OpLoad %m23 %q
%ab = OpVectorShuffle %v2 %va %va 0 1
%mv = OpMatrixTimesVector %v3 %m %ab
%k1 = OpBitwiseAnd %uint %element %u1
%s = OpAccessChain %to_v3 %buffer %i3_ %k1
%column = OpLoad %v3 %s
%sum = OpFAdd %v3 %mv %column
%u = OpAccessChain %to_float %buffer %i2_ %k1 %i2_
%y = OpLoad %float %u
%t = OpAccessChain %to_v2 %buffer %i4_ %element
%pair = OpLoad %v2 %t
%z = OpDot %float %pair %ab
%to_w = OpAccessChain %to_pushed %pushed %i1 %element
%w = OpLoad %float %to_w
%xy = OpFMul %float %x %y
%zw = OpFMul %float %z %w
%total = OpFAdd %float %xy %zw
%r = OpCompositeConstruct %v4 %sum %total
OpStore %out %r
OpStore %iout %u0000
)",
         .globals = "%n4 = OpConstant %uint 4\n%n8 = OpConstant %uint 8\n%list = OpTypeArray %v3 %n4\n"
                    "%m23 = OpTypeMatrix %v3 2\n" +
                    tail + "%block = OpTypeStruct %float %list %m23 %m23 %pairs\n%to_block = OpTypePointer " + storage +
                    " %block\n%to_float = OpTypePointer " + storage + " %float\n%to_v2 = OpTypePointer " + storage +
                    " %v2\n%to_v3 = OpTypePointer " + storage + " %v3\n%to_m23 = OpTypePointer " + storage +
                    " %m23\n%buffer = OpVariable %to_block " + storage + R"(
%push = OpTypeStruct %float %v4
%to_push = OpTypePointer PushConstant %push
%to_pushed = OpTypePointer PushConstant %float
%pushed = OpVariable %to_push PushConstant
)",
         .decorations = R"(
OpDecorate %block Block
OpDecorate %push Block
OpMemberDecorate %push 0 Offset 0
OpMemberDecorate %push 1 Offset 16
OpDecorate %buffer DescriptorSet 1
OpDecorate %buffer Binding 3
OpDecorate %list ArrayStride 16
OpMemberDecorate %block 0 Offset 0
OpMemberDecorate %block 1 Offset 16
OpMemberDecorate %block 2 Offset 80
OpMemberDecorate %block 2 MatrixStride 16
OpMemberDecorate %block 2 RowMajor
OpMemberDecorate %block 3 Offset 128
OpMemberDecorate %block 3 MatrixStride 16
OpMemberDecorate %block 3 ColMajor
OpMemberDecorate %block 4 Offset 160
OpDecorate %pairs ArrayStride )" +
                        stride + "\n"});
    const auto numbers = [&](std::size_t count) {
      std::vector<std::uint8_t> bytes;
      for (std::size_t i = 0; i < count; ++i) {
        const auto number = std::bit_cast<std::array<std::uint8_t, 4>>(uniform(-4, 4));
        bytes.insert(bytes.end(), number.begin(), number.end());
      }
      return bytes;
    };
    // The last ones of the list without end are missing, and read as 0.
    shader.use.buffers.push_back({.set = 1, .binding = 3, .bytes = numbers(storage == "Uniform" ? 72 : 44)});
    shader.use.push_constants = numbers(8);
    expect_near(shader, storage);
  }
}

TEST_F(LavapipeShaders, LocalArrays) {
  floats(
      R"(
%list = OpVariable %to_list Function
; begin
%k1 = OpBitwiseAnd %uint %vi0 %u3_
%k2 = OpCompositeExtract %uint %vj 0
%k3 = OpBitwiseAnd %uint %k2 %u3_
%p0 = OpAccessChain %to_v4 %list %i0
OpStore %p0 %va
%p1 = OpAccessChain %to_v4 %list %i1
OpStore %p1 %vb
%p2 = OpAccessChain %to_v4 %list %i2_
OpStore %p2 %vc
%p3 = OpAccessChain %to_v4 %list %i3_
OpStore %p3 %f0000
%q = OpAccessChain %to_v4 %list %k1
OpStore %q %f1111
%one = OpAccessChain %to_float %list %k3 %k1
OpStore %one %f2
%s = OpAccessChain %to_v4 %list %k3
%r = OpLoad %v4 %s)",
      -10, 10, 1e-5,
      "%list4 = OpTypeArray %v4 %u4_\n%to_list = OpTypePointer Function %list4\n%to_v4 = OpTypePointer Function %v4\n"
      "%to_float = OpTypePointer Function %float");
}

// A loop with two ways out of which lanes take different ones, a switch that falls through, and a discard.
TEST_F(LavapipeShaders, Flow) {
  const std::string body = R"(
%most = OpBitwiseAnd %uint %vi0 %u15
%limit = OpCompositeExtract %float %va 0
OpBranch %header
%header = OpLabel
%n = OpPhi %uint %u0 %entry %n2 %again
%x = OpPhi %float %f1 %entry %x2 %again
%y = OpPhi %float %f2 %entry %x %again
OpLoopMerge %after %again None
OpBranch %test
%test = OpLabel
%goes_on = OpULessThan %bool %n %most
OpBranchConditional %goes_on %body %after
%body = OpLabel
%odd = OpBitwiseAnd %uint %n %u3_
OpSelectionMerge %chosen None
OpSwitch %odd %other 1 %first 2 %second
%first = OpLabel
%a1 = OpFAdd %float %x %f2
OpBranch %second
%second = OpLabel
%a2 = OpPhi %float %x %body %a1 %first
%a3 = OpFMul %float %a2 %y
OpBranch %chosen
%other = OpLabel
%a4 = OpFSub %float %x %y
OpBranch %chosen
%chosen = OpLabel
%z = OpPhi %float %a3 %second %a4 %other
%leaves = OpFOrdGreaterThan %bool %z %limit
OpSelectionMerge %stays None
OpBranchConditional %leaves %out_of_it %stays
%out_of_it = OpLabel
OpBranch %after
%stays = OpLabel
%x2 = OpFMul %float %z %half_
OpBranch %again
%again = OpLabel
%n2 = OpIAdd %uint %n %u1
OpBranch %header
%after = OpLabel
%result = OpPhi %float %x %test %z %out_of_it
%count = OpPhi %uint %n %test %n %out_of_it
%b0 = OpCompositeExtract %float %vb 0
%small = OpFOrdLessThan %bool %b0 %f0
OpSelectionMerge %kept None
OpBranchConditional %small %gone %kept
%gone = OpLabel
%c0 = OpCompositeExtract %float %vc 0
%smaller = OpFOrdLessThan %bool %c0 %f0
OpSelectionMerge %end None
OpBranchConditional %smaller %killed %end
%killed = OpLabel
OpKill
%end = OpLabel
OpBranch %kept
%kept = OpLabel
)";
  const ShaderParts parts{.body = body,
                          .floats = "%result %result %b0 %f1",
                          .integers = "%count %most %u0 %u1",
                          .globals = "%u15 = OpConstant %uint 15\n%half_ = OpConstant %float 0.5\n"};
  expect_near(points(parts), "points");
  expect_near(triangle(parts), "triangle");
}

TEST_F(LavapipeShaders, Functions) {
  expect_near(
      points({.body = "%x = OpFunctionCall %v4 %twice %va\n%r = OpFunctionCall %v4 %twice %x\nOpStore %out %r\n"
                      "OpStore %iout %u0000",
              .globals = "%of_v4 = OpTypeFunction %v4 %v4",
              .functions = "%twice = OpFunction %v4 None %of_v4\n%p = OpFunctionParameter %v4\n%start = OpLabel\n"
                           "%q = OpFAdd %v4 %p %p\nOpReturnValue %q\nOpFunctionEnd\n"}),
      "functions");
}

TEST_F(LavapipeShaders, SpecializationConstants) {
  ShaderCase shader = points({.body = "%r = OpVectorTimesScalar %v4 %va %factor\nOpStore %out %r\nOpStore %iout %u0000",
                              .globals = "%factor = OpSpecConstant %float 1",
                              .decorations = "OpDecorate %factor SpecId 7"});
  shader.specialization = {{.id = 7, .bits = bits_of(2.5f)}};
  expect_near(shader, "a factor");
}

TEST_F(LavapipeShaders, DifferencesInQuads) {
  // Coarse ones are left out: the driver's are fine ones, as they may be.
  for (const std::string op : {"DPdx", "DPdy", "DPdxFine", "DPdyFine", "Fwidth", "FwidthFine"})
    expect_near(triangle({.body = "%x = OpFMul %v4 %va %vb\n%r = Op" + op +
                                  " %v4 %x\nOpStore %out %r\n"
                                  "OpStore %iout %u0000"}),
                op);
}

TEST_F(LavapipeShaders, BuiltInInputs) {
  const ShaderParts parts{.body = R"(
%p = OpLoad %v4 %coord
%f = OpLoad %bool %front
%n = OpSelect %uint %f %u1 %u2_
%counts = OpCompositeConstruct %u4 %n %n %n %n
OpStore %out %p
OpStore %iout %counts
)",
                          .globals =
                              "%in_bool = OpTypePointer Input %bool\n%coord = OpVariable %in_v4 Input\n"
                              "%front = OpVariable %in_bool Input",
                          .decorations = "OpDecorate %coord BuiltIn FragCoord\nOpDecorate %front BuiltIn FrontFacing",
                          .interface = "%coord %front"};
  expect_near(points(parts), "points");
  expect_near(triangle(parts), "triangle");
}

}  // namespace
}  // namespace beampipe
