// Parses any words as specs of techniques. Each gives an error of one line, or a technique with a framebuffer.
#include "pipeline/technique.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  for (std::string_view rest = text_of(data, size); !rest.empty();) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    try {
      const Technique technique = parse_technique(rest.substr(0, end));
      if (technique.framebuffer_bytes_per_pixel() == 0 || !technique.renderer) std::abort();
    } catch (const SpecError& error) {
      require_one_line(error.what());
    }
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return 0;
}
