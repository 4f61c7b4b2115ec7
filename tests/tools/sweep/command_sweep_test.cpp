// beampipe sweep as a user runs it: its table against single runs, after a kill, and on a Slurm that is a script.
#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/tools/cli/program_fixture.h"
#include "tests/tools/report_frames.h"

namespace beampipe::command_sweep_test {

using Parsed = nlohmann::json;  // independent of the program's own Json

// Rows by column name. No field of these tables has a comma or a quote in it.
std::vector<std::map<std::string, std::string>> read_table(const std::filesystem::path& file) {
  std::istringstream text(read_text(file));
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(text, line);) {
    EXPECT_EQ(line.back(), '\r');
    line.back() = ',';
    lines.emplace_back();
    for (std::size_t at = 0; at < line.size(); at = line.find(',', at) + 1)
      lines.back().push_back(line.substr(at, line.find(',', at) - at));
  }
  std::vector<std::map<std::string, std::string>> rows(lines.size() - 1);
  for (std::size_t i = 1; i < lines.size(); ++i)
    for (std::size_t column = 0; column < lines[0].size(); ++column) rows[i - 1][lines[0][column]] = lines[i][column];
  return rows;
}

class SweepTest : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    succeed({"make", "soup", "--triangles", "300", "--width", "64", "--height", "48", "-o", path("soup.json")});
  }

  // Writes a plan with these axes.
  void plan(const std::string& axes, const std::string& name = "plan.json") const {
    write_text(folder_ / name, R"({"beampipe_sweep": 1, )" + axes + "}");
  }
  std::vector<std::string> sweep(const std::vector<std::string>& options = {}) {
    return joined({"sweep", path("plan.json"), "-o", path("out")}, options);
  }

  std::size_t stored() const {
    std::size_t count = 0;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out/cells", none))
      count += entry.path().extension() == ".json";
    return count;
  }
};

// A plan whose cells take a while: about 0.1 s each.
constexpr const char* kLongPlan = R"("traces": ["soup.json"], "sizes": ["480x360"],
  "techniques": ["msaa:64", "msaa:128", "acaa:64", "msaa:32"], "memory_system.rop_bytes": [4096, 8192, 16384],
  "memory_system.compression": [true, false])";

