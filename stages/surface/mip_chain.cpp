#include "stages/surface/mip_chain.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "traces/srgb.h"

namespace beampipe {
namespace {

constexpr int kChannels = 4;

std::array<float, 256> make_srgb_values() {
  std::array<float, 256> values;
  for (std::size_t code = 0; code < values.size(); ++code)
    values[code] = static_cast<float>(linear_of_srgb(static_cast<double>(code) / 255));
  return values;
}

// Halfway, as encoded, between a code and the next one.
std::array<float, 255> make_srgb_limits() {
  std::array<float, 255> limits;
  for (std::size_t code = 0; code < limits.size(); ++code)
    limits[code] = static_cast<float>(linear_of_srgb((static_cast<double>(code) + 0.5) / 255));
  return limits;
}

std::uint8_t linear_code(float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255 + 0.5f); }

// What a texel of the smaller level covers along one axis: up to three texels, with their shares.
struct Cover {
  std::uint32_t first = 0, count = 0;
  float shares[3] = {};
};

Cover cover_of(std::uint32_t texel, std::uint32_t size, std::uint32_t larger_size) {
  const double scale = static_cast<double>(larger_size) / size, begin = texel * scale, end = (texel + 1) * scale;
  Cover cover;
  cover.first = static_cast<std::uint32_t>(begin);
  for (std::uint32_t i = cover.first; i < larger_size && i < end && cover.count < 3; ++i)
    cover.shares[cover.count++] = static_cast<float>((std::min(end, i + 1.0) - std::max(begin, double(i))) / scale);
  return cover;
}

// Of linear values.
std::vector<glm::vec4> halved(const std::vector<glm::vec4>& larger, std::uint32_t larger_width,
                              std::uint32_t larger_height, std::uint32_t width, std::uint32_t height) {
  std::vector<Cover> columns;
  for (std::uint32_t x = 0; x < width; ++x) columns.push_back(cover_of(x, width, larger_width));
  std::vector<glm::vec4> smaller(std::size_t{width} * height);
  tbb::parallel_for(0u, height, [&](std::uint32_t y) {
    const Cover rows = cover_of(y, height, larger_height);
    for (std::uint32_t x = 0; x < width; ++x) {
      glm::vec4 sum(0.0f);
      for (std::uint32_t j = 0; j < rows.count; ++j)
        for (std::uint32_t i = 0; i < columns[x].count; ++i)
          sum += rows.shares[j] * columns[x].shares[i] *
                 larger[std::size_t{rows.first + j} * larger_width + columns[x].first + i];
      smaller[std::size_t{y} * width + x] = sum;
    }
  });
  return smaller;
}

TexelValues make_texel_values(ColorSpace space) {
  TexelValues values;
  for (std::size_t code = 0; code < values.alpha.size(); ++code) values.alpha[code] = static_cast<float>(code) / 255.0f;
  values.color = space == ColorSpace::srgb ? srgb_values() : values.alpha;
  return values;
}

glm::u8vec4 encoded(const glm::vec4& linear, ColorSpace space) {
  glm::u8vec4 texel;
  for (int c = 0; c < kChannels; ++c)
    texel[c] = space == ColorSpace::srgb && c < 3 ? srgb_code(linear[c]) : linear_code(linear[c]);
  return texel;
}

}  // namespace

const std::array<float, 256>& srgb_values() {
  static const std::array<float, 256> values = make_srgb_values();
  return values;
}

const TexelValues& texel_values(ColorSpace space) {
  static const TexelValues linear = make_texel_values(ColorSpace::linear), srgb = make_texel_values(ColorSpace::srgb);
  return space == ColorSpace::srgb ? srgb : linear;
}

std::uint8_t srgb_code(float linear) {
  static const std::array<float, 255> limits = make_srgb_limits();
  return static_cast<std::uint8_t>(std::upper_bound(limits.begin(), limits.end(), linear) - limits.begin());
}

MipChain make_mip_chain(const TextureImage& image, ColorSpace space) {
  MipChain chain{space, {{image.width, image.height, image.texels}}};
  std::vector<glm::vec4> values;
  values.reserve(image.texels.size());
  for (const glm::u8vec4& texel : image.texels) values.push_back(texel_values(space)(texel));
  std::uint32_t width = image.width, height = image.height;
  while (width > 1 || height > 1) {
    const std::uint32_t half_width = std::max(width / 2, 1u), half_height = std::max(height / 2, 1u);
    values = halved(values, width, height, half_width, half_height);
    width = half_width, height = half_height;
    MipLevel& level = chain.levels.emplace_back(MipLevel{width, height, {}});
    level.texels.reserve(values.size());
    for (const glm::vec4& value : values) level.texels.push_back(encoded(value, space));
  }
  return chain;
}

}  // namespace beampipe
