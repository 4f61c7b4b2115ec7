// Reads any bytes as an EXR file. They give an error of one line, or a picture that can be compared with itself.
#include "tests/fuzz/fuzz_input.h"
#include "tools/evaluate/metrics.h"
#include "tools/files/image_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  static const FuzzFolder folder;
  const std::filesystem::path file = folder.write("a.exr", text_of(data, size));
  try {
    const Image image = read_exr(file);
    if (image.rgba.size() != std::size_t{4} * image.width * image.height) std::abort();
    if (image.width > 256 || image.height > 256) return 0;  // because sorting the errors takes time
    if (measure_error(image, image).max != 0) std::abort();
  } catch (const ImageError&) {
  } catch (const std::runtime_error& error) {  // a value that is not finite
    require_one_line(error.what());
  }
  return 0;
}