// The rows of each machine are made by a run of its own, with options and files in place of the plan. The values are
// the same to the last digit, whether the sweep rendered a cell or knew the counts from another one.
TEST_F(SweepTest, TheTableEqualsSingleRuns) {
  plan(R"("traces": ["soup.json"], "techniques": ["beam", "beam:order=sorted", "msaa:8", "acaa:8"],
    "memory_system.l2_bytes": [8192, 1048576, 2097152], "memory_system.compression": [true, false],
    "memory_system.bin_pixels": [16, 32],
    "hardware": ["titan_v", "mali_g710"], "errors": true)");
  const std::string printed = succeed(sweep());
  expect_parts(printed, {" rendered, "});
  EXPECT_EQ(printed.find(" 0 the same as one of these"), std::string::npos) << "nothing was shared: " << printed;

  const Names specs = {"beam", "beam:order=sorted", "msaa:8", "acaa:8"};
  const auto of_technique = [](const Parsed& results, const std::string& spec) -> const Parsed& {
    for (const Parsed& each : results)
      if (each["technique"] == spec) return each;
    throw std::runtime_error("no results of " + spec);
  };
  std::map<std::string, Parsed> runs, comparisons;
  const auto rows = read_table(folder_ / "out/table.csv");
  ASSERT_EQ(rows.size(), 4u * 3 * 2 * 2 * 2 * 2);
  for (auto row : rows) {
    const std::string l2 = row["memory_system.l2_bytes"], bin = row["memory_system.bin_pixels"];
    const bool compressed = row["memory_system.compression"] == "1";
    const std::string key = row["hardware"] + l2 + bin + row["memory_system.compression"];
    SCOPED_TRACE(key + row["technique"]);
    if (!runs.contains(key)) {
      Json hardware = read_hardware(row["hardware"]).json;
      Json &parameters = hardware["memory_system"]["parameters"], &sources = hardware["memory_system"]["sources"];
      for (const auto& [name, value] : {std::pair("l2_bytes", l2), std::pair("bin_pixels", bin)})
        parameters[name] = std::stoi(value), sources[name] = "choice";
      parameters["compression"] = compressed, sources["compression"] = "choice";
      write_text(folder_ / "h.json", hardware.dump());
      const auto results = [&](const std::string& verb, const Names& options) {
        const Names start = {verb, path("soup.json"), "--hardware", path("h.json"), "--force", "-o", path("single")};
        succeed(joined(joined(joined(start, options), {"-t"}), specs));
        return Parsed::parse(read_text(folder_ / "single/report.json"))["results"];
      };
      runs[key] = results("run", {});
      if (!comparisons.contains(bin)) comparisons[bin] = results("compare", {});
    }
    const Parsed& result = of_technique(runs[key], row["technique"]);
    const Parsed& frame = result["frames"][0];
    std::uint64_t operations = 0;
    for (const Parsed& stage : frame["stages"]) operations += stage["ops"]["total"].get<std::uint64_t>();
    EXPECT_EQ(row["operations"], std::to_string(operations));
    for (const char* column : {"logical_bytes", "sector_bytes", "l2_bytes", "dram_bytes"})
      EXPECT_EQ(row[column], frame[column].dump()) << column;
    for (const char* column : {"on_chip_bytes_per_pixel", "off_chip_bytes_per_pixel"})
      EXPECT_EQ(row[column], result[column].dump()) << column;
    std::uint64_t dram = 0;
    for (const auto& [column, value] : row)
      if (column.starts_with("dram_bytes.")) dram += std::stoull(value);
    EXPECT_EQ(row["dram_bytes"], std::to_string(dram));
    const Parsed& geometry = frame["stages"][0];
    ASSERT_TRUE(geometry["stage"] == "vertex_setup" || geometry["stage"] == "prepass_vertex_setup");
    if (geometry["stage"] == "vertex_setup") {
      EXPECT_EQ(row["dram_bytes.geometry"], geometry["dram_bytes"].dump());
    }

    const Parsed& time = frame["modelled_ms"][row["implementation"]];
    EXPECT_EQ(row["at_once_ms"], time["at_once"].dump());
    EXPECT_EQ(row["on_cores_ms"], time["on_cores"].dump());
    EXPECT_EQ(row["in_turn_ms"], time["in_turn"].dump());
    EXPECT_EQ(row["bottleneck"], time["busiest"].get<std::string>());
    EXPECT_EQ(row["bottleneck_rate"], time["busiest_rate"].get<std::string>());
    EXPECT_EQ(row["pixels_per_bin"], frame["bin_pixels"].dump());
    const Parsed& energy = frame["energy_mj"]["total"][row["implementation"]];
    for (const std::string end : {"low", "high"}) EXPECT_EQ(row["energy_mj_" + end], energy[end].dump());
    EXPECT_EQ(row["bins_held"].empty(), !result["pixels_on_chip"].get<bool>());

    const Parsed& compared = of_technique(comparisons[bin], row["technique"]);
    for (const auto& [column, value] : compared["error"].items()) EXPECT_EQ(row[column], value.dump()) << column;
    for (const char* const end : {"", "_low", "_high"}) {
      const std::string name = std::string("equivalent_msaa") + end;
      EXPECT_EQ(row[std::string("emr") + end], compared.contains(name) ? compared[name].dump() : "") << end;
    }
  }
}

// A trace in another size is the trace that says so.
TEST_F(SweepTest, SizesAreThoseOfTheTrace) {
  plan(R"("traces": ["soup.json", "trace.json"],
    "techniques": ["beam"], "sizes": ["96x72", "160x96"], "implementations": ["shaders"], "frames": [0],
    "points": [{"traces": ["soup.json"]}, {"traces": ["trace.json"], "sizes": ["160x96"]}])");
  succeed(sweep());
  const auto rows = read_table(folder_ / "out/table.csv");
  ASSERT_EQ(rows.size(), 3u);
  for (auto row : rows) {
    std::string trace = path("larger.json");
    Parsed larger = Parsed::parse(read_text(folder_ / row["trace"]));
    larger["frames"][0]["width"] = std::stoi(row["width"]);
    larger["frames"][0]["height"] = std::stoi(row["height"]);
    write_text(trace, larger.dump());
    succeed({"run", trace, "-t", "beam", "--frames", "0", "--force", "-o", path("single")});
    const Parsed report = Parsed::parse(read_text(folder_ / "single/report.json"));
    EXPECT_EQ(row["dram_bytes"], report["results"][0]["frames"][0]["dram_bytes"].dump());
  }
}

