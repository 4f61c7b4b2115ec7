// The beam in sorted order. An A-buffer sorts the pairs of each pixel by depth. Window by window, near to far, pairs
// become shaded fragments and are composed, until the pixel is closed.
#pragma once

#include "pipeline/technique_table.h"
#include "stages/data/beam_aggregate.h"

namespace beampipe {

struct BeamOptions {
  int positions = 256;  // of the mask: 32, 64, 128 or 256
  Storage storage = Storage::packed;
};

TechniqueKind beam_kind();

}  // namespace beampipe
