#include "tools/evaluate/energy.h"

#include "tests/message_of.h"
#include "tests/tools/fixtures.h"
#include "tests/tools/report_frames.h"
#include "tools/evaluate/frame_json.h"
#include "tools/report/energy_text.h"
#include "tools/report/tables.h"

namespace beampipe::energy_test {

constexpr std::uint64_t kBillion = 1000000000;  // picojoules in a millijoule

// A different power of ten for each kind of operation, and twice as much at most. So each digit of a sum is a count.
Hardware decimal_hardware() {
  Hardware hardware = titan_v();
  const std::pair<const char*, double> least[] = {{"mul_add", 1},        {"add", 10},        {"bit", 100},
                                                  {"fetch", 1e3},        {"special", 1e4},   {"convert", 1e5},
                                                  {"wide", 1e6},         {"instruction", 3}, {"on_chip_byte", 10},
                                                  {"texture_byte", 100}, {"l2_byte", 1000},  {"dram_byte", 7}};
  hardware.picojoules.clear();
  for (const auto& [name, picojoules] : least) hardware.picojoules[name] = {picojoules, 2 * picojoules};
  return hardware;
}

StageCounters counted(StageId id) {
  StageCounters stage{id};
  stage.ops = {1 * kBillion, 2 * kBillion, 3 * kBillion, 4 * kBillion, 5 * kBillion, 6 * kBillion, 7 * kBillion};
  stage.bytes_read = 5 * kBillion, stage.bytes_written = 4 * kBillion, stage.texture_bytes = 2 * kBillion;
  stage.l2_bytes = 8 * kBillion, stage.dram_bytes = 9 * kBillion, stage.sector_bytes = 1;
  return stage;
}

void expect_interval(const Interval& interval, double low, double high) {
  EXPECT_NEAR(interval.low, low, 1e-6 * low);
  EXPECT_NEAR(interval.high, high, 1e-6 * high);
}

void expect_number(const Json& found, double number) { EXPECT_NEAR(found.get<double>(), number, 1e-9 * number); }

Energy energy_of(const StageCounters& stage, std::size_t implementation) {
  const Hardware hardware = decimal_hardware();
  const auto all = modelled_energy(hardware, hardware.implementations.at(implementation), {stage});
  EXPECT_EQ(all.size(), 1u);
  EXPECT_EQ(all.at(0).stage, stage.stage);
  return all.at(0).energy;
}

// Operations: the digits of 7654321. Instructions: 21 billion operations, of which 7 are issued twice. On chip: 9
// billion bytes, of which 2 are texels.
TEST(Energy, EachCountHasItsPrice) {
  const Energy energy = energy_of(counted(StageId::compose), 0);
  expect_interval(energy.operations, 7654321, 15308642);
  expect_interval(energy.instructions, 28 * 3, 28 * 6);
  expect_interval(energy.on_chip, 7 * 10 + 2 * 100, 14 * 10 + 4 * 100);
  expect_interval(energy.l2, 8000, 16000);
  expect_interval(energy.dram, 63, 126);
  expect_interval(energy.total(), 7654321 + 84 + 270 + 8000 + 63, 2 * (7654321 + 84 + 270 + 8000 + 63));
}

// The same work without instructions. `shade` has them in both implementations, through its unit "shading".
TEST(Energy, FixedFunctionsHaveNoInstructions) {
  const Energy composer = energy_of(counted(StageId::compose), 1);
  expect_interval(composer.instructions, 0, 0);
  expect_interval(composer.operations, 7654321, 15308642);
  expect_interval(composer.on_chip, 270, 540);
  expect_interval(energy_of(counted(StageId::shade), 1).instructions, 84, 168);
  expect_interval(energy_of(counted(StageId::conservative_raster), 0).instructions, 0, 0);
}

// Multiplications of 1 to 2 pJ and bytes of DRAM of 10 to 30 pJ: (10 m + 10 d) / (5 m + 20 d) is greatest for m = 2 and
// d = 10, 120 / 210, and least for m = 1 and d = 30, 310 / 605. With additions, which only the first has, both their
// ends count: a from 0 to 100, 220 / 210. What has none over what has some is 0.
TEST(Energy, QuotientsHaveTheSameEnergiesAboveAndBelow) {
  Hardware hardware = titan_v();
  for (auto& [name, range] : hardware.picojoules) range = {0, 1e6};
  hardware.picojoules["mul_add"] = {1, 2}, hardware.picojoules["dram_byte"] = {10, 30};
  hardware.picojoules["add"] = {0, 100};
  const auto work = [&](std::uint64_t mul_add, std::uint64_t add, std::uint64_t dram_bytes) {
    StageCounters stage{StageId::compose};
    stage.ops.mul_add = mul_add, stage.ops.add = add, stage.dram_bytes = dram_bytes;
    return priced_work(hardware, hardware.implementations.at(1), {stage});
  };
  expect_interval(quotient_of(hardware, work(10, 0, 10), work(5, 0, 20)), 310.0 / 605, 120.0 / 210);
  expect_interval(quotient_of(hardware, work(10, 1, 10), work(5, 0, 20)), 310.0 / 605, 220.0 / 210);
  expect_interval(quotient_of(hardware, work(3, 0, 6), work(1, 0, 2)), 3, 3);
  expect_interval(quotient_of(hardware, work(0, 0, 0), work(1, 0, 2)), 0, 0);
}

// A billion invocations with 50 multiplications, 50 additions and 5 probes of 16 bytes.
TEST(Energy, ShadingCostsTakeEnergy) {
  StageCounters shade{StageId::shade};
  shade.lanes_issued = kBillion;
  const Hardware hardware = with_shading_costs(decimal_hardware(), {100, 5, 0}, {});
  const Energy energy = sum_of(modelled_energy(hardware, hardware.implementations.at(1), {shade}));
  expect_interval(energy.operations, 50 + 500, 100 + 1000);
  expect_interval(energy.instructions, 300, 600);
  expect_interval(energy.on_chip, 80 * 100, 80 * 200);
}

// All lanes multiply, all bytes of on-chip memory, L2 and DRAM move: the most that switching takes is less than what
// the board may draw (250 W and 450 W, NVIDIA's product pages), and more than an eighth of it.
TEST(Energy, BusyPartsStayBelowThePowerOfTheirBoards) {
  for (const auto& [name, board] : {std::pair{"titan_v", 250.0}, {"rtx_4090", 450.0}}) {
    const Hardware hardware = read_hardware(name);
    const auto watts = [&](const char* rate, const char* picojoules) {
      return hardware.rates.at(rate) * hardware.clock_mhz * 1e6 * hardware.picojoules.at(picojoules).high * 1e-12;
    };
    const double all =
        hardware.memory.cores * (watts("core_issue_per_clk", "instruction") + watts("core_mul_add_per_clk", "mul_add") +
                                 watts("core_on_chip_bytes_per_clk", "on_chip_byte")) +
        watts("l2_bytes_per_clk", "l2_byte") + watts("dram_bytes_per_clk", "dram_byte");
    EXPECT_LT(all, board) << name;
    EXPECT_GT(all, board / 8) << name;
  }
}

TEST(Energy, BuiltInDescriptionsAndTheExampleHaveIt) {
  std::vector<std::string> names = hardware_names();
  names.push_back(BEAMPIPE_SOURCE_FOLDER "/docs/examples/hardware.json");
  for (const std::string& name : names) {
    const Hardware hardware = read_hardware(name);
    EXPECT_TRUE(has_energy(hardware)) << name;
    for (const auto& [key, range] : hardware.picojoules) EXPECT_LT(0, range.low) << name << ", " << key;
    EXPECT_EQ(hardware.picojoules.size(), 12u) << name;
  }
}

TEST(Energy, DescriptionsMayLackIt) {
  const Hardware hardware = parse_hardware(titan_without_energy(), "h.json");
  EXPECT_FALSE(has_energy(hardware));
  FrameReport frame;
  frame.stages = {counted(StageId::compose)};
  const Json json = to_json(frame, {}, hardware);
  EXPECT_TRUE(json.contains("modelled_ms"));
  EXPECT_FALSE(json.contains("energy_mj"));
  EXPECT_FALSE(json.at("stages").elements().at(0).contains("energy_mj"));
}

TEST(Energy, ErrorsNameTheKey) {
  const std::string range = R"("mul_add":[1,2])", source = R"("mul_add":"source")";
  const auto refusal = [&](const std::string& ranges, const std::string& sources) {
    Json json = titan_v().json;
    std::string other_ranges, other_sources;
    for (const form::Key& each : hardware_energies())
      if (each.key != "mul_add") {
        other_ranges += ",\"" + each.key + "\":[1,1]";
        other_sources += ",\"" + each.key + "\":\"source\"";
      }
    json["energy"] = parse_json_text(
        R"({"picojoules":{)" + (ranges.empty() ? other_ranges.substr(1) : ranges + other_ranges) + R"(},"sources":{)" +
            (sources.empty() ? other_sources.substr(1) : sources + other_sources) + "}}",
        "h.json");
    return message_of<std::runtime_error>([&] { parse_hardware(json, "h.json"); });
  };
  EXPECT_EQ(refusal(range, source), "no error");
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {range, "", "/energy/sources: expected the key \"mul_add\", found none"},
      {"", source, "/energy/picojoules: expected the key \"mul_add\", found none"},
      {range, R"("mul_add":"")", "/energy/sources/mul_add: expected where the number is from, or that it is a choice"},
      {R"("mul_add":[2,1])", source, "/energy/picojoules/mul_add: expected the lowest before the highest"},
      {R"("mul_add":[1])", source, "/energy/picojoules/mul_add: expected two numbers, the lowest and the highest"},
      {R"("mul_add":[-1,1])", source,
       "/energy/picojoules/mul_add/0: expected a number from 1e-06 to 1000000, found -1"},
      {range + R"(,"mul":[1,2])", source, "/energy/picojoules/mul: expected one of"}};
  for (const auto& [ranges, sources, start] : cases) {
    const std::string error = refusal(ranges, sources);
    EXPECT_TRUE(error.starts_with("h.json: " + start)) << error;
    EXPECT_EQ(error.find('\n'), error.npos) << error;
  }
}

