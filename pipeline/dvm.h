// Decoupled visibility multisampling (the article of that name): visibility at 8 samples per pixel, four shading
// samples per 2x2 quad, switched so that every material of the quad has one, spread by their masks, accumulated over
// time.
#pragma once

#include "pipeline/technique.h"

namespace beampipe {

// What makes two triangles of the same material: shading samples are spread to it alone.
enum class MaterialBy {
  color,  // the draw and the Kd: an OBJ's material groups, which a renderer would draw one by one
  draw,   // the draw alone, as if a texture made its colours
};

struct DvmOptions {
  float blend = 0.1f;
  std::uint32_t seed = 1;
  MaterialBy material = MaterialBy::color;
};

FrameResult render_dvm(const Trace& trace, const Frame& frame, const DvmOptions& options, const RunOptions& run);

std::vector<Surface> dvm_framebuffer();

}  // namespace beampipe
