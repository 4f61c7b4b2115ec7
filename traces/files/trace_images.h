// Adding the images of a model to a trace.
#pragma once

#include <cstdint>
#include <string>

#include "traces/trace.h"

namespace beampipe {

// Returns the image's index in the trace. Throws TraceError, which starts with `where`, if all images of the trace
// together would have more than 2^28 texels: 1 GiB.
std::uint32_t add_image(Trace& trace, TextureImage image, const std::string& where);

}  // namespace beampipe
