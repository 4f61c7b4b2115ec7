// Uniform bytes, push constants, local arrays, inputs and outputs.
#include "tests/stages/spirv/shader_text.h"

namespace beampipe {
namespace {

std::span<const std::byte> bytes_of(const std::vector<float>& numbers) { return std::as_bytes(std::span(numbers)); }

// struct { float x; vec3 list[4]; layout(row_major) mat2x3 rows; mat2x3 columns; vec2 pairs[] }
constexpr const char* kBlockTypes = R"(
%n4 = OpConstant %uint 4
%list = OpTypeArray %v3 %n4
%m23 = OpTypeMatrix %v3 2
%pairs = OpTypeRuntimeArray %v2
%block = OpTypeStruct %float %list %m23 %m23 %pairs
%to_block = OpTypePointer StorageBuffer %block
%to_float = OpTypePointer StorageBuffer %float
%to_v2 = OpTypePointer StorageBuffer %v2
%to_v3 = OpTypePointer StorageBuffer %v3
%to_m23 = OpTypePointer StorageBuffer %m23
%buffer = OpVariable %to_block StorageBuffer
)";
constexpr const char* kBlockDecorations = R"(
OpDecorate %block Block
OpDecorate %buffer DescriptorSet 1
OpDecorate %buffer Binding 3
OpDecorate %list ArrayStride 16
OpDecorate %pairs ArrayStride 8
OpMemberDecorate %block 0 Offset 0
OpMemberDecorate %block 1 Offset 16
OpMemberDecorate %block 2 Offset 80
OpMemberDecorate %block 2 MatrixStride 8
OpMemberDecorate %block 2 RowMajor
OpMemberDecorate %block 3 Offset 112
OpMemberDecorate %block 3 MatrixStride 16
OpMemberDecorate %block 3 ColMajor
OpMemberDecorate %block 4 Offset 144
)";

// The number at byte 4 n is n.
std::vector<float> numbered(std::size_t count) {
  std::vector<float> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0.0f);
  return numbers;
}

TEST(SpirvMemory, OffsetsOfMembersElementsAndColumns) {
  TestShader shader(ShaderParts{.body = R"(
%p = OpAccessChain %to_float %buffer %i1 %i2_ %i1
%x = OpLoad %float %p
%q = OpAccessChain %to_m23 %buffer %i2_
%m = OpLoad %m23 %q
%y = OpCompositeExtract %float %m 1 2
%s = OpAccessChain %to_v3 %buffer %i2_ %i1
%column = OpLoad %v3 %s
%z = OpCompositeExtract %float %column 1
%t = OpAccessChain %to_float %buffer %i3_ %i1 %i2_
%w = OpLoad %float %t
)",
                                .floats = "%x %y %z %w",
                                .globals = kBlockTypes,
                                .decorations = kBlockDecorations});
  ASSERT_EQ(shader.program.buffers.size(), 1u);
  EXPECT_EQ(shader.program.buffers[0].set, 1u);
  EXPECT_EQ(shader.program.buffers[0].binding, 3u);
  const std::vector<float> numbers = numbered(64);
  shader.resources.buffers = {bytes_of(numbers)};
  shader.run();
  EXPECT_EQ(shader.number(0, 7), (16 + 2 * 16 + 4) / 4);   // list[2].y
  EXPECT_EQ(shader.number(1, 7), (80 + 2 * 8 + 4) / 4);    // row 2, column 1
  EXPECT_EQ(shader.number(2, 7), (80 + 1 * 8 + 4) / 4);    // row 1, column 1
  EXPECT_EQ(shader.number(3, 7), (112 + 1 * 16 + 8) / 4);  // column 1, row 2
}

