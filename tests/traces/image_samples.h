// PNG and JPEG files of any kind, for tests of what reads them.
#pragma once

#include <png.h>
#include <turbojpeg.h>

#include <boost/crc.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace beampipe {

struct PngSample {
  std::uint32_t width = 1, height = 1;
  int color_type = PNG_COLOR_TYPE_RGB_ALPHA, depth = 8;
  std::vector<std::vector<std::uint8_t>> rows;  // as the file packs them
  std::vector<png_color> palette{};
  std::vector<std::uint8_t> palette_alpha{};
  const png_color_16* transparent = nullptr;  // this colour's alpha is 0
  bool interlaced = false;
  double gamma = 0;  // 0: the file names none
};

inline std::string png_bytes(const PngSample& sample) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  const auto append = [](png_structp to, png_bytep data, std::size_t size) {
    static_cast<std::string*>(png_get_io_ptr(to))->append(reinterpret_cast<const char*>(data), size);
  };
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_IHDR(png, info, sample.width, sample.height, sample.depth, sample.color_type,
               sample.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (!sample.palette.empty()) png_set_PLTE(png, info, sample.palette.data(), static_cast<int>(sample.palette.size()));
  if (!sample.palette_alpha.empty()) {
    png_set_tRNS(png, info, sample.palette_alpha.data(), static_cast<int>(sample.palette_alpha.size()), nullptr);
  }
  if (sample.transparent) png_set_tRNS(png, info, nullptr, 0, sample.transparent);
  if (sample.gamma > 0) png_set_gAMA(png, info, sample.gamma);
  std::vector<std::vector<std::uint8_t>> rows = sample.rows;
  std::vector<png_bytep> starts;
  for (auto& row : rows) starts.push_back(row.data());
  png_set_rows(png, info, starts.data());
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

inline std::string png_number(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
  return bytes;
}

inline std::string png_chunk(const std::string& name_and_data) {
  boost::crc_32_type crc;
  crc.process_bytes(name_and_data.data(), name_and_data.size());
  return png_number(static_cast<std::uint32_t>(name_and_data.size() - 4)) + name_and_data + png_number(crc.checksum());
}

// A file that claims a size in 8-bit RGBA, and goes on with `rest`.
inline std::string png_that_claims(std::uint32_t width, std::uint32_t height, const std::string& rest = "") {
  return "\x89PNG\r\n\x1a\n" +
         png_chunk("IHDR" + png_number(width) + png_number(height) + std::string("\x08\x06\0\0\0", 5)) + rest;
}

// `pixels` has width x height of the format, whose subsampling is a TJSAMP.
inline std::string jpeg_bytes(int width, int height, const std::vector<std::uint8_t>& pixels, TJPF format,
                              TJSAMP subsampling, int flags = 0) {
  tjhandle writer = tjInitCompress();
  unsigned char* data = nullptr;
  unsigned long size = 0;
  tjCompress2(writer, pixels.data(), width, 0, height, format, &data, &size, subsampling, 100, flags);
  std::string bytes(reinterpret_cast<const char*>(data), size);
  tjFree(data);
  tjDestroy(writer);
  return bytes;
}

}  // namespace beampipe
