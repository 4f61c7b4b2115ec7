// A report whose numbers can be computed by hand.
#pragma once

#include "tests/tools/fixtures.h"
#include "tools/report/report_file.h"

namespace beampipe {

// A report with two frames of one technique, which has one stage, and of the reference.
inline constexpr const char* kMadeReport = R"({"beampipe_report": 2, "trace": "dots.json", "threads": 1, "simd": "AVX2",
  "memory_system": {"modelled": false, "cores": 2},
  "hardware": {"name": "Some GPU", "clock_mhz": 1000, "rates": {"core_issue_per_clk": 50, "dram_bytes_per_clk": 10},
               "memory_system": {"parameters": {}}, "implementations": {"shaders": {}}},
  "claims": [{"name": "beam, \"RGB16F\"", "unit": "bytes", "published_low": 36, "published_high": 42, "ours": 42,
              "per_cent": 0, "holds": true, "source": "slide 30", "command": "beampipe report DIR"}],
  "msaa_ladder": [{"samples": 1, "rmse": 0.1}, {"samples": 8, "rmse": 0.03}],
  "results": [
   {"technique": "beam", "framebuffer_bytes_per_pixel": 42, "peak_bytes_per_pixel": 49, "a_buffer_peak_bytes": 7,
    "framebuffer": [{"name": "mask", "format": "R32UI x 8", "bytes_per_pixel": 42}],
    "error": {"rmse": 0.02, "bias": 0, "p99": 0.1, "max": 0.2},
    "equivalent_msaa": 8, "equivalent_msaa_is_lower_bound": true,
    "frames": [
     {"index": 3, "image": "beam/frame_0003.exr", "picture": "beam/frame_0003.png",
      "counters": "beam/frame_0003_counters.exr",
      "wall_ms": {"median": 4, "min": 4, "max": 4, "runs": 1}, "modelled_ms": {"shaders": {"at_once": 2, "in_turn": 3}},
      "dram_bytes": 800,
      "stages": [{"stage": "compose", "ops": {"total": 3000000, "bit": 2}, "bytes_read": 500000,
                  "bytes_written": 250000, "dram_bytes": 1000000, "lanes_used": 3, "lanes_issued": 8,
                  "modelled_ms": {"shaders": 0.5}}]},
     {"index": 4, "image": "beam/frame_0004.exr", "picture": "beam/frame_0004.png",
      "wall_ms": {"median": 8, "min": 8, "max": 8, "runs": 1},
      "modelled_ms": {"shaders": {"at_once": 4, "in_turn": 5}}, "dram_bytes": 1200,
      "stages": [{"stage": "compose", "ops": {"total": 1000000, "bit": 3}, "bytes_read": 200000,
                  "bytes_written": 50000, "dram_bytes": 1000000, "lanes_used": 1, "lanes_issued": 8,
                  "modelled_ms": {"shaders": 0.3}}]}]},
   {"technique": "reference", "framebuffer_bytes_per_pixel": 65536, "peak_bytes_per_pixel": 65536,
    "a_buffer_peak_bytes": 0, "framebuffer": [],
    "frames": [{"index": 3, "image": "reference/frame_0003.exr", "picture": "reference/frame_0003.png",
                "wall_ms": {"median": 1}, "stages": []},
               {"index": 4, "image": "reference/frame_0004.exr", "picture": "reference/frame_0004.png",
                "wall_ms": {"median": 1}, "stages": []}]}]})";

}  // namespace beampipe