// struct { vec4 first; struct { float x; vec3 list[4]; layout(row_major) mat2x3 rows; mat2x3 columns } all; }
// `all` is copied as a whole, and lanes choose numbers of the copy. One of list[3] is changed, because SPIRV-Tools
// would have lanes read the buffer otherwise.
TEST(SpirvMemory, StructuresAreReadAsAWhole) {
  TestShader shader(ShaderParts{.body = R"(
%copy = OpVariable %to_copy Function
; begin
%p = OpAccessChain %to_inner %buffer %i1
%all = OpLoad %inner %p
OpStore %copy %all
%p4 = OpAccessChain %to_number %copy %i1 %i3_ %i0
OpStore %p4 %f0
%p0 = OpAccessChain %to_number %copy %i0
%x = OpLoad %float %p0
%p1 = OpAccessChain %to_number %copy %i1 %vi0 %vi1
%y = OpLoad %float %p1
%p2 = OpAccessChain %to_number %copy %i2_ %vi0 %vi1
%z = OpLoad %float %p2
%p3 = OpAccessChain %to_number %copy %i3_ %vi0 %vi1
%w = OpLoad %float %p3
)",
                                .floats = "%x %y %z %w",
                                .globals = R"(
%n4 = OpConstant %uint 4
%list = OpTypeArray %v3 %n4
%m23 = OpTypeMatrix %v3 2
%inner = OpTypeStruct %float %list %m23 %m23
%block = OpTypeStruct %v4 %inner
%to_block = OpTypePointer Uniform %block
%to_inner = OpTypePointer Uniform %inner
%to_copy = OpTypePointer Function %inner
%to_number = OpTypePointer Function %float
%buffer = OpVariable %to_block Uniform
)",
                                .decorations = R"(
OpDecorate %block Block
OpDecorate %buffer DescriptorSet 0
OpDecorate %buffer Binding 0
OpDecorate %list ArrayStride 16
OpMemberDecorate %block 0 Offset 0
OpMemberDecorate %block 1 Offset 16
OpMemberDecorate %inner 0 Offset 0
OpMemberDecorate %inner 1 Offset 16
OpMemberDecorate %inner 2 Offset 80
OpMemberDecorate %inner 2 MatrixStride 16
OpMemberDecorate %inner 2 RowMajor
OpMemberDecorate %inner 3 Offset 128
OpMemberDecorate %inner 3 MatrixStride 16
OpMemberDecorate %inner 3 ColMajor
)"});
  const std::vector<float> numbers = numbered(44);
  shader.resources.buffers = {bytes_of(numbers)};
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane)
    shader.set_integer(3, 0, lane, lane % 2), shader.set_integer(3, 1, lane, lane / 2 % 3);
  shader.run();
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) {
    const float column = static_cast<float>(lane % 2), row = static_cast<float>(lane / 2 % 3);  // or element and part
    EXPECT_EQ(shader.number(0, lane), 4);
    EXPECT_EQ(shader.number(1, lane), 8 + 4 * column + row);
    EXPECT_EQ(shader.number(2, lane), 24 + column + 4 * row);
    EXPECT_EQ(shader.number(3, lane), 36 + 4 * column + row);
  }
}

TEST(SpirvMemory, IndicesOfLanesAndBounds) {
  TestShader shader(ShaderParts{.body = R"(
%p = OpAccessChain %to_v2 %buffer %i4_ %vi0
%pair = OpLoad %v2 %p
%q = OpAccessChain %to_float %buffer %i1 %vi0 %i1
%y = OpLoad %float %q
)",
                                .floats = "%pair %y %f0",
                                .globals = kBlockTypes,
                                .decorations = kBlockDecorations});
  const std::vector<float> numbers = numbered(41);  // ends within a pair
  shader.resources.buffers = {bytes_of(numbers)};
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) shader.set_integer(3, 0, lane, lane);
  shader.set_integer(3, 0, 60, ~0u), shader.set_integer(3, 0, 61, 0x40000000u),
      shader.set_integer(3, 0, 62, 0x20000000u);
  shader.run();
  const auto at = [&](std::uint64_t byte) { return byte / 4 < numbers.size() ? static_cast<float>(byte / 4) : 0.0f; };
  for (std::uint32_t lane = 0; lane < 60; ++lane) {
    EXPECT_EQ(shader.number(0, lane), at(144 + 8 * lane));
    EXPECT_EQ(shader.number(1, lane), at(144 + 8 * lane + 4));
    EXPECT_EQ(shader.number(2, lane), at(16 + 16 * lane + 4));
  }
  EXPECT_EQ(shader.number(0, 60), at(144 - 8));  // inside the buffer all the same
  // Nothing is bound.
  shader.resources.buffers.clear();
  shader.run();
  EXPECT_EQ(shader.number(0, 0), 0);
}

TEST(SpirvMemory, PushConstantsAndNarrowNumbers) {
  TestShader shader(ShaderParts{.body = R"(
%p0 = OpAccessChain %to_half_ %constants %i0 %i1
%h = OpLoad %half %p0
%x = OpFConvert %float %h
%p1 = OpAccessChain %to_short %constants %i1
%s = OpLoad %short %p1
%y = OpConvertSToF %float %s
%p2 = OpAccessChain %to_uint %constants %i2_
%u = OpLoad %uint %p2
%z = OpConvertUToF %float %u
)",
                                .floats = "%x %y %z %f1",
                                .globals = R"(
%block = OpTypeStruct %h2 %short %uint
%to_block = OpTypePointer PushConstant %block
%to_half_ = OpTypePointer PushConstant %half
%to_short = OpTypePointer PushConstant %short
%to_uint = OpTypePointer PushConstant %uint
%constants = OpVariable %to_block PushConstant
)",
                                .decorations = R"(
OpDecorate %block Block
OpMemberDecorate %block 0 Offset 0
OpMemberDecorate %block 1 Offset 4
OpMemberDecorate %block 2 Offset 8
)",
                                .capabilities = "OpCapability StoragePushConstant16\n"});
  const std::array<std::uint16_t, 6> words{0, 0xc100, 0xfff9, 0, 1000, 0};  // -2.5, -7, 1000
  shader.resources.buffers = {std::as_bytes(std::span(words))};
  EXPECT_EQ(shader.program.buffers[0].set, kNoRow);
  shader.run();
  EXPECT_EQ(shader.number(0, 0), -2.5f);
  EXPECT_EQ(shader.number(1, 0), -7.0f);
  EXPECT_EQ(shader.number(2, 0), 1000.0f);
}

