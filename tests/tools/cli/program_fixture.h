// What the tests of the built program share: a trace of two triangles in a folder of its own.
#pragma once

#include <string>
#include <vector>

#include "tests/tools/program.h"

namespace beampipe {

using Names = std::vector<std::string>;

// Two frames of 20 x 12 and 8 x 16. The red triangle covers the upper left half, the green one a slanted sliver.
inline constexpr const char* kTrace = R"({"beampipe_trace": 1,
  "meshes": {"red":   {"positions": [-1,-1,0, 1,1,0, -1,1,0], "indices": [0,1,2], "colors": [1,0.25,0]},
             "green": {"positions": [-0.9,-0.7,-0.5, 0.9,-0.6,-0.5, 0.8,0.3,-0.5], "indices": [0,1,2], "colors": [0,1,0.5]}},
  "frames": [{"width": 20, "height": 12, "background": [0,0,0.5], "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
              "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "red"}, {"mesh": "green"}]},
             {"width": 8, "height": 16, "background": [1,1,1], "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
              "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "green"}]}]})";

class ProgramTest : public testing::Test {
 protected:
  void SetUp() override { write_text(folder_ / "trace.json", kTrace); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  // Runs the program and expects success, with nothing on standard error. Returns its output.
  std::string succeed(const std::vector<std::string>& arguments) {
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  }

  TemporaryFolder folder_;
};

// Expects a failed run with a single line on standard error, which contains `part`, and no output.
inline void expect_one_error_line(const Outcome& outcome, int exit_code, const std::string& part) {
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.rfind("beampipe: error: ", 0), 0u) << outcome.err;
  EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
  EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err << "does not say: " << part;
}

}  // namespace beampipe
