// Deferred shading with one sample per pixel: a depth pass, then materials in 2x2 quads into a G-buffer, then light.
#pragma once

#include "pipeline/technique.h"

namespace beampipe {

Framebuffer deferred_framebuffer();

}  // namespace beampipe
