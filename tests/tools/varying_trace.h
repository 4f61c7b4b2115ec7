// Traces whose surfaces vary, for tests of how errors are split.
#pragma once

#include "tests/tools/fixtures.h"
#include "traces/files/image_file.h"

namespace beampipe {

// Writes trace.json with a frame for each list of draws, and the checker that its texture shows. A frame is 32 x 18
// pixels; the first one has another size if `first_width` is not 32. These meshes can be drawn:
//   wall    textured, covers the whole picture
//   left    textured, covers the left half, up to the edge between two columns of pixels
//   sliver  a nearer, slanted triangle in the right half, of one colour at all vertices
//   flat    a nearer triangle across the picture, unlit and of one colour
//   sheets  two nearer triangles across the picture, one behind the other, both translucent
inline void write_varying_trace(const TemporaryFolder& folder, const std::vector<std::string>& draws,
                                int first_width = 32) {
  write_text(folder / "checker.png", encode_png(2, 2, {255, 255, 255, 40, 0, 80, 40, 0, 80, 255, 255, 255}));
  std::string text = R"({"beampipe_trace": 2,
    "images": {"checker": {"file": "checker.png"}},
    "materials": {"textured": {"base_texture": {"image": "checker"}, "unlit": true, "double_sided": true},
                  "plain": {"unlit": true, "double_sided": true, "base_color": [1, 0, 1, 1]},
                  "glass": {"unlit": true, "double_sided": true, "base_color": [1, 0.2, 0.1, 0.3], "alpha_mode": "blend"}},
    "meshes": {
      "wall": {"positions": [-1,-1,-0.2, 5,-1,-0.2, -1,5,-0.2], "indices": [0,1,2], "uv0": [0,0, 17,3, -5,29],
               "materials": ["textured"]},
      "left": {"positions": [0,-5,-0.2, 0,5,-0.2, -9,0,-0.2], "indices": [0,1,2], "uv0": [0,0, 17,3, -5,29],
               "materials": ["textured"]},
      "sliver": {"positions": [0.2,-0.7,-0.5, 0.9,-0.6,-0.5, 0.8,0.3,-0.5], "indices": [0,1,2],
                 "vertex_colors": [1,1,1,1, 1,1,1,1, 1,1,1,1], "materials": ["plain"]},
      "flat": {"positions": [-0.7,-0.8,-0.5, 0.8,-0.3,-0.5, 0.1,0.9,-0.5], "indices": [0,1,2], "materials": ["plain"]},
      "sheets": {"positions": [-0.8,-0.7,-0.5, 0.7,-0.4,-0.5, 0.2,0.8,-0.5, -0.6,0.8,-0.4, 0.9,0.3,-0.4, -0.1,-0.9,-0.4],
                 "indices": [0,1,2, 3,4,5], "materials": ["glass"]}},
    "frames": [)";
  int width = first_width;
  for (const std::string& drawn : draws) {
    if (text.back() == '}') text += ",";
    text += R"({"width": )" + std::to_string(width) + R"(, "height": 18, "background": [0, 0, 0.5],
      "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
      "draws": [)" +
            drawn + "]}";
    width = 32;
  }
  write_text(folder / "trace.json", text + "]}");
}

}  // namespace beampipe
