// Temporal antialiasing: one sample per pixel and frame, jittered over the N standard positions. Frames are
// accumulated by reprojection, a clamp to the colours of the 3x3 neighbourhood, and a blend (Lottes, Karis and Salvi,
// as summed up in the DVM article).
#pragma once

#include "pipeline/technique.h"

namespace beampipe {

inline constexpr int kMaxTaaSamples = 16;

enum class TaaShading {
  visibility,  // as `visibility` shades
  deferred,    // as `deferred`
  forward,     // as `msaa:1,prepass`, at the sample
};

struct TaaOptions {
  TaaShading shading = TaaShading::visibility;
  int samples = 8;  // jitter positions: 1, 2, 4, 8 or 16
  float blend = 0.1f;
};

}  // namespace beampipe
