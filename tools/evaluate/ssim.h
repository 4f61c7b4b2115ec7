// SSIM, the structural similarity of two pictures.
//
// Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli: Image Quality Assessment: From Error Visibility to Structural
// Similarity. IEEE Transactions on Image Processing 13 (4), 2004. With that paper's window (11 x 11 pixels, a Gaussian
// of standard deviation 1.5) and constants (K1 = 0.01, K2 = 0.03), on each of R, G and B by itself, which are clamped
// to 0..1 and encoded in sRGB. scikit-image gives the same numbers after structural_similarity(a, b, data_range=1,
// gaussian_weights=True, sigma=1.5, use_sample_covariance=False, channel_axis=2).
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/technique.h"

namespace beampipe {

// For each pixel the mean of the three channels; 1 where the windows are equal. Beyond the edge, the nearest pixel
// counts. Throws std::invalid_argument if the sizes differ.
std::vector<double> ssim_map(const Image& image, const Image& reference);

// The mean over all pixels whose window is inside of the picture. In a direction in which that is smaller than the
// window, all pixels count.
double mean_ssim(const std::vector<double>& map, std::uint32_t width);

}  // namespace beampipe
