// Pictures to bytes and back: OpenEXR for numbers, PNG for looking.
//
// EXR files are scanline images, ZIP, 32-bit float channels, linear, row 0 on top, with the data window and the display
// window both (0, 0) .. (width - 1, height - 1).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "pipeline/technique.h"

namespace beampipe {

// One line: "FILE: what is wrong with it".
struct ImageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Channels by name, each with width x height values, row 0 on top.
struct Planes {
  std::uint32_t width = 0, height = 0;
  std::map<std::string, std::vector<float>> channels;
};

// The bytes of an EXR file with channels R, G, B, A.
std::string encode_exr(const Image& image);

// The bytes of an EXR file with one channel per plane. Throws std::invalid_argument when a plane has the wrong size.
std::string encode_exr(const Planes& planes);

// The bytes of an 8-bit RGB PNG file for looking at: clamped to [0, 1], then the sRGB transfer curve; NaN is black.
std::string encode_png(const Image& image);

// The bytes of an 8-bit RGB PNG file: `rgb` has three bytes per pixel, row 0 on top, and is stored as it is.
std::string encode_png(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgb);

// Reads an EXR with channels R, G, B (any type) and, where there is one, A; else A = 1. Throws ImageError when it is
// broken, lacks a channel, is larger than 16384 on a side, or its data window is not the whole picture from (0, 0).
Image read_exr(const std::filesystem::path& file);

// Reads every channel of an EXR as float; the same errors.
Planes read_exr_planes(const std::filesystem::path& file);

}  // namespace beampipe
