// Reads any bytes as a glTF file, in text or binary, at rest and animated. They give an error of one line, or a trace
// of finite numbers whose parts fit together.
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/trace_parts.h"
#include "traces/files/model_import.h"
#include "traces/files/trace_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  static const FuzzFolder folder;
  const std::filesystem::path file = folder.write("model.gltf", text_of(data, size));
  for (std::uint32_t frames : {1u, 3u}) {
    try {
      require_sound(read_gltf(file, {.frames = frames, .animation_if_any = frames > 1}).trace);
    } catch (const TraceError& error) {
      require_one_line(error.what());
    }
  }
  return 0;
}
