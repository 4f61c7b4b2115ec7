#include "tools/sweep/sweep_plan.h"

#include "tests/message_of.h"
#include "tests/tools/fixtures.h"
#include "tools/evaluate/memory_system.h"
#include "tools/sweep/sweep_jobs.h"
#include "tools/sweep/trace_shelf.h"
#include "traces/files/trace_io.h"

namespace beampipe::sweep_plan_test {

const std::filesystem::path kSource = BEAMPIPE_SOURCE_FOLDER;

class SweepPlanTest : public InFolder {
 protected:
  SweepPlan read(const std::string& text) {
    write_text(folder_ / "plan.json", text);
    return read_sweep_plan((folder_ / "plan.json").string());
  }

  // What follows the name of the file.
  std::string refusal(const std::string& text) {
    const std::string what = message_of<std::exception>(
        [&] { read(R"({"beampipe_sweep": 1, "traces": ["a.json"], "techniques": ["beam"])" + text + "}"); });
    const std::string name = path("plan.json") + ": ";
    return what.starts_with(name) ? what.substr(name.size()) : what;
  }
};

TEST_F(SweepPlanTest, AGridHasEveryCombinationInOrder) {
  const SweepPlan plan = read(R"({"beampipe_sweep": 1, "traces": ["a.json", "b.json"], "techniques": ["beam", "msaa:8"],
    "sizes": ["320x180", "64x36"], "memory_system.l2_bytes": [65536, 131072], "memory_system.compression": [true, false],
    "hardware": ["titan_v", "mali_g710"], "hardware.dram_bytes_per_clk": [100, 200]})");
  EXPECT_EQ(plan.cells.size(), 2u * 2 * 2 * 2 * 4) << "each hardware has a memory system of its own";
  EXPECT_EQ(plan.rows.size(), plan.cells.size() * 2 * 2) << "two rates and two implementations";
  for (const SweepRow& row : plan.rows)
    EXPECT_EQ(plan.memory[plan.cells[row.cell].memory].cores, plan.hardware[row.hardware].memory.cores);
  EXPECT_EQ(plan.traces, (std::vector<std::string>{"a.json", "b.json"}));
  EXPECT_EQ(file_beside_plan(plan, "a.json"), (folder_ / "a.json").string());
  EXPECT_EQ(plan.sizes.back(), (PictureSize{64, 36}));
  EXPECT_TRUE(std::is_sorted(plan.cells.begin(), plan.cells.end()));
  EXPECT_FALSE(plan.memory[1].l2.bytes == 65536 && plan.memory[1].compression);
  EXPECT_EQ(plan.hardware[3].label, "mali_g710");
  EXPECT_EQ(plan.hardware[2].rates.at("dram_bytes_per_clk"), 100);
  EXPECT_EQ(plan.varied_rates, std::vector<std::string>{"dram_bytes_per_clk"});
}

// Whatever the plan says.
TEST_F(SweepPlanTest, MessagesAreOneLine) {
  for (const char* more :
       {R"(, "hardware": ["no\nfile"])", R"(, "points": [{"techniques": ["be\nam"]}])", R"(, "si\nzes": [])"}) {
    const std::string what = refusal(more);
    EXPECT_NE(what, "no error") << more;
    EXPECT_EQ(what.find('\n'), what.npos) << what;
  }
  EXPECT_THROW(read(R"({"beampipe_sweep": 1, "traces": ["a"], "techniques": ["beam"], "hardware": ["none"]})"),
               TraceError);
}

// Where no implementations are named, the hardware's count.
TEST_F(SweepPlanTest, ImplementationsCountAsRows) {
  Json hardware = parse_json((kSource / "tools/evaluate/hardware/titan_v.json").string());
  Json implementations = Json::object();
  for (int i = 0; i < 20; ++i)
    implementations["units" + std::to_string(i)] = hardware.at("implementations").members()[0].value;
  hardware["implementations"] = implementations;
  write_text(folder_ / "h.json", hardware.dump());
  std::string rates = "1";
  for (int i = 2; i <= 900; ++i) rates += "," + std::to_string(i);
  EXPECT_EQ(refusal(R"(, "hardware": ["h.json"], "hardware.dram_bytes_per_clk": [)" + rates + R"(],
                     "memory_system.l2_ways": [1, 2, 3, 4, 5, 6])"),
            "/: expected at most 100000 rows of the table, found more");
}

