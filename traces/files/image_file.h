// PNG and JPEG files of textures, and PNG files of RGB bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "traces/material.h"

namespace beampipe {

inline constexpr std::uint32_t kLargestImageSide = 16384;                 // texels
inline constexpr std::uint64_t kMostTexels = std::uint64_t{1} << 28;      // of all images of a trace: 1 GiB of them
inline constexpr std::uint64_t kMostImageBytes = std::uint64_t{1} << 30;  // of one file

// Why bytes are no image: "expected EXPECTED, found FOUND".
struct BadImage {
  std::string expected, found;
};

inline constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n";  // the first bytes of a PNG file

// The texels of a PNG or JPEG file, whose first bytes tell which it is. Grey is expanded to RGB, alpha is 255 where the
// file has none, and channels of 16 bits are rounded to 8. The numbers are taken as stored, as glTF asks: gamma, colour
// profiles and orientation are ignored. The image has no name.
//
// Throws BadImage if the file is damaged or ends early, if it is a JPEG in CMYK, and, before memory for texels is
// taken, if the image has a side above kLargestImageSide, more than `most_texels`, or more texels than so few bytes can
// hold.
TextureImage decode_image(std::string_view bytes, std::uint64_t most_texels = kMostTexels);

// The same for an image whose place is known: throws TraceError, with one line that starts with `where`.
TextureImage decode_image(std::string_view bytes, const std::string& where, std::uint64_t most_texels = kMostTexels);

// The bytes of a PNG file, which decode_image() turns into the same texels. Throws std::runtime_error if the image has
// no texels.
std::string encode_png(const TextureImage& image);

// The bytes of a PNG file that stores `rgb` unchanged: three bytes for each pixel, row 0 on top. Throws
// std::runtime_error if there are no pixels.
std::string encode_png(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgb);

}  // namespace beampipe
