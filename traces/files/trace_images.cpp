#include "traces/files/trace_images.h"

#include <utility>

#include "traces/files/image_file.h"
#include "traces/files/input_file.h"

namespace beampipe {

std::uint32_t add_image(Trace& trace, TextureImage image, const std::string& where) {
  std::uint64_t texels = std::uint64_t{image.width} * image.height;
  for (const TextureImage& other : trace.images) texels += std::uint64_t{other.width} * other.height;
  if (texels > kMostTexels)
    fail_trace(where, "images of at most " + std::to_string(kMostTexels) + " texels together", std::to_string(texels));
  trace.images.push_back(std::move(image));
  return static_cast<std::uint32_t>(trace.images.size() - 1);
}

}  // namespace beampipe
