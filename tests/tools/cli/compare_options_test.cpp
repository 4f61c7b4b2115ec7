// What `compare` keeps for later, and what it measures, with the built program.

#include <nlohmann/json.hpp>

#include "tests/tools/cli/program_fixture.h"

namespace beampipe::compare_options_test {

using Parsed = nlohmann::json;

class CompareOptionsTest : public ProgramTest {
 protected:
  void make(const std::string& seed) {
    const Outcome made = run_program({"make", "soup", "--triangles", "1000", "--seed", seed, "--width", "24",
                                      "--height", "16", "--frames", "4", "--pan", "0.7,0.3", "-o", path("soup.json")});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }

  // The report of comparing the soup, which goes to a folder of its own.
  Parsed compare(const Names& options, const std::string& folder = "out") {
    const Outcome done = run_program(
        joined({"compare", path("soup.json"), "-o", path(folder), "--force", "--no-memory-model"}, options));
    EXPECT_EQ(done.exit_code, 0) << done.err;
    out_ = done.out;
    return Parsed::parse(read_text(folder_ / folder / "report.json"));
  }

  static std::vector<Parsed> errors(const Parsed& report) {
    std::vector<Parsed> found;
    for (const Parsed& result : report["results"]) {
      found.push_back({result["error"], result.value("equivalent_msaa", Parsed())});
      for (const Parsed& frame : result["frames"]) found.push_back(frame["stages"]);
    }
    return found;
  }

  std::size_t kept_pictures() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "kept"))
      count += entry.path().extension() == ".exr";
    return count;
  }

  std::string out_;
};

TEST_F(CompareOptionsTest, KeepsTheReferenceForItsSceneAlone) {
  make("1");
  const Names options = {"-t", "beam", "--ladder", "1,8", "--frames", "0", "--reference-cache"};
  const auto with_cache = [&] { return compare(joined(options, {path("kept")})); };
  const Parsed first = with_cache();
  EXPECT_EQ(kept_pictures(), 1u);
  const Parsed second = with_cache();
  EXPECT_EQ(errors(second), errors(first));
  Parsed time = first["results"][1]["frames"][0]["wall_ms"];
  EXPECT_FALSE(time.contains("kept"));
  time["kept"] = true;
  EXPECT_EQ(second["results"][1]["frames"][0]["wall_ms"], time) << "the reference was not rendered again";
  make("2");
  const Parsed changed = with_cache();
  EXPECT_EQ(kept_pictures(), 2u);
  EXPECT_EQ(errors(changed), errors(compare(joined(options, {"none"}))));
  EXPECT_NE(errors(changed), errors(first));
}

TEST_F(CompareOptionsTest, MeasuresTheReferenceItself) {
  make("1");
  const Names options = {"-t", "beam", "msaa:64", "--ladder", "1,2,4,8,16", "--frames", "0"};
  const Parsed plain = compare(options), report = compare(joined(options, {"--reference-error"}));
  EXPECT_FALSE(plain.contains("reference_error"));
  ASSERT_EQ(report["results"].size(), 4u);
  EXPECT_EQ(report["results"][2]["technique"], "reference:set=2");
  const double of_reference = report["reference_error"].get<double>();
  EXPECT_DOUBLE_EQ(of_reference, report["results"][2]["error"]["rmse"].get<double>() / std::sqrt(2.0));
  EXPECT_GT(of_reference, 0);
  expect_parts(out_, {"RMSE of the reference itself: "});
  // The ladder does not grow for the second reference, and the range of a technique is no narrower.
  EXPECT_EQ(report["msaa_ladder"], plain["msaa_ladder"]);
  const Parsed &with = report["results"][0], &without = plain["results"][0];
  EXPECT_EQ(with["equivalent_msaa"], without["equivalent_msaa"]);
  if (without.contains("equivalent_msaa_low")) {
    EXPECT_LE(with["equivalent_msaa_low"], without["equivalent_msaa_low"]);
  }
}

// The picture of a frame depends on those before it, of which none is in the report.
TEST_F(CompareOptionsTest, MeasuresFromAFrameOn) {
  make("1");
  const Parsed all = compare({"-t", "taa:4", "msaa:2", "--ladder", "1,8"});
  const Parsed rest = compare({"-t", "taa:4", "msaa:2", "--ladder", "1,8", "--measure-from", "2"}, "rest");
  for (const std::size_t technique : {0, 1}) {
    const Parsed& frames = rest["results"][technique]["frames"];
    ASSERT_EQ(frames.size(), 2u);
    for (const std::size_t frame : {0, 1})
      EXPECT_EQ(frames[frame]["error"], all["results"][technique]["frames"][frame + 2]["error"]);
  }
  EXPECT_EQ(rest["made_by"]["unmeasured_frames"], "0-1");
  const Outcome late =
      run_program({"compare", path("soup.json"), "-t", "taa:4", "-o", path("late"), "--measure-from", "4"});
  EXPECT_EQ(late.exit_code, 2);
  expect_parts(late.err, {"--measure-from 4: expected fewer than the 4 frames"});
}

}  // namespace beampipe::compare_options_test
