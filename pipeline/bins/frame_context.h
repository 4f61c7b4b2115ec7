// What all bins of a frame have in common: the triangles, set up and shaded, and how the frame is to be rendered.
#pragma once

#include <optional>

#include "pipeline/technique.h"
#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/surface/surface_shader.h"
#include "traces/trace.h"

namespace beampipe {

struct FrameContext {
  const Frame& frame;
  const RunOptions& run;
  StageCounters setup;       // of one run of vertex_setup over the whole frame
  SetupTriangles triangles;  // in primitive order
  std::optional<TextureSet> own_textures;
  SurfaceShader shader;

  // Runs vertex_setup and the flat triangles' shader. The trace, the frame and the options must outlive it.
  FrameContext(const Trace& trace, const Frame& frame, const RunOptions& run, const ShadingRules& rules = {});
  FrameContext(const FrameContext&) = delete;
  FrameContext& operator=(const FrameContext&) = delete;
};

}  // namespace beampipe
