// libpng and libjpeg-turbo read the files, and not stb_image, which is smaller: its authors say that it is not meant
// for files from people whom one does not trust. These two are fuzzed all the time, and Debian fixes their faults.
#include "traces/files/image_file.h"

#include <png.h>
#include <turbojpeg.h>

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <vector>

#include "traces/files/input_file.h"
#include "traces/files/json.h"
#include "traces/size_text.h"

namespace beampipe {
namespace {

constexpr std::string_view kJpegStart = "\xff\xd8\xff";

// At most 1032 bytes come out of one of deflate (zlib.net/zlib_tech.html); the rest is for rounding.
constexpr std::uint64_t kMostPngGrowth = 1100;  // bytes of pixels per byte of the file
// A block of 8 x 8 texels has a Huffman code, which has at least 1 bit.
constexpr std::uint64_t kMostJpegGrowth = 512;  // texels per byte of the file

std::string in_numbers(std::uint64_t number, const char* unit) { return std::to_string(number) + ' ' + unit; }

// An image without a name and with black texels. `least_bytes` is the least that a file of this size has.
TextureImage blank_image(std::uint32_t width, std::uint32_t height, std::uint64_t most_texels, std::uint64_t bytes,
                         std::uint64_t least_bytes) {
  const std::string size = size_text(width, height);
  if (width > kLargestImageSide || height > kLargestImageSide) {
    throw BadImage{"at most " + in_numbers(kLargestImageSide, "texels on a side"), size};
  }
  const std::uint64_t texels = std::uint64_t{width} * height;
  if (texels > most_texels) {
    throw BadImage{"at most " + in_numbers(kMostTexels, "texels in all images together"), size + " in this one"};
  }
  if (bytes < least_bytes) {
    throw BadImage{"at least " + in_numbers(least_bytes, "bytes for ") + size + " texels", std::to_string(bytes)};
  }
  return {.name = "", .width = width, .height = height, .texels = std::vector<glm::u8vec4>(texels)};
}

struct PngSource {
  std::string_view rest;   // what is not read yet
  char reason[128] = {0};  // of the first error
};

[[noreturn]] void stop(png_structp png, png_const_charp reason) {
  auto& source = *static_cast<PngSource*>(png_get_error_ptr(png));
  std::snprintf(source.reason, sizeof source.reason, "%s", reason);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

void take_bytes(png_structp png, png_bytep out, std::size_t count) {
  auto& source = *static_cast<PngSource*>(png_get_io_ptr(png));
  if (count > source.rest.size()) png_error(png, "the file ends early");
  std::memcpy(out, source.rest.data(), count);
  source.rest.remove_prefix(count);
}

struct PngReader {
  explicit PngReader(PngSource& source)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, stop, ignore_warning)),
        info(png ? png_create_info_struct(png) : nullptr) {
    if (!info) {
      png_destroy_read_struct(&png, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png, &source, take_bytes);
    // Only what says which texels there are. Colour profiles and texts could be made to take memory and time.
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }

  png_structp png;
  png_infop info;
};

// libpng ends these two functions by longjmp when it finds an error. They own nothing that would have to be destroyed.
bool read_header(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, info);
  return true;
}

bool read_rows(png_structp png, png_infop info, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_expand(png);  // palettes, fewer than 8 bits, transparent colours
  png_set_scale_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  if (png_get_rowbytes(png, info) != std::size_t{4} * png_get_image_width(png, info)) png_error(png, "not RGBA");
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

TextureImage decode_png(std::string_view bytes, std::uint64_t most_texels) {
  PngSource source{.rest = bytes};
  const PngReader reader(source);
  const auto fail = [&] { throw BadImage{"a sound PNG file", in_quotes(source.reason)}; };
  if (!read_header(reader.png, reader.info)) fail();
  const std::uint32_t height = png_get_image_height(reader.png, reader.info);
  const std::uint64_t pixels = std::uint64_t{png_get_rowbytes(reader.png, reader.info)} * height;
  TextureImage image = blank_image(png_get_image_width(reader.png, reader.info), height, most_texels, bytes.size(),
                                   pixels / kMostPngGrowth);
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y) rows[y] = &image.texels[y * image.width].r;
  if (!read_rows(reader.png, reader.info, rows.data())) fail();
  return image;
}

TextureImage decode_jpeg(std::string_view bytes, std::uint64_t most_texels) {
  const std::unique_ptr<void, int (*)(tjhandle)> reader(tjInitDecompress(), tjDestroy);
  if (!reader) throw std::bad_alloc();
  const auto fail = [&] { throw BadImage{"a sound JPEG file", in_quotes(tjGetErrorStr2(reader.get()))}; };
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, colors = 0;
  if (tjDecompressHeader3(reader.get(), data, bytes.size(), &width, &height, &subsampling, &colors) != 0) fail();
  // The library takes a file of tables alone for a sound one, and sets no size.
  if (width < 1 || height < 1) throw BadImage{"a sound JPEG file", "one without a picture"};
  if (colors == TJCS_CMYK || colors == TJCS_YCCK) throw BadImage{"a JPEG file in grey or RGB", "CMYK"};
  const std::uint64_t texels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  TextureImage image = blank_image(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), most_texels,
                                   bytes.size(), texels / kMostJpegGrowth);
  // The accurate transform gives the same bits with and without SIMD. The library mends damaged files and warns,
  // which counts as an error here. Files with so many scans that reading them takes minutes are refused too.
  constexpr int kFlags = TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
  if (tjDecompress2(reader.get(), data, bytes.size(), &image.texels[0].r, width, 0, height, TJPF_RGBA, kFlags) != 0)
    fail();
  return image;
}

std::string encode_png(std::uint32_t width, std::uint32_t height, png_uint_32 format, const void* pixels) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = width;
  png.height = height;
  png.format = format;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, pixels, 0, nullptr))
    throw std::runtime_error(std::string("cannot encode a PNG image: ") + png.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace

TextureImage decode_image(std::string_view bytes, std::uint64_t most_texels) {
  if (bytes.starts_with(kPngStart)) return decode_png(bytes, most_texels);
  if (bytes.starts_with(kJpegStart)) return decode_jpeg(bytes, most_texels);
  throw BadImage{"a PNG or JPEG file",
                 bytes.empty() ? "no bytes" : "one that starts with " + in_quotes(bytes.substr(0, kPngStart.size()))};
}

TextureImage decode_image(std::string_view bytes, const std::string& where, std::uint64_t most_texels) {
  try {
    return decode_image(bytes, most_texels);
  } catch (const BadImage& bad) {
    fail_trace(where, bad.expected, bad.found);
  }
}

std::string encode_png(const TextureImage& image) {
  return encode_png(image.width, image.height, PNG_FORMAT_RGBA, image.texels.data());
}

std::string encode_png(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgb) {
  return encode_png(width, height, PNG_FORMAT_RGB, rgb.data());
}

}  // namespace beampipe
