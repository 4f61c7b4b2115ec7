// What the tests of the built program share: a trace of two triangles in a folder of its own.
#pragma once

#include "tests/tools/program.h"

namespace beampipe {

// Two frames of 20 x 12 and 8 x 16. The red triangle covers the upper left half, the green one a slanted sliver.
inline constexpr const char* kTrace = R"({"beampipe_trace": 1,
  "meshes": {"red":   {"positions": [-1,-1,0, 1,1,0, -1,1,0], "indices": [0,1,2], "colors": [1,0.25,0]},
             "green": {"positions": [-0.9,-0.7,-0.5, 0.9,-0.6,-0.5, 0.8,0.3,-0.5], "indices": [0,1,2], "colors": [0,1,0.5]}},
  "frames": [{"width": 20, "height": 12, "background": [0,0,0.5], "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
              "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "red"}, {"mesh": "green"}]},
             {"width": 8, "height": 16, "background": [1,1,1], "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
              "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "green"}]}]})";

// One triangle over half of a frame of several tiles.
inline constexpr const char* kHalfFrame = R"({"beampipe_trace": 1,
  "meshes": {"red": {"positions": [-1,-1,0, 1,1,0, -1,1,0], "indices": [0,1,2], "colors": [1,0.25,0]}},
  "frames": [{"width": 70, "height": 40, "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
              "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "draws": [{"mesh": "red"}]}]})";

class ProgramTest : public RunInFolder {
 protected:
  void SetUp() override { write_text(folder_ / "trace.json", kTrace); }
};

}  // namespace beampipe
