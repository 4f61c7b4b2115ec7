// A pixel explained: its history (stages/data/pixel_history.h), how wrong it is, and why.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/error_causes.h"
#include "pipeline/technique.h"
#include "traces/trace.h"

namespace beampipe {

// A triangle, or the background, that the technique or the reference sees in the pixel.
struct InspectedSurface {
  std::uint32_t fragment;       // index into the history's fragments; kNobody: the background
  double weight;                // part of the pixel by the technique
  std::optional<double> truth;  // by the reference; not known where draws keep the API's order
  glm::dvec3 color;             // the mean of the terms' or, without terms, of the explanation's

  double largest_part() const { return std::max(weight, truth.value_or(0)); }
};

// Colours of the history and of surfaces are as the frame's target stores them (pipeline/stored_colors.h).
struct PixelInspection {
  std::string technique;
  std::size_t frame = 0;
  PixelHistory history;
  std::vector<std::string> draw_names;  // one per fragment of the history: "0 'fence'"
  ColorTarget target{};
  glm::vec3 picture{0}, reference{0};  // the pixel in both pictures, linear RGB
  double error = 0;                    // root mean square over R, G and B
  // Where surfaces vary, the part that is left when the technique and the reference give each triangle one colour.
  std::optional<double> visibility_error;
  std::vector<InspectedSurface> surfaces;  // those that have a part of the pixel; the background comes last
  std::vector<AreaTransfer> transfers;     // between these, those with the most effect on the colour first
  std::vector<double> causes;              // of the error, or of the visibility error, in the order of kErrorCauses
};

// Does anybody own a position in the end? Where draws keep the API's order, nobody does.
bool has_owners(const PixelHistory& history);

// The techniques that can be inspected, in the order of technique_kinds().
std::vector<std::string> inspectable_names();

// Throws SpecError unless it is observable.
void require_inspectable(const Technique& technique);

// The technique must be observable.
std::vector<PixelInspection> inspect(const Trace& trace, std::size_t frame, const Technique& technique,
                                     const std::vector<PixelAddress>& pixels, const FrameInput& run);

// The pixels whose error is largest, the worst first; of equal ones, the first one in the picture.
std::vector<PixelAddress> worst_pixels(const Image& image, const Image& reference, std::size_t count);

}  // namespace beampipe
