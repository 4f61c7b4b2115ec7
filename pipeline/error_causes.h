// Why a picture is wrong: each pixel's error split by cause.
//
// A pixel is the sum of weight times colour over its surfaces, the background among them. The technique's weights w and
// the reference's v, parts of its samples, both add up to 1; so the error is area that went from surfaces that got too
// little to surfaces that got too much. What one lost went to those that gained in proportion to their gains: a
// transfer of area a from surface i to surface j is an error of a (colour_j - colour_i), and all of them together are
// the error, whatever the causes. The cause of a transfer is the first that holds:
//   tiny               i or j covers no position of the technique's mask
//   interpenetration   both show where they overlap, i nearer at one place and j at another
//   order              i is nearer wherever they overlap, but the technique took j for the nearer one
//   leak               j is hidden altogether (nothing of the background is seen, if it is the background)
//   mixed              j was in part hidden by what was merged after both, and i gave way in its place
//   mask               the outline between the two is in the wrong place, as far as mask positions tell
// What the weights do not explain (fp16 colours) is `rounding`.
//
// "Nearer" and "overlap" are judged at 256 exact positions, the earlier triangle being nearer at equal depth.
#pragma once

#include <array>
#include <map>

#include "pipeline/technique.h"

namespace beampipe {

inline constexpr std::array kErrorCauses = {"leak", "mask", "order", "interpenetration", "tiny", "mixed", "rounding"};

// Per cause, for each pixel of the frame, row by row: the cause's error in the direction of the pixel's whole error,
// as a root of the mean square over R, G, B. A pixel's values add up to the length of its error; some may be negative,
// where a cause hides others. `weights`: what Technique::weights gave for this frame; `image` and `reference`: the
// frame's pictures.
std::map<std::string, std::vector<float>> error_causes(const Trace& trace, const Frame& frame,
                                                       const std::vector<PixelWeights>& weights, const Image& image,
                                                       const Image& reference, const RunOptions& run);

}  // namespace beampipe
