// Picture files: OpenEXR holds the numbers, PNG is for looking at.
//
// The EXR files are scanline images with ZIP compression and 32-bit float channels in linear light, row 0 on top. Their
// data window and display window are both (0, 0) .. (width - 1, height - 1).
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

// Text by name, for attributes of an EXR file's header.
using Labels = std::map<std::string, std::string>;

// The bytes of an EXR file with channels R, G, B, A.
std::string encode_exr(const Image& image, const Labels& labels = {});

// The bytes of an EXR file with one channel per plane. Throws std::invalid_argument when a plane has the wrong size.
std::string encode_exr(const Planes& planes, const Labels& labels = {});

// A linear value for looking at: clamped to [0, 1] and encoded in sRGB, 0..255. NaN is 0.
std::uint8_t srgb_byte(float linear);

// The bytes of an 8-bit RGB PNG file for looking at: linear values are clamped to [0, 1] and encoded in sRGB. NaN is
// black. Alpha is left out.
std::string encode_png(const Image& image);

// Reads an EXR file with channels R, G and B of any type, and A if there is one; otherwise A = 1. Throws ImageError if
// the file is broken, lacks a channel, is larger than 16384 pixels on a side, or has a data window other than the whole
// picture from (0, 0).
Image read_exr(const std::filesystem::path& file);

// Reads every channel of an EXR file as floats. Throws ImageError for the same reasons.
Planes read_exr_planes(const std::filesystem::path& file);

}  // namespace beampipe
