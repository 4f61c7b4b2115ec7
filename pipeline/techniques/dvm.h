// Decoupled visibility multisampling (the article of that name). Visibility has 8 samples per pixel, a 2x2 quad has
// four shading samples. Shading samples are reassigned so that every material of the quad has one. Their masks spread
// the colours over the quad, and the picture is accumulated over time.
#pragma once

#include "pipeline/technique.h"
#include "stages/samples/materials.h"
#include "stages/samples/sample_select.h"

namespace beampipe {

// The clamp fades out below this motion, in pixels. This is the article's remedy for flicker at edges between lit
// facets.
inline constexpr float kStillPixels = 0.05f;

struct DvmOptions {
  float blend = 0.1f;
  MaterialBy material = MaterialBy::color;
};

// Technique::working_bytes_per_pixel. A quad has four pixels, and six counters are about quads.
inline constexpr std::uint32_t kDvmWorkingBytes = kTemporalWorkingBytes + sizeof(SampleQuad) / 4 + 6 * sizeof(float);

}  // namespace beampipe
