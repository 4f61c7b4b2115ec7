// Deferred shading with one sample per pixel: a depth pass, then materials in 2x2 quads into a G-buffer, then light.
#pragma once

#include "pipeline/technique_table.h"

namespace beampipe {

std::vector<Surface> deferred_framebuffer();

TechniqueKind deferred_kind();

}  // namespace beampipe
