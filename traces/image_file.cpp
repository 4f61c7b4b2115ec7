#include "traces/image_file.h"

#include <stb/stb_image.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "traces/input_file.h"

namespace beampipe {
namespace {

constexpr int kLargestSide = 16384;
constexpr std::size_t kMostBytes = std::size_t{1} << 30;  // the library counts bytes in 31 bits

bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1a\n"); }
bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8\xff"); }

}  // namespace

TextureImage decode_image(std::string_view bytes, const std::string& where) {
  if (!is_png(bytes) && !is_jpeg(bytes)) fail_trace(where, "a PNG or JPEG image", "something else");
  if (bytes.size() > kMostBytes)
    fail_trace(where, "an image of at most 1 GiB", std::to_string(bytes.size()) + " bytes");
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(data, size, &width, &height, &channels))
    fail_trace(where, "a PNG or JPEG image", "a broken one");
  if (std::clamp(width, 1, kLargestSide) != width || std::clamp(height, 1, kLargestSide) != height) {
    fail_trace(where, "an image of 1.." + std::to_string(kLargestSide) + " texels a side",
               std::to_string(width) + " x " + std::to_string(height));
  }
  const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> texels(
      stbi_load_from_memory(data, size, &width, &height, &channels, 4), stbi_image_free);
  if (!texels) fail_trace(where, "a PNG or JPEG image", "a broken one");
  TextureImage image;
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
  image.texels.resize(std::size_t{image.width} * image.height);
  std::memcpy(image.texels.data(), texels.get(), image.texels.size() * sizeof image.texels[0]);
  return image;
}

TextureImage read_image(const std::filesystem::path& file, const std::string& where) {
  return decode_image(read_input_file(file, where), where);
}

}  // namespace beampipe