// On hardware without energy, which leaves its columns empty.
TEST_F(SweepTest, CountsAreMeansOverFrames) {
  write_text(folder_ / "plain.json", titan_without_energy().dump());
  plan(R"("traces": ["trace.json"], "techniques": ["taa:4", "beam"], "implementations": ["shaders"],
    "hardware": ["plain.json"])");
  succeed(sweep());
  succeed({"run", path("trace.json"), "-t", "taa:4", "beam", "--force", "-o", path("single")});
  const Parsed report = Parsed::parse(read_text(folder_ / "single/report.json"));
  const auto rows = read_table(folder_ / "out/table.csv");
  ASSERT_EQ(rows.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Parsed& frames = report["results"][i]["frames"];
    EXPECT_EQ(rows[i].at("frames"), "2");
    EXPECT_EQ(rows[i].at("energy_mj_low") + rows[i].at("energy_mj_high"), "");
    const double mean = (frames[0]["dram_bytes"].get<double>() + frames[1]["dram_bytes"].get<double>()) / 2;
    EXPECT_EQ(std::stod(rows[i].at("dram_bytes")), mean);
    const double ms = frames[0]["modelled_ms"]["shaders"]["at_once"].get<double>() +
                      frames[1]["modelled_ms"]["shaders"]["at_once"].get<double>();
    EXPECT_EQ(std::stod(rows[i].at("at_once_ms")), ms / 2);
  }
}

TEST_F(SweepTest, AKilledSweepGoesOn) {
  plan(kLongPlan);
  succeed({"sweep", path("plan.json"), "-o", path("whole"), "--jobs", "1"});
  {
    Program program(sweep({"--jobs", "1"}));
    for (int i = 0; i < 3000 && stored() < 3; ++i) pause(10);
    program.signal(SIGKILL);
    EXPECT_EQ(program.wait().exit_code, -1);
  }
  const std::size_t kept = stored();
  EXPECT_GE(kept, 3u);
  ASSERT_LT(kept, 24u) << "it was finished before it could be killed";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/table.csv"));

  const Outcome merged = run_program(sweep({"--merge"}));
  EXPECT_EQ(merged.exit_code, 1);
  expect_parts(merged.err, {std::to_string(2 * (24 - kept)) + " of 48 rows are missing"});
  EXPECT_EQ(read_table(folder_ / "out/table.csv").size(), 2 * kept);

  // A result whose end is missing is none, and neither is one of which a single digit has changed.
  // Files are listed before any is replaced, since a new one may be listed, too; what the kill left unfinished is no
  // result.
  std::vector<std::filesystem::path> files;
  for (const auto& file : std::filesystem::directory_iterator(folder_ / "out/cells"))
    if (file.path().extension() == ".json") files.push_back(file.path());
  write_text(files[0], "{\"key\": ");
  std::string changed = read_text(files[1]);
  char& digit = changed.at(changed.find("\"dram_bytes\":") + std::string("\"dram_bytes\":").size());
  digit = digit == '7' ? '8' : '7';
  write_text(files[1], changed);
  const std::string printed = succeed(sweep({"--jobs", "2"}));
  expect_parts(printed, {std::to_string(kept - 2) + " kept from earlier"});
  EXPECT_EQ(read_text(folder_ / "out/table.csv"), read_text(folder_ / "whole/table.csv"));
  EXPECT_EQ(read_text(folder_ / "out/table.sqlite"), read_text(folder_ / "whole/table.sqlite"));
  EXPECT_EQ(stored(), 24u);
}

TEST_F(SweepTest, CtrlCSaysWhatIsKept) {
  plan(kLongPlan);
  Program program(sweep({"--jobs", "1"}));
  for (int i = 0; i < 3000 && stored() < 2; ++i) pause(10);
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  expect_parts(outcome.err, {" of 24 results are kept, and the same command goes on from there\n"});
  EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1);
  for (const std::string& name : folder_.list()) EXPECT_FALSE(name.ends_with(".tmp")) << name;
}

