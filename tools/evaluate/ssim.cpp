#include "tools/evaluate/ssim.h"

#include "tools/evaluate/bands.h"
#include "tools/evaluate/planes.h"
#include "tools/evaluate/powers.h"

namespace beampipe {
namespace {

constexpr int kRadius = 5;

std::vector<double> window() {
  std::vector<double> weights;
  double sum = 0;
  for (int k = -kRadius; k <= kRadius; ++k) sum += weights.emplace_back(exp2_of(-k * k / (2 * 1.5 * 1.5) / kLn2));
  for (double& weight : weights) weight /= sum;
  return weights;
}

// The means over each pixel's window.
Plane<double> means(const Plane<double>& plane) {
  const std::vector<double> weights = window();
  return filtered(plane, weights, weights);
}

Plane<double> encoded_channel(const Image& image, std::size_t channel) {
  Plane<double> plane{image.width, image.height, std::vector<double>(image.rgba.size() / 4)};
  for (std::size_t i = 0; i < plane.values.size(); ++i) plane.values[i] = srgb_of_linear(image.rgba[4 * i + channel]);
  return plane;
}

std::vector<double> map_of(const Image& image, const Image& reference) {
  constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
  std::vector<double> map(image.rgba.size() / 4);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const Plane<double> a = encoded_channel(image, channel), b = encoded_channel(reference, channel);
    Plane<double> squares = a, products = a;  // a^2 + b^2 and a b
    for (std::size_t i = 0; i < map.size(); ++i) {
      squares.values[i] = a.values[i] * a.values[i] + b.values[i] * b.values[i];
      products.values[i] = a.values[i] * b.values[i];
    }
    const Plane<double> mean_a = means(a), mean_b = means(b);
    squares = means(squares);
    products = means(products);
    for (std::size_t i = 0; i < map.size(); ++i) {
      const double ma = mean_a.values[i], mb = mean_b.values[i], square = ma * ma + mb * mb;
      const double variances = squares.values[i] - square, covariance = products.values[i] - ma * mb;
      map[i] += (2 * ma * mb + kC1) * (2 * covariance + kC2) / ((square + kC1) * (variances + kC2));
    }
  }
  for (double& value : map) value /= 3;
  return map;
}

}  // namespace

std::vector<double> ssim_map(const Image& image, const Image& reference) {
  return map_in_bands<double>(image, reference, kRadius, map_of);
}

double mean_ssim(const std::vector<double>& map, std::uint32_t width) {
  const auto inside = [](std::size_t size) { return size > 2 * kRadius ? std::size_t{kRadius} : 0; };
  const std::size_t height = map.size() / width, dx = inside(width), dy = inside(height);
  double sum = 0;
  for (std::size_t y = dy; y < height - dy; ++y) {
    double row = 0;
    for (std::size_t x = dx; x < width - dx; ++x) row += map[y * width + x];
    sum += row;
  }
  return sum / (static_cast<double>(width - 2 * dx) * static_cast<double>(height - 2 * dy));
}

}  // namespace beampipe