Report two_frames() {
  Report report;
  report.trace = "here/fence.json";
  report.memory = decimal_hardware().memory;
  report.memory.modelled = true;
  report.hardware = decimal_hardware();
  TechniqueReport& result = report.results.emplace_back();
  result.technique = "beam";
  result.pixels_on_chip = true;
  for (std::size_t index = 0; index < 2; ++index) {
    FrameReport frame;
    frame.index = index;
    frame.pixels = frame.bin_pixels = 1024;
    frame.buffers = {{kOpenPixels, 46 * 1024, true}};
    frame.stages = {counted(StageId::compose)};
    if (index == 1) frame.stages.push_back(counted(StageId::depth_test));
    result.frames.push_back(frame);
  }
  return report;
}

TEST(Energy, ReportsHaveItByFrameAndStage) {
  const Json report = report_json(two_frames());
  const std::vector<Json>& frames = report.at("results").elements().at(0).at("frames").elements();
  const Json& second = frames.at(1).at("energy_mj");
  expect_number(frames.at(0).at("energy_mj").at("dram").at("low"), 63);
  expect_number(second.at("dram").at("low"), 126);
  expect_number(second.at("dram").at("high"), 252);
  expect_number(second.at("instructions").at("shaders").at("low"), 84);
  expect_number(second.at("instructions").at("fixed_function").at("high"), 0);
  EXPECT_NEAR(second.at("total").at("shaders").at("low").get<double>(), 2 * (7654321 + 270 + 8000 + 63) + 84, 1);
  const Json& stage = frames.at(1).at("stages").elements().at(0).at("energy_mj");
  expect_number(stage.at("l2").at("high"), 16000);
  expect_number(stage.at("instructions").at("shaders").at("high"), 168);
}