// Another trace, or another technique, leaves what is known of the others.
TEST_F(SweepTest, OnlyWhatChangesIsRenderedAgain) {
  const std::string axes = R"("traces": ["soup.json"], "techniques": ["beam", "msaa:8"])";
  plan(axes);
  EXPECT_EQ(succeed(sweep()).find("results: 2 rendered, 0 the same as one of these, 0 kept from earlier"), 0u);
  plan(axes + R"(, "hardware.clock_mhz": [850], "hardware.l2_bytes_per_clk": [5])");
  EXPECT_EQ(succeed(sweep()).find("results: 0 rendered, 0 the same as one of these, 2 kept from earlier"), 0u);
  plan(R"("traces": ["soup.json"], "techniques": ["beam", "msaa:4"])");
  EXPECT_EQ(succeed(sweep()).find("results: 1 rendered, 0 the same as one of these, 1 kept from earlier"), 0u);
  succeed({"make", "soup", "--triangles", "301", "--width", "64", "--height", "48", "-o", path("soup.json")});
  EXPECT_EQ(succeed(sweep()).find("results: 2 rendered"), 0u);
}

TEST_F(SweepTest, PartsTogetherAreTheWhole) {
  plan(R"("traces": ["soup.json", "trace.json"], "techniques": ["beam", "msaa:8", "acaa:8"], "errors": true)");
  succeed({"sweep", path("plan.json"), "-o", path("whole")});
  for (const char* part : {"2/3", "0/3", "1/3"}) succeed(sweep({"--part", part}));
  EXPECT_EQ(succeed(sweep({"--merge"})).find("table: "), 0u);
  EXPECT_EQ(read_text(folder_ / "out/table.csv"), read_text(folder_ / "whole/table.csv"));
}

// The second sweep has another folder, and so nothing of its own yet.
TEST_F(SweepTest, PicturesOfTheReferenceAreKeptForOtherSweeps) {
  plan(R"("traces": ["soup.json"], "techniques": ["beam"], "errors": true)");
  const auto pictures = [&] {
    std::map<std::string, std::filesystem::file_time_type> found;
    for (const auto& file : std::filesystem::directory_iterator(folder_ / "kept"))
      if (file.path().extension() == ".json") found[file.path().filename()] = file.last_write_time();
    return found;
  };
  succeed({"sweep", path("plan.json"), "-o", path("first"), "--reference-cache", path("kept")});
  const auto kept = pictures();
  EXPECT_EQ(kept.size(), 1u);
  succeed({"sweep", path("plan.json"), "-o", path("second"), "--reference-cache", path("kept")});
  EXPECT_EQ(pictures(), kept);
  EXPECT_EQ(read_text(folder_ / "first/table.csv"), read_text(folder_ / "second/table.csv"));
}

TEST_F(SweepTest, MistakesAreOneLineAndLeaveNothing) {
  plan(R"("traces": ["soup.json", "missing.json"], "techniques": ["beam"])");
  plan(R"("traces": ["trace.json"], "techniques": ["beam"], "sizes": ["5x5"])", "sized.json");
  plan(R"("traces": ["trace.json"], "techniques": ["beam"], "frames": [2])", "frames.json");
  plan(R"("traces": ["trace.json"], "techniques": ["beam", "msaa:4"], "memory_system.binned": [true, false])",
       "bins.json");
  plan(R"("traces": ["trace.json"], "techniques": ["beam", "beam:bits=60"])", "specs.json");
  const Names before = folder_.list();
  expect_error(sweep(), 1, "missing.json");
  expect_error({"sweep", path("specs.json"), "-o", path("out")}, 2,
               "specs.json: /techniques/1: technique 'beam:bits=60'");
  expect_error({"sweep", path("sized.json"), "-o", path("out")}, 1, "cannot be 5 x 5 pixels");
  expect_error({"sweep", path("frames.json"), "-o", path("out")}, 1, "0 to 1, found 2");
  expect_error({"sweep", path("bins.json"), "-o", path("out")}, 1,
               "expected techniques that work without bins, because a memory system has none, found beam");
  expect_error(sweep({"--part", "3/3"}), 2, "expected I/N");
  expect_error(sweep({"--merge", "--slurm"}), 2, "exclude each other");
  expect_error(sweep({"--plot", "x,y,z"}), 1, "the table has no column 'x'");
  expect_error(sweep({"--slurm", "--sbatch", "array=1"}), 2, "is set by the sweep");
  expect_error(sweep({"--slurm", "--sbatch", "--time=1"}), 2, "--time");
  EXPECT_EQ(folder_.list(), before);
}

