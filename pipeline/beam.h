// The beam pipeline (Crassin et al. 2018): conservative raster, fragments with analytic coverage and a localization
// mask, A-buffer, composition into one aggregate per pixel.
#pragma once

#include "pipeline/technique.h"
#include "stages/a_buffer.h"
#include "stages/beam_fragment.h"
#include "stages/paper_storage.h"
#include "stages/stored_aggregate.h"

namespace beampipe {

enum class Rules {
  conserve,  // stages/compose_window.h: area is conserved, depth is compared per mask position
  paper,     // simd/merge.h: the published rules
  over,      // alpha OVER alone: what masks and slabs are worth
};

struct BeamOptions {
  Rules rules = Rules::conserve;
  int positions = 256;                  // of the mask: 32, 64, 128 or 256; 32 with the paper's rules; 0 without masks
  MaskSource mask = MaskSource::exact;  // table: 32 positions only; none: with `over`
  SortKey sort = SortKey::nearest;
  int tiny_positions = 0;                             // BeamFragmentOptions::tiny_positions
  MergeRules merge{};                                 // with `paper`
  Storage storage = Storage::packed;                  // with `conserve`
  PaperStorage paper_storage = PaperStorage::slides;  // with `paper`
};

FrameResult render_beam(const Trace& trace, const Frame& frame, const BeamOptions& beam, const RunOptions& run);

// Technique::weights. With Rules::conserve depth is compared position by position, so `order` decides nothing.
std::vector<PixelWeights> beam_weights(const Trace& trace, const Frame& frame, const BeamOptions& beam,
                                       const RunOptions& run);

std::vector<Surface> beam_framebuffer(const BeamOptions& beam);

}  // namespace beampipe
