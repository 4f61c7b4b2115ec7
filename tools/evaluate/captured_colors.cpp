#include "tools/evaluate/captured_colors.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>

#include "tools/files/image_io.h"

namespace beampipe {
namespace {

constexpr int kBrightness = 8;  // of the picture of differences

// Of a pixel, for each channel.
std::array<int, 3> differences(const TextureImage& captured, const Image& image, std::size_t pixel) {
  std::array<int, 3> codes{};
  for (std::size_t k = 0; k < 3; ++k)
    codes[k] = std::abs(int{srgb_byte(image.rgba[4 * pixel + k])} -
                        int{captured.texels[pixel][static_cast<glm::length_t>(k)]});
  return codes;
}

const TextureImage& captured_picture(const Trace& trace, const Frame& frame, const Image& image) {
  if (!frame.capture.pictures.color) throw std::invalid_argument("the frame has no captured picture");
  const TextureImage& captured = trace.images.at(*frame.capture.pictures.color);
  if (image.width != captured.width || image.height != captured.height)
    throw std::invalid_argument("the picture has another size than the captured one");
  return captured;
}

}  // namespace

double ColorCheck::close_part() const { return part_of(close, pixels); }

ColorCheck check_colors(const Trace& trace, const Frame& frame, const Image& image,
                        const std::vector<std::uint32_t>& draws) {
  const TextureImage& captured = captured_picture(trace, frame, image);
  ColorCheck check{.pixels = captured.texels.size(), .draws = {}};
  if (draws.size() != check.pixels) throw std::invalid_argument("expected a draw for each pixel");
  DrawDifferences of_draws(frame.draws.size());
  for (std::size_t pixel = 0; pixel < check.pixels; ++pixel) {
    const std::array<int, 3> codes = differences(captured, image, pixel);
    const int largest = *std::max_element(codes.begin(), codes.end());
    const bool is_close = largest <= ColorCheck::kClose;
    check.close += is_close;
    check.largest = std::max(check.largest, largest);
    of_draws.add(draws[pixel], !is_close, largest);
  }
  check.draws = of_draws.sorted();
  return check;
}

std::vector<std::uint8_t> color_difference_picture(const Trace& trace, const Frame& frame, const Image& image) {
  const TextureImage& captured = captured_picture(trace, frame, image);
  std::vector<std::uint8_t> picture;
  picture.reserve(3 * captured.texels.size());
  for (std::size_t pixel = 0; pixel < captured.texels.size(); ++pixel)
    for (const int code : differences(captured, image, pixel))
      picture.push_back(static_cast<std::uint8_t>(std::min(255, kBrightness * code)));
  return picture;
}

}  // namespace beampipe
