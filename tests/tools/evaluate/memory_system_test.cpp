#include "tools/evaluate/memory_system.h"

#include "tests/message_of.h"
#include "tests/tools/fixtures.h"
#include "traces/files/trace_io.h"

namespace beampipe::memory_system_test {

MemoryParameters parse(const std::string& parameters, const std::string& sources) {
  const std::string file = "m.json";
  const Json json = parse_json_text(R"({"parameters": {)" + parameters + R"(}, "sources": {)" + sources + "}}", file);
  return memory_system_form()(JsonCursor(json, file));
}

std::string refusal(const std::string& parameters, const std::string& sources = "") {
  return message_of<TraceError>([&] { parse(parameters, sources); });
}

TEST(MemorySystem, WhatIsLeftOutIsTheDefault) {
  EXPECT_EQ(parse("", ""), MemoryParameters{});
  MemoryParameters expected;
  expected.l2.bytes = 65536;
  EXPECT_EQ(parse("\"l2_bytes\": 65536", "\"l2_bytes\": \"choice\""), expected);
}

TEST(MemorySystem, EveryParameterArrives) {
  MemoryParameters expected;
  expected.sector_bytes = 64;
  expected.l1 = {16384, 4, 64}, expected.l2 = {1048576, 16, 64}, expected.rop = {65536, 4, 256};
  expected.compression = false;
  expected.plane_bytes = 10;
  expected.framebuffer = Place::in_memory;
  expected.on_chip_bytes = 131072, expected.bins_per_core = 3, expected.cores = 7;
  expected.binned = false;
  expected.bin_pixels = 16;
  const std::string file = "m.json";
  const Json json = parse_json_text(R"({"sector_bytes": 64, "line_bytes": 64, "l1_bytes": 16384, "l1_ways": 4,
    "l2_bytes": 1048576, "l2_ways": 16, "rop_bytes": 65536, "rop_ways": 4, "rop_line_bytes": 256, "compression": false,
    "plane_bytes": 10, "framebuffer": "in-memory", "on_chip_bytes": 131072, "bins_per_core": 3, "cores": 7,
    "binned": false, "bin_pixels": 16})",
                                    file);
  MemoryParameters memory;
  set_parameters(memory, JsonCursor(json, file));
  EXPECT_EQ(memory, expected);
  EXPECT_EQ(parameters_json(memory), json);
}

TEST(MemorySystem, DifferencesHaveTheNameOfTheParameter) {
  MemoryParameters one, other;
  EXPECT_FALSE(find_difference(one, other));
  other.l2.bytes = 65536, other.cores = 7;
  EXPECT_EQ(find_difference(one, other)->name, "l2_bytes");
  EXPECT_EQ(find_difference(one, other)->first, 4718592);
  EXPECT_EQ(find_difference(one, other)->second, 65536);
  EXPECT_EQ(find_difference(one, other, {"l2_bytes"})->name, "cores");
  EXPECT_FALSE(find_difference(one, other, {"cores", "l2_bytes"}));
}

TEST(MemorySystem, ByTechniqueTakesBackAnotherPlace) {
  MemoryParameters memory;
  memory.framebuffer = Place::in_memory;
  const std::string file = "m.json";
  const Json json = {{"framebuffer", "by-technique"}};
  set_parameters(memory, JsonCursor(json, file));
  EXPECT_EQ(memory, MemoryParameters{});
}

// 80 bytes for each of 64 pixels, which are the fewest.
TEST(MemorySystem, AReasonNamesTheSmallestBinThatFindsNoRoom) {
  const Framebuffer framebuffer = parse_technique("msaa:8").framebuffer;
  MemoryParameters memory;
  memory.on_chip_bytes = 3 * 1024;
  EXPECT_EQ(no_room_text(memory, framebuffer), "") << "pixels belong in memory";
  memory.framebuffer = Place::on_chip;
  EXPECT_EQ(no_room_text(memory, framebuffer), "a bin of 8 x 8 pixels needs 5.0 KiB, a core has 3.0 KiB");
  memory.on_chip_bytes = 5 * 1024;
  EXPECT_EQ(no_room_text(memory, framebuffer), "");
}

TEST(MemorySystem, ErrorsNameTheKey) {
  EXPECT_EQ(refusal("\"l2_byte\": 65536").find("m.json: /parameters/l2_byte: expected one of the keys"), 0u);
  expect_parts(refusal("\"l2_byte\": 65536"), {"(did you mean 'l2_bytes'?)"});
  EXPECT_EQ(refusal("\"sector_bytes\": 48"),
            "m.json: /parameters/sector_bytes: expected a power of two from 32 to 128, found 48");
  EXPECT_EQ(
      refusal("\"binned\": false, \"framebuffer\": \"on-chip\""),
      "m.json: /parameters/framebuffer: expected in-memory or by-technique where nothing is binned, found on-chip");
  EXPECT_EQ(refusal("\"l2_bytes\": 65536"), "m.json: /sources: expected the key \"l2_bytes\", found none");
  EXPECT_EQ(refusal("\"l2_bytes\": 65536", "\"l2_bytes\": \"\""),
            "m.json: /sources/l2_bytes: expected where the value is from, or that it is a choice, found nothing");
  EXPECT_EQ(refusal("", "\"l2_bytes\": \"choice\"").find("m.json: /sources/l2_bytes: expected one of the keys"), 0u);
  EXPECT_EQ(refusal("\"framebuffer\": \"chip\"").find("m.json: /parameters/framebuffer: expected"), 0u);
}

TEST(MemorySystem, ValuesMustFitTogether) {
  EXPECT_EQ(refusal("\"line_bytes\": 512"),
            "m.json: /parameters/line_bytes: expected 1 to 8 sectors, 32 to 256, found 512");
  EXPECT_EQ(
      refusal("\"l2_bytes\": 3071"),
      "m.json: /parameters/l2_bytes: expected room for one set of 24 ways x 128 bytes, at least 3072, found 3071");
  EXPECT_EQ(refusal("\"l2_ways\": 1024, \"line_bytes\": 256, \"l2_bytes\": 262143")
                .find("m.json: /parameters/l2_bytes: expected room for one set of 1024 ways x 256 bytes"),
            0u);
  EXPECT_EQ(refusal("\"rop_ways\": 1024, \"rop_bytes\": 262144", "\"rop_ways\": \"c\", \"rop_bytes\": \"c\""),
            "no error");
  EXPECT_EQ(refusal("\"l1_ways\": 512").find("m.json: /parameters: expected l1_bytes of room for one set"), 0u);
}

}  // namespace beampipe::memory_system_test
