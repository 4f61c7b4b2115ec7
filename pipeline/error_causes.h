// Why a picture is wrong: each pixel's error split by cause.
//
// A pixel is the sum of weight times colour over its surfaces, one of which is the background. The technique's weights
// and the reference's weights (shares of its samples) both add up to 1. So the error is area that moved from surfaces
// with too little weight to surfaces with too much. What one surface lost is split over the gaining surfaces in
// proportion to their gains: moving area a from surface i to surface j is an error of a (colour_j - colour_i), and
// these transfers add up to the error of the pixel. The cause of a transfer is the first of these that holds:
//   tiny               i or j covers no position of the technique's mask
//   interpenetration   each is nearer than the other somewhere in the pixel
//   order              i is nearer wherever they overlap, but the technique took j to be nearer
//   leak               the reference sees nothing of j
//   mixed              a surface that was merged after both hides part of j, and i lost area instead of j
//   mask               the outline between the two is in the wrong place, as far as mask positions tell
// Where the target stores numbers that stand for sRGB, these are what adds up: the split is that of the stored colours,
// scaled to the pixel's error.
// If surfaces vary, all this holds for pictures and weights that are rendered with SurfaceColors::by_pixel: each
// triangle has one colour in a pixel then, and the error is one of visibility.
//
// The part of the error that weights do not explain (formats of colours, and limits on their channels) is `rounding`.
// In frames that need the API's order, where colours are products of what draws do, that is all of it, and pixels have
// no surfaces.
//
// Depths are compared at 256 exact positions. At equal depth the earlier triangle counts as nearer.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <map>
#include <vector>

#include "pipeline/technique.h"
#include "stages/data/sample_tile.h"

namespace beampipe {

inline constexpr std::array kErrorCauses = {"leak", "mask", "order", "interpenetration", "tiny", "mixed", "rounding"};

// Returns one value per cause and pixel of the frame, row by row: the part of the cause's error that points in the
// direction of the pixel's whole error, as a root mean square over R, G and B. A pixel's values add up to the length of
// its error. A value is negative where the cause makes up for others. `job`: as the frame was rendered.
// `weights`: FrameSinks::weights. `image` and `reference`: the frame's pictures.
std::map<std::string, std::vector<float>> error_causes(const FrameJob& job, const std::vector<PixelWeights>& weights,
                                                       const Image& image, const Image& reference);

// The error of a pixel, from that of its channels: root mean square over R, G and B.
double root_mean_square(const glm::dvec3& error);

// A triangle in a pixel, or the background (kNoTriangle): its part of the pixel by the technique and by the reference.
struct ExplainedSurface {
  std::uint32_t triangle;
  double weight, truth;
  glm::dvec3 color;  // as the frame's target stores it (pipeline/stored_colors.h)
};

// An area that one surface lost and another gained.
struct AreaTransfer {
  std::size_t from, to;  // indices of surfaces
  double area;
  std::size_t cause;  // index into kErrorCauses
};

struct ExplainedPixel {
  std::vector<ExplainedSurface> surfaces;  // by triangle; the background comes last
  std::vector<AreaTransfer> transfers;
  std::array<double, kErrorCauses.size()> causes{};  // as error_causes returns them
};

// A pixel to explain: the technique's weights, and linear RGB in the two pictures.
struct PixelColors {
  PixelAddress at;
  PixelWeights weights;
  glm::dvec3 color, reference;
};

// The same for some pixels, with all that the split is made of.
std::vector<ExplainedPixel> explain_pixels(const Trace& trace, const Frame& frame,
                                           const std::vector<PixelColors>& pixels, const FrameInput& run);

}  // namespace beampipe
