// The beam pipeline as published (Crassin et al. 2018). Conservative raster makes pairs; they become fragments with
// analytic coverage and a localization mask, are shaded, sorted in an A-buffer, and merged near to far into one
// aggregate per pixel.
#pragma once

#include "pipeline/technique_table.h"
#include "stages/beam/a_buffer.h"
#include "stages/beam/beam_fragment.h"
#include "stages/data/paper_aggregate.h"

namespace beampipe {

enum class Rules {
  paper,  // simd/merge.h: the published rules
  over,   // alpha OVER without masks and slabs, to show what those are worth
};

struct PaperOptions {
  Rules rules = Rules::paper;
  MaskSource mask = MaskSource::table;  // MaskSource::none with Rules::over
  SortKey sort = SortKey::centroid;
  int tiny_positions = 0;  // BeamFragmentOptions::tiny_positions
  MergeRules merge{};
  PaperStorage storage = PaperStorage::slides;
};

TechniqueKind beam_paper_kind();
TechniqueKind alpha_kind();  // the same fragments, Rules::over

}  // namespace beampipe
