// Decoupled visibility multisampling (the article of that name). Visibility has 8 samples per pixel, a 2x2 quad has
// four shading samples. Shading samples are reassigned so that every material of the quad has one. Their masks spread
// the colours over the quad, and the picture is accumulated over time.
#pragma once

#include "pipeline/technique.h"
#include "stages/samples/materials.h"
#include "stages/samples/sample_select.h"
#include "stages/temporal/temporal.h"

namespace beampipe {

// The clamp fades out below this motion, in pixels. This is the article's remedy for flicker at edges between lit
// facets.
inline constexpr float kStillPixels = 0.05f;

// By how many standard deviations Clamp::variance widens the box. With two, thin bars flicker as little as with
// Clamp::rest, but a hut that passes another one has a third more error (docs/over_time.py).
inline constexpr float kDeviations = 1.0f;

struct DvmOptions {
  float blend = 0.1f;
  MaterialBy material = MaterialBy::color;
  Clamp clamp = Clamp::rest;
  std::uint32_t room = 0;  // for extra shading samples in a quad
};

}  // namespace beampipe
