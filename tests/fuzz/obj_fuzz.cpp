// Reads any bytes as an OBJ file and, after the first NUL, its material library, which may name the image t.png. They
// give an error of one line, or a mesh of finite numbers whose parts fit together.
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/trace_parts.h"
#include "tests/traces/test_images.h"
#include "traces/files/model_import.h"
#include "traces/files/trace_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  static const FuzzFolder folder;
  const std::vector<std::string_view> parts = parts_of(text_of(data, size), 2);
  folder.write("t.png", kColors);
  folder.write("m.mtl", parts[1]);
  const std::filesystem::path file = folder.write("mesh.obj", parts[0]);
  for (ObjMaterials materials : {ObjMaterials::none, ObjMaterials::textured, ObjMaterials::all}) {
    try {
      Trace trace;
      NotRead not_read;
      read_obj(file, {.materials = materials}, trace, not_read);
      require_sound(trace);
    } catch (const TraceError& error) {
      require_one_line(error.what());
    }
  }
  return 0;
}
