// Decodes any bytes as an image. They give an error of one line, or an image that can be encoded and decoded again.
#include "tests/fuzz/fuzz_input.h"
#include "traces/files/image_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  constexpr std::uint64_t kMostFuzzedTexels = 1 << 18;  // so that inputs take little time
  TextureImage image;
  try {
    image = decode_image(text_of(data, size), kMostFuzzedTexels);
  } catch (const BadImage& bad) {
    require_one_line(bad.expected + bad.found);
    return 0;
  }
  if (image.texels.empty() || image.texels.size() != std::size_t{image.width} * image.height) std::abort();
  if (image.texels.size() < 4096 && decode_image(encode_png(image)).texels != image.texels) std::abort();
  return 0;
}
