#include "tools/machine_memory.h"

#include <gtest/gtest.h>

namespace beampipe {
namespace {

TEST(MachineMemory, IsAskedForBeforeItIsTaken) {
  Frame frame;
  frame.width = frame.height = 16384;
  const Technique msaa = parse_technique("msaa:1"), dvm = parse_technique("dvm");
  constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;
  require_memory(msaa, frame, "frame 0", 4 * kGiB);
  require_memory(dvm, frame, "frame 0", 32 * kGiB);
  try {
    require_memory(dvm, frame, "frame 3", 16 * kGiB);
    FAIL() << "dvm keeps more than 100 bytes per pixel";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(),
                 "frame 3: dvm needs at least 27904 MiB for 16384 x 16384 pixels, and this machine has 16384");
  }
}

TEST(MachineMemory, IsKnown) { EXPECT_GT(machine_memory(), std::uint64_t{1} << 28); }

}  // namespace
}  // namespace beampipe
