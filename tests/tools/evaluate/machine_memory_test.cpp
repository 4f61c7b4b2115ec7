#include "tools/evaluate/machine_memory.h"

#include <gtest/gtest.h>

#include "pipeline/technique.h"

namespace beampipe {
namespace {

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

std::string refusal(const Trace& trace, const char* spec, std::uint64_t memory) {
  try {
    require_memory(trace, trace.frames[0], parse_technique(spec).working_bytes_per_pixel, spec, memory);
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(MachineMemory, OfPixelsIsAskedForBeforeItIsTaken) {
  Trace trace;
  trace.frames.resize(1);
  trace.frames[0].width = trace.frames[0].height = 16384;
  EXPECT_EQ(refusal(trace, "msaa:1", 4 * kGiB), "");
  EXPECT_EQ(refusal(trace, "dvm", 32 * kGiB), "");
  EXPECT_EQ(refusal(trace, "dvm", 16 * kGiB),
            "dvm: 16384 x 16384 pixels and 0 triangles may need 30976 MiB, and this machine has 16384");
}

TEST(MachineMemory, OfTrianglesThatAreDrawnAgainAndAgainIsAskedForBeforeItIsTaken) {
  Trace trace;
  trace.meshes.resize(1);
  trace.meshes[0].triangles.resize(30000);
  trace.frames.resize(1);
  trace.frames[0].draws.resize(30000);
  EXPECT_EQ(refusal(trace, "beam", 128 * kGiB), "");
  EXPECT_NE(refusal(trace, "beam", 64 * kGiB).find("900000000 triangles may need 102"), std::string::npos);
}

TEST(MachineMemory, IsKnown) { EXPECT_GT(machine_memory(), kGiB / 4); }

}  // namespace
}  // namespace beampipe
