#include "pipeline/bins/frame_context.h"

#include "pipeline/bins/timeline.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/shade.h"

namespace beampipe {

FrameContext::FrameContext(const Trace& trace, const Frame& rendered, const RunOptions& options)
    : frame(rendered),
      run(options),
      triangles(vertex_setup(trace, frame, StageTimer(run.timeline)(setup))),
      colors(shade_triangles(triangles, frame.lighting)) {}

}  // namespace beampipe
