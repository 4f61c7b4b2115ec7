// The beam in streaming order: fragments come in primitive order, without an A-buffer or any memory per fragment. A
// pixel keeps only its state (stages/data/owner_pixel.h). A pixel that shows more surfaces than it has layers takes
// further passes over the geometry; each pass settles the nearest surfaces that are left.
#pragma once

#include "pipeline/technique_table.h"

namespace beampipe {

struct StreamOptions {
  int positions = 128;  // 32, 64, 128 or 256
  int layers = 5;       // 1 or 5
  int passes = 0;       // the most passes; 0: until every pixel is settled
};

TechniqueKind beam_stream_kind();

}  // namespace beampipe