// An sbatch that notes what it is given, and runs the job at once. The second task of the first array is killed.
constexpr const char* kSbatch = R"sh(#!/bin/sh
cd "$(dirname "$0")"
echo "$@" >> submitted
number=$(wc -l < submitted)
case "$2" in
  --array=*)
    for range in $(echo "${2#--array=}" | tr , ' '); do
      for task in $(seq "${range%-*}" "${range#*-}"); do
        [ "$number/$task" = 1/1 ] && continue
        SLURM_ARRAY_TASK_ID=$task SLURM_CPUS_PER_TASK=2 sh "$3" >> log 2>&1
      done
    done ;;
  *) sh "$3" >> log 2>&1 ;;
esac
echo $number
)sh";

TEST_F(SweepTest, SlurmGetsAnArrayAndAMerge) {
  plan(R"("traces": ["soup.json"],
    "techniques": ["beam", "msaa:8", "acaa:8"], "memory_system.l2_bytes": [8192, 1048576])");
  std::filesystem::create_directory(folder_ / "bin");
  write_text(folder_ / "bin/sbatch", kSbatch);
  std::filesystem::permissions(folder_ / "bin/sbatch", std::filesystem::perms::owner_all);
  const std::string search = std::getenv("PATH");
  ASSERT_EQ(setenv("PATH", (path("bin") + ":" + search).c_str(), 1), 0);
  const std::string plot = "memory_system.l2_bytes,dram_bytes,technique";
  const auto submit = [&] {
    return succeed(sweep({"--slurm", "--sbatch", "time=0:10:00", "exclusive", "--plot", plot}));
  };

  const std::string dry = succeed(sweep({"--slurm", "--dry-run"}));
  expect_parts(dry, {"\nsbatch --array=0-2 '" + path("out/slurm/array.sh") + "'\nsbatch --dependency=afterany:JOB '" +
                     path("out/slurm/merge.sh") + "'\n"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "bin/submitted"));
  EXPECT_EQ(submit().find("submitted: job 1, 3 of 3 tasks, and job 2, which then makes the table\n"), 0u);
  EXPECT_EQ(read_text(folder_ / "bin/submitted"), "--parsable --array=0-2 " + path("out/slurm/array.sh") +
                                                      "\n--parsable --dependency=afterany:1 " +
                                                      path("out/slurm/merge.sh") + "\n");
  const std::string script = read_text(folder_ / "out/slurm/array.sh");
  EXPECT_EQ(script.find("#!/bin/sh\n#SBATCH --job-name=beampipe\n#SBATCH --output=" + path("out/slurm") +
                        "/%A_%a.txt\n#SBATCH --time=0:10:00\n#SBATCH --exclusive\nexec '"),
            0u)
      << script;
  expect_parts(script, {"'sweep' '" + path("plan.json") + "' '-o' '" + path("out") +
                        "' --part \"$SLURM_ARRAY_TASK_ID/3\" --jobs \"${SLURM_CPUS_PER_TASK:-1}\" --threads 1\n"});
  EXPECT_NE(read_text(folder_ / "bin/log").find("4 of 12 rows are missing"), std::string::npos) << "a task was killed";
  EXPECT_EQ(read_table(folder_ / "out/table.csv").size(), 8u) << "what is there is merged";

  EXPECT_EQ(submit().find("submitted: job 3, 1 of 3 tasks, and job 4"), 0u);
  expect_parts(read_text(folder_ / "bin/submitted"), {"\n--parsable --array=1 "});
  EXPECT_EQ(read_table(folder_ / "out/table.csv").size(), 12u);
  EXPECT_TRUE(std::filesystem::exists(folder_ / ("out/dram_bytes_against_memory_system.l2_bytes_by_technique.svg")));

  EXPECT_EQ(submit().find("table: "), 0u) << "nothing is missing, so nothing is submitted";
  write_text(folder_ / "bin/sbatch", "#!/bin/sh\necho 'sbatch: error: no partition' >&2\nexit 1\n");
  plan(R"("traces": ["soup.json"], "techniques": ["msaa:4"])");
  expect_error(sweep({"--slurm"}), 1, "sbatch refused the job: sbatch: error: no partition");
  setenv("PATH", search.c_str(), 1);
}

}  // namespace beampipe::command_sweep_test