TEST(SpirvMemory, ArraysOfBuffersAsZinkHasThem) {
  TestShader shader(ShaderParts{.body = R"(
%p = OpAccessChain %to_block %buffers %u0
%q = OpAccessChain %to_array %p %i0
%s = OpAccessChain %to_uint %q %u3_
%x = OpLoad %uint %s
)",
                                .integers = "%x %x %x %x",
                                .globals = R"(
%n8 = OpConstant %uint 8
%array = OpTypeArray %uint %n8
%block = OpTypeStruct %array
%blocks = OpTypeArray %block %u1
%to_blocks = OpTypePointer Uniform %blocks
%to_block = OpTypePointer Uniform %block
%to_array = OpTypePointer Uniform %array
%to_uint = OpTypePointer Uniform %uint
%buffers = OpVariable %to_blocks Uniform
)",
                                .decorations = R"(
OpDecorate %array ArrayStride 4
OpDecorate %block Block
OpMemberDecorate %block 0 Offset 0
OpDecorate %buffers DescriptorSet 0
OpDecorate %buffers Binding 4
)"});
  const std::array<std::uint32_t, 8> words{1, 2, 3, 44};
  shader.resources.buffers = {std::as_bytes(std::span(words))};
  shader.run();
  EXPECT_EQ(shader.integer(0, 9), 44u);
}

// Some lanes write into an array of their own, and each reads another place.
TEST(SpirvMemory, LocalArraysWithIndicesOfLanes) {
  TestShader shader(ShaderParts{.body = R"(
%table = OpVariable %to_table Function
; begin
OpStore %table %tens
%p = OpAccessChain %pu %table %vi0 %i1
%before = OpLoad %uint %p
%is_odd = OpBitwiseAnd %uint %vi0 %u1
%odd = OpIEqual %bool %is_odd %u1
OpSelectionMerge %end None
OpBranchConditional %odd %write %end
%write = OpLabel
OpStore %p %vi0
OpBranch %end
%end = OpLabel
%q = OpAccessChain %pu %table %vi1 %i1
%after = OpLoad %uint %q
%whole = OpLoad %table_type %table
%x = OpCompositeExtract %uint %whole 2 0
)",
                                .integers = "%before %after %x %u0",
                                .globals = R"(
%table_type = OpTypeArray %u2 %u4_
%to_table = OpTypePointer Function %table_type
%u10 = OpConstant %uint 10
%u20 = OpConstant %uint 20
%u30 = OpConstant %uint 30
%t0 = OpConstantComposite %u2 %u0 %u10
%t1 = OpConstantComposite %u2 %u1 %u20
%t2 = OpConstantComposite %u2 %u2_ %u30
%t3 = OpConstantComposite %u2 %u3_ %u10
%tens = OpConstantComposite %table_type %t0 %t1 %t2 %t3
)"});
  const std::array<std::uint32_t, 4> tens{10, 20, 30, 10};
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane)
    shader.set_integer(3, 0, lane, lane % 8), shader.set_integer(3, 1, lane, lane / 8);
  shader.run();
  for (std::uint32_t lane = 0; lane < kShaderLanes; ++lane) {
    const std::uint32_t n = lane % 8, m = lane / 8;
    EXPECT_EQ(shader.integer(0, lane), n < 4 ? tens[n] : 0u) << lane;  // outside it is 0
    EXPECT_EQ(shader.integer(1, lane), m >= 4 ? 0u : n == m && n % 2 ? n : tens[m]) << lane;
    EXPECT_EQ(shader.integer(2, lane), 2u);
  }
}