TEST_F(SweepPlanTest, PointsInheritAxes) {
  const SweepPlan plan = read(R"({"beampipe_sweep": 1, "traces": ["a.json"], "techniques": ["beam"],
    "implementations": ["shaders"],
    "points": [{}, {"techniques": ["msaa:4", "msaa:8"], "memory_system.bin_pixels": [16]}, {"techniques": ["beam"]}]})");
  ASSERT_EQ(plan.cells.size(), 3u) << "the last point is the first one again";
  ASSERT_EQ(plan.rows.size(), 4u);
  EXPECT_EQ(plan.rows[3].cell, plan.rows[0].cell);
  EXPECT_EQ(plan.memory[plan.cells[2].memory].bin_pixels, 16u);
  EXPECT_EQ(plan.techniques[plan.cells[2].technique], "msaa:8");
}

// Whoever renders the largest caches may answer for the smaller ones.
TEST_F(SweepPlanTest, JobsShareWhatOnlyCachesTellApart) {
  const SweepPlan plan = read(R"({"beampipe_sweep": 1, "traces": ["a.json"], "techniques": ["beam", "msaa:8"],
    "memory_system.l2_bytes": [65536, 1048576], "memory_system.l2_ways": [8, 16],
    "memory_system.compression": [true, false], "hardware.clock_mhz": [1000, 2000], "errors": true})");
  const std::vector<SweepJob> jobs = jobs_of(plan);
  ASSERT_EQ(jobs.size(), 1u + 2 * 2);
  EXPECT_FALSE(jobs[0].technique.has_value()) << "the errors of all pictures";
  for (std::size_t i = 1; i < jobs.size(); ++i) {
    ASSERT_EQ(jobs[i].cells.size(), 4u);
    EXPECT_EQ(plan.memory[plan.cells[jobs[i].cells.front()].memory].l2.bytes, 1048576u);
    EXPECT_EQ(plan.memory[plan.cells[jobs[i].cells.back()].memory].l2.bytes, 65536u);
  }
}

TEST_F(SweepPlanTest, CachesThatHoldEverythingCountTheSame) {
  const CacheReach reach{.rop = 1000, .l1 = 1 << 20, .l2 = 1 << 20};
  MemoryParameters a, b;
  EXPECT_TRUE(counts_the_same(a, b, reach));
  a.l2.bytes = 1 << 24, a.l2.ways = 4;
  EXPECT_TRUE(counts_the_same(a, b, reach));
  a.l2.bytes = 1 << 19;
  EXPECT_FALSE(counts_the_same(a, b, reach)) << "does not hold everything";
  EXPECT_FALSE(counts_the_same(b, a, reach)) << "what was rendered did not";
  a = b;
  a.l1.ways = 32;
  EXPECT_FALSE(counts_the_same(a, b, reach));
  a = b;
  a.rop.bytes = 1 << 20;
  EXPECT_TRUE(counts_the_same(a, b, reach));
  a.compression = false;
  EXPECT_FALSE(counts_the_same(a, b, reach));
  a = b;
  a.l2.line_bytes = a.l1.line_bytes = 64;
  EXPECT_FALSE(counts_the_same(a, b, reach));
}

