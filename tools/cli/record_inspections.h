// The pixels that `compare` inspects when all frames are finished.
#pragma once

#include <string>
#include <vector>

#include "pipeline/technique.h"
#include "tools/evaluate/results.h"
#include "tools/evaluate/run_plan.h"
#include "tools/files/output.h"

namespace beampipe {

struct RecordedPixels {
  std::uint32_t worst = 3;          // so many with the largest errors of all frames
  std::vector<std::string> chosen;  // X,Y in every frame
};

// "X,Y". Throws UsageError, which names the option, unless it is a pixel of the frame.
PixelAddress parse_pixel(const std::string& option, const std::string& text, const Frame& frame);

// For each technique that can be inspected, writes the histories of these pixels into its folder and notes the file in
// the report. `plan`: of the report, whose pictures are in the folder.
void record_inspections(const RunPlan& plan, const RecordedPixels& pixels, Report& report, OutputFolder& output);

}  // namespace beampipe
