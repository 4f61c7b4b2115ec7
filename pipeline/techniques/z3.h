// Z3 (Jouppi and Chang 1999), an earlier way to do without an A-buffer. Fragments go in primitive order into a few layers
// per pixel; when there are too many, two layers are merged (stages/beam/compose_z3.h).
#pragma once

#include "pipeline/technique.h"
#include "stages/beam/compose_z3.h"

namespace beampipe {

struct Z3Options {
  int positions = 32;  // together with `layers` one of BEAMPIPE_Z3_PIXELS
  int layers = 3;
  LayerMerge merge = LayerMerge::depth;
};

FrameResult render_z3(const Trace& trace, const Frame& frame, const Z3Options& z3, const RunOptions& run);

std::vector<Surface> z3_framebuffer(const Z3Options& z3);

}  // namespace beampipe