TEST_F(SweepPlanTest, MistakesNameTheKey) {
  EXPECT_EQ(refusal(""), "no error");
  EXPECT_EQ(refusal(R"(, "memory_system.l2_byte": [65536])"),
            "/memory_system.l2_byte: expected one of the keys of a grid (beampipe sweep --help), found "
            "\"memory_system.l2_byte\" (did you mean 'memory_system.l2_bytes'?)");
  EXPECT_EQ(refusal(R"(, "memory_system.l2_bytes": [65536, 7])"),
            "/memory_system.l2_bytes/1: expected an integer 32..268435456, found 7");
  EXPECT_EQ(refusal(R"(, "memory_system.l2_bytes": [])"),
            "/memory_system.l2_bytes: expected at least one value, found none");
  EXPECT_EQ(refusal(R"(, "memory_system.l2_bytes": [65536], "memory_system.l2_ways": [1024])"),
            "/: expected memory_system.l2_bytes of room for one set of 1024 ways x 128 bytes, at least 131072, found "
            "65536");
  EXPECT_EQ(refusal(R"(, "sizes": ["320*180"])"),
            "/sizes/0: expected WIDTHxHEIGHT, each from 1 to 16384, such as \"320x180\", found \"320*180\"");
  EXPECT_EQ(refusal(R"(, "frames": [2, 1])"), "/frames/1: expected a larger number than the one before it, found 1");
  EXPECT_EQ(refusal(R"(, "hardware.dram_bytes_per_clk": [0])"),
            "/hardware.dram_bytes_per_clk/0: expected a number from 1e-06 to 1e+12, found 0");
  EXPECT_EQ(refusal(R"(, "hardware.dram_efficiency": [0.5, 5])"),
            "/hardware.dram_efficiency/1: expected a number up to 1, found 5");
  EXPECT_EQ(refusal(R"(, "implementations": ["shader"])").find("/implementations/0: expected"), 0u);
  expect_parts(refusal(R"(, "points": [{"techniques": ["mssa:8"]}])"), {"did you mean 'msaa'"});
  EXPECT_EQ(refusal(R"(, "points": [{"techniques": ["reference"]}])").find("/points/0/techniques/0: expected"), 0u);
  EXPECT_EQ(refusal(R"(, "memory_system.cores": [0])"),
            "/memory_system.cores/0: expected an integer 1..65536, found 0");
}

// A thousand million combinations in a few lines: nothing is made of them.
TEST_F(SweepPlanTest, HugeGridsAreRefusedAtOnce) {
  const auto list = [](const std::string& name, int first, int count) {
    std::string text = ", \"" + name + "\": [" + std::to_string(first);
    for (int i = 1; i < count; ++i) text += "," + std::to_string(first + i);
    return text + "]";
  };
  const std::string l2 = list("memory_system.l2_bytes", 100000, 1000),
                    l1 = list("memory_system.l1_bytes", 100000, 1000),
                    dram = list("hardware.dram_bytes_per_clk", 1, 1000), clock = list("hardware.clock_mhz", 1, 1000);
  const std::string most = "/: expected at most 100000 rows of the table, found more";
  EXPECT_EQ(refusal(l2 + l1 + dram), most);
  EXPECT_EQ(refusal(l2 + dram), most);
  EXPECT_EQ(refusal(dram + list("hardware.clock_mhz", 1, 11)),
            "/: expected at most 1000 kinds of hardware, found more");
  EXPECT_EQ(refusal(list("memory_system.l2_bytes", 100000, 100)), "no error");
  std::string points = R"(, "points": [{})";
  for (int i = 0; i < 99; ++i) points += ", {}";
  EXPECT_EQ(refusal(l2 + points + "]").find("/points/"), 0u) << "each alone is allowed";
}

TEST_F(SweepPlanTest, TheExampleOfTheDocsIsRead) {
  const SweepPlan plan = read_sweep_plan((kSource / "docs/examples/sweep.json").string());
  EXPECT_EQ(plan.cells.size(), 2u * 3 * 2 * 4);
  EXPECT_EQ(plan.rows.size(), plan.cells.size() * 2) << "two rates; each hardware has cells of its own";
}

// command_sweep_test.cpp has frames with cameras and with matrices.
TEST_F(SweepPlanTest, CapturedFramesCannotBeResized) {
  Trace captured = read_trace(kSource / "traces/samples/captured_quads.json");
  EXPECT_THROW(resize(captured, {0}, {48, 36}, "captured"), std::runtime_error);
}

}  // namespace beampipe::sweep_plan_test