TEST(SpirvMemory, TheInterface) {
  const TestShader shader(
      ShaderParts{.body = R"(
%where = OpLoad %v4 %place
%x = OpCompositeExtract %float %where 2
%f = OpLoad %bool %front
%y = OpSelect %float %f %f1 %f2
%p = OpAccessChain %in_v2 %array %i1
%q = OpLoad %v2 %p
%r = OpCompositeConstruct %v4 %x %y %q
OpStore %out %r
OpStore %depth %x
OpStore %second %r
)",
                  .globals = R"(
%in_bool = OpTypePointer Input %bool
%in_v2 = OpTypePointer Input %v2
%v2s = OpTypeArray %v2 %u2_
%in_v2s = OpTypePointer Input %v2s
%out_float = OpTypePointer Output %float
%place = OpVariable %in_v4 Input
%front = OpVariable %in_bool Input
%array = OpVariable %in_v2s Input
%depth = OpVariable %out_float Output
%second = OpVariable %out_v4 Output
)",
                  .decorations = R"(
OpDecorate %place BuiltIn FragCoord
OpDecorate %front BuiltIn FrontFacing
OpDecorate %array Location 8
OpDecorate %array Component 1
OpDecorate %array NoPerspective
OpDecorate %array Centroid
OpDecorate %depth BuiltIn FragDepth
OpDecorate %second Location 0
OpDecorate %second Index 1
)",
                  .interface = "%place %front %array %depth %second",
                  .modes = "OpExecutionMode %main EarlyFragmentTests\nOpExecutionMode %main DepthReplacing\n"});
  const LaneProgram& program = shader.program;
  EXPECT_TRUE(program.tests_early);
  EXPECT_FALSE(program.discards);
  EXPECT_FALSE(program.takes_differences);
  std::size_t array_rows = 0, places = 0, fronts = 0;
  for (const InterfaceRow& row : program.inputs) {
    places += row.built_in == spv::BuiltInFragCoord && row.is_float;
    fronts += row.built_in == spv::BuiltInFrontFacing && !row.is_float;
    if (row.location == 3) {
      EXPECT_EQ(row.interpolation, Interpolation::flat);
    }
    if (row.location == 0) {
      EXPECT_EQ(row.interpolation, Interpolation::perspective);
    }
    if (row.location != 8 && row.location != 9) continue;
    EXPECT_EQ(row.component, 1 + array_rows % 2);
    EXPECT_EQ(row.location, 8 + array_rows / 2);
    EXPECT_EQ(row.interpolation, Interpolation::linear);
    EXPECT_TRUE(row.at_centroid);
    ++array_rows;
  }
  EXPECT_EQ(array_rows, 4u);
  EXPECT_EQ(places, 4u);
  EXPECT_EQ(fronts, 1u);
  std::size_t depths = 0, seconds = 0;
  for (const InterfaceRow& row : program.outputs) {
    depths += row.built_in == spv::BuiltInFragDepth;
    seconds += row.location == 0 && row.index == 1;
  }
  EXPECT_EQ(depths, 1u);
  EXPECT_EQ(seconds, 4u);
}

// Members of a block follow each other, from its location or their own on.
TEST(SpirvMemory, LocationsOfBlocks) {
  TestShader shader({.body = R"(
%from = OpAccessChain %in_v4 %together %i3_
%first = OpLoad %v4 %from
%in_float = OpAccessChain %to_float %apart %i1
%last = OpLoad %float %in_float
%r = OpVectorTimesScalar %v4 %first %last
OpStore %out %r
)",
                     .globals = R"(
%pairs = OpTypeArray %v2 %u2_
%block = OpTypeStruct %v3 %float %pairs %v4
%to_block = OpTypePointer Input %block
%other_block = OpTypeStruct %v2 %float
%to_other = OpTypePointer Input %other_block
%to_float = OpTypePointer Input %float
%together = OpVariable %to_block Input
%apart = OpVariable %to_other Input
)",
                     .decorations = R"(
OpDecorate %block Block
OpDecorate %together Location 8
OpMemberDecorate %block 1 NoPerspective
OpDecorate %other_block Block
OpMemberDecorate %other_block 0 Location 21
OpMemberDecorate %other_block 1 Location 20
OpMemberDecorate %other_block 1 Component 3
)",
                     .interface = "%together %apart"});
  std::map<std::uint32_t, std::string> found;  // by location: its components
  for (const InterfaceRow& row : shader.program.inputs) {
    if (row.location < 8) continue;
    found[row.location] += std::to_string(row.component);
    EXPECT_EQ(row.interpolation, row.location == 9 ? Interpolation::linear : Interpolation::perspective);
  }
  EXPECT_EQ(found, (std::map<std::uint32_t, std::string>{
                       {8, "012"}, {9, "0"}, {10, "01"}, {11, "01"}, {12, "0123"}, {20, "3"}, {21, "01"}}));
}

}  // namespace
}  // namespace beampipe
