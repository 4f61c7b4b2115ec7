#include "traces/scenes/textures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "traces/scenes/random.h"

namespace beampipe {
namespace {

std::uint8_t stored(double value) {
  return static_cast<std::uint8_t>(std::floor(255 * std::clamp(value, 0.0, 1.0) + 0.5));
}

}  // namespace

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double triangle_wave(double x) { return 1 - std::abs(2 * (x - std::floor(x)) - 1); }

double lattice_noise(double x, double y, int columns, int rows, std::uint64_t seed) {
  const double fx = std::floor(x * columns), fy = std::floor(y * rows);
  const auto value = [&](int dx, int dy) {
    const auto wrap = [](std::int64_t i, int count) { return static_cast<std::uint64_t>((i % count + count) % count); };
    const std::uint64_t i = wrap(static_cast<std::int64_t>(fx) + dx, columns),
                        j = wrap(static_cast<std::int64_t>(fy) + dy, rows);
    return static_cast<double>(mix_bits(mix_bits(seed + (i << 32 | j)) + 0x9e3779b97f4a7c15u) >> 11) * 0x1p-53;
  };
  const double u = smooth_step(0, 1, x * columns - fx), v = smooth_step(0, 1, y * rows - fy);
  return (value(0, 0) * (1 - u) + value(1, 0) * u) * (1 - v) + (value(0, 1) * (1 - u) + value(1, 1) * u) * v;
}

double fractal_noise(double x, double y, int columns, int rows, int octaves, std::uint64_t seed) {
  double sum = 0, weights = 0, weight = 1;
  for (int octave = 0; octave < octaves; ++octave, weight /= 2) {
    const int scale = 1 << octave;
    sum += weight * lattice_noise(x, y, columns * scale, rows * scale, seed + static_cast<std::uint64_t>(octave));
    weights += weight;
  }
  return sum / weights;
}

TextureImage paint_image(std::string name, ImageSize size, const ColorPattern& color) {
  TextureImage image{std::move(name), size.width, size.height, {}};
  image.texels.reserve(std::size_t{size.width} * size.height);
  for (std::uint32_t j = 0; j < size.height; ++j) {
    for (std::uint32_t i = 0; i < size.width; ++i) {
      const glm::dvec4 c = color((i + 0.5) / size.width, (j + 0.5) / size.height);
      image.texels.emplace_back(stored(c.r), stored(c.g), stored(c.b), stored(c.a));
    }
  }
  return image;
}

TextureImage paint_normals(std::string name, ImageSize size, const Pattern& height) {
  std::vector<double> heights;  // in texels, of each texel
  for (std::uint32_t j = 0; j < size.height; ++j)
    for (std::uint32_t i = 0; i < size.width; ++i)
      heights.push_back(size.width * height((i + 0.5) / size.width, (j + 0.5) / size.height));
  TextureImage image{std::move(name), size.width, size.height, {}};
  for (std::uint32_t j = 0; j < size.height; ++j) {
    for (std::uint32_t i = 0; i < size.width; ++i) {
      const auto at = [&](std::uint32_t x, std::uint32_t y) {
        return heights[std::size_t{y % size.height} * size.width + x % size.width];
      };
      const double right = (at(i + 1, j) - at(i + size.width - 1, j)) / 2;
      const double down = (at(i, j + 1) - at(i, j + size.height - 1)) / 2;
      const double length = std::sqrt(right * right + down * down + 1);  // green is towards the image's top
      image.texels.emplace_back(stored(0.5 - 0.5 * right / length), stored(0.5 + 0.5 * down / length),
                                stored(0.5 + 0.5 / length), 255);
    }
  }
  return image;
}

TextureImage paint_roughness(std::string name, ImageSize size, const Pattern& roughness) {
  return paint_image(std::move(name), size, [&](double x, double y) { return glm::dvec4(0, roughness(x, y), 0, 1); });
}

double wood_grain(double x, double y) {
  const double bend = 0.35 * fractal_noise(x, y, 2, 3, 2, 11);
  const double rings = triangle_wave(9 * (y + bend)), fibres = lattice_noise(x, y, 6, 128, 12);
  return 0.6 * rings * rings + 0.4 * fibres;
}

glm::dvec4 wood_tint(double grain) {
  const double dark = std::floor(32 * grain) / 32;  // few colours make a small PNG file
  return {1 - 0.45 * dark, 1 - 0.53 * dark, 1 - 0.60 * dark, 1};
}

}  // namespace beampipe
