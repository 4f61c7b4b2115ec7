// Z3 (Jouppi and Chang 1999), an earlier way to do without an A-buffer. Fragments go in primitive order into a few
// layers per pixel; when there are too many, two layers are merged (stages/beam/compose_z3.h).
#pragma once

#include "pipeline/technique_table.h"
#include "stages/beam/compose_z3.h"

namespace beampipe {

struct Z3Options {
  int positions = 32;  // together with `layers` one of BEAMPIPE_Z3_PIXELS
  int layers = 3;
  LayerMerge merge = LayerMerge::depth;
};

TechniqueKind z3_kind();

}  // namespace beampipe
