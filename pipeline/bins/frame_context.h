// What all bins of a frame have in common: the triangles, set up and shaded, and how the frame is to be rendered.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "pipeline/technique.h"
#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "traces/trace.h"

namespace beampipe {

struct FrameContext {
  const Frame& frame;
  const RunOptions& run;
  StageCounters setup;            // of one run of vertex_setup over the whole frame
  SetupTriangles triangles;       // in primitive order
  std::vector<glm::vec3> colors;  // what the shader returns, one per triangle; linear RGB

  // Runs vertex_setup and the triangles' shader. The frame and the options must outlive it.
  FrameContext(const Trace& trace, const Frame& frame, const RunOptions& run);
  FrameContext(const FrameContext&) = delete;
  FrameContext& operator=(const FrameContext&) = delete;
};

}  // namespace beampipe