// Means over both frames: of DRAM (63 + 126) / 2; `compose` has 63 in both, and `depth_test` half of that.
TEST(Energy, TablesHaveMeansOverFrames) {
  TemporaryFolder folder;
  write_text(folder / "report.json", report_text(two_frames()));
  const std::vector<Table> tables = report_tables(read_report(folder.string()));
  const auto cell = [&](const std::string& table, std::size_t row, const std::string& key) {
    for (const Table& each : tables)
      for (std::size_t i = 0; each.name == table && i < each.columns.size(); ++i)
        if (each.columns[i].key == key) return each.rows.at(row).at(i).get<double>();
    throw std::runtime_error("no column " + key);
  };
  EXPECT_NEAR(cell("techniques", 0, "energy_mj_dram_low"), 94.5, 1e-9);
  EXPECT_NEAR(cell("techniques", 0, "energy_mj_instructions_shaders_high"), 168, 1e-9);
  EXPECT_NEAR(cell("stages", 0, "energy_mj_dram_low"), 63, 1e-9);
  EXPECT_NEAR(cell("stages", 1, "energy_mj_dram_high"), 63, 1e-9);
  EXPECT_NEAR(cell("frames", 1, "energy_mj_l2_high"), 32000, 1e-9);
  EXPECT_NEAR(cell("stages", 0, "energy_mj_total_fixed_function_low"), 7654321 + 270 + 8000 + 63, 1);
}

// A core has room for two bins of 46 KiB. There are 80 cores.
TEST(Energy, TextAndJsonHaveProxiesOfArea) {
  const Report report = two_frames();
  const Json json = energy_json(report);
  const std::vector<Json>& rows = json.elements();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("implementation"), "shaders");
  expect_number(rows[0].at("energy_mj").at("dram").elements().at(0), 94.5);
  expect_number(rows[0].at("stages").at("depth_test").at("dram").elements().at(1), 63);
  expect_number(rows[0].at("on_chip_bytes"), 46 * 1024 * 2 * 80);
  EXPECT_EQ(rows[0].at("compared_per_clk").size(), 0u) << "`depth_test` is not in the first frame";
  expect_number(rows[1].at("compared_per_clk").at("composer"), 768);
  const std::string text = energy_text(report);
  expect_parts(text, {"12000 to 24000", "7360  composer 768", "modelled mJ on titan_v (Titan V class)"});
}

}  // namespace beampipe::energy_test
