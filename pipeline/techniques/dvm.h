// Decoupled visibility multisampling (the article of that name): visibility at 8 samples per pixel, four shading
// samples per 2x2 quad, switched so that every material of the quad has one, spread by their masks, accumulated over
// time.
#pragma once

#include "pipeline/technique.h"
#include "stages/samples/materials.h"
#include "stages/samples/sample_select.h"

namespace beampipe {

// The clamp fades out below this motion, in pixels: the article's remedy for flicker at edges between lit facets.
inline constexpr float kStillPixels = 0.05f;

struct DvmOptions {
  float blend = 0.1f;
  std::uint32_t seed = 1;
  MaterialBy material = MaterialBy::color;
};

// Per pixel, in this program (Technique::working_bytes_per_pixel): a quad is of four pixels.
inline constexpr std::uint32_t kDvmWorkingBytes = kTemporalWorkingBytes + sizeof(SampleQuad) / 4;

FrameResult render_dvm(const Trace& trace, const Frame& frame, const DvmOptions& options, const RunOptions& run);

std::vector<Surface> dvm_framebuffer();

}  // namespace beampipe
