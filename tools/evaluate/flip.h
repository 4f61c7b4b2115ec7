// FLIP, which predicts how large the difference between two pictures looks when one flips from one to the other.
//
// LDR-FLIP: P. Andersson, J. Nilsson, T. Akenine-Moeller, M. Oskarsson, K. Astroem, M. D. Fairchild: FLIP: A Difference
// Evaluator for Alternating Images. Proceedings of the ACM on Computer Graphics and Interactive Techniques 3 (2), 2020.
// HDR-FLIP: P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Moeller: Visualizing Errors in Rendered High Dynamic Range
// Images. Eurographics 2021 Short Papers. Filters are split into rows and columns, as the authors' program does since
// its version 1.2.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/technique.h"

namespace beampipe {

// What an eye sees of a screen of 3840 pixels and 0.7 m from a distance of 0.7 m: 3840 pi / 180, the papers' value.
inline constexpr double kPixelsPerDegree = 67.0206432765823;

// LDR-FLIP for each pixel, 0..1. R, G and B are linear light and clamped to 0..1. Throws std::invalid_argument if the
// sizes differ.
std::vector<float> flip_map(const Image& image, const Image& reference, double pixels_per_degree = kPixelsPerDegree);

// The exposures of HDR-FLIP for a reference: `count` powers of two, evenly from `start` to `stop`.
struct Exposures {
  double start = 0, stop = 0;
  int count = 1;
};

// From the one at which the brightest pixel becomes 0.85 on the screen to the one at which the median pixel does, at
// most one apart, and at least two. Where the median is black, the median of the pixels that are not black counts. A
// black reference has the exposure 0 only.
Exposures exposures_for(const Image& reference);

// HDR-FLIP for each pixel, 0..1: the largest LDR-FLIP of any exposure, after the tone mapper ACES. R, G and B are
// clamped to 0..65536. Throws std::invalid_argument if the sizes differ.
std::vector<float> hdr_flip_map(const Image& image, const Image& reference,
                                double pixels_per_degree = kPixelsPerDegree);

// Added row by row, in doubles. `width` is that of the picture.
double mean_of(const std::vector<float>& map, std::uint32_t width);

}  // namespace beampipe
