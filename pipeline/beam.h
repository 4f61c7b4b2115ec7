// The beam pipeline: conservative raster, fragments with analytic coverage and a localization mask, A-buffer, composition
// into one aggregate per pixel (Crassin et al. 2018).
#pragma once

#include "pipeline/technique.h"
#include "stages/beam_fragment.h"

namespace beampipe {

enum class Composition {
  merge,  // the paper's rules, by region
  over,   // alpha OVER alone: what the masks and slabs are worth
};

struct BeamOptions {
  Composition composition = Composition::merge;
  MaskSource mask = MaskSource::table;
};

FrameResult render_beam(const Trace& trace, const Frame& frame, const BeamOptions& beam, const RunOptions& run);

std::vector<Surface> beam_framebuffer(Composition composition);

}  // namespace beampipe
