// Reads any bytes as an OBJ file and, after the first NUL, its material library. They give an error of one line, or a
// mesh of finite numbers whose parts fit together.
#include <cmath>

#include "tests/fuzz/fuzz_input.h"
#include "traces/trace_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  static const FuzzFolder folder;
  const std::string_view text = text_of(data, size);
  const std::size_t end = std::min(text.find('\0'), text.size());
  folder.write("m.mtl", end < text.size() ? text.substr(end + 1) : "");
  const std::filesystem::path file = folder.write("mesh.obj", text.substr(0, end));
  try {
    const Mesh mesh = read_obj(file, "");
    if (mesh.colors.size() != mesh.triangles.size()) std::abort();
    for (const auto& vectors : {mesh.positions, mesh.colors})
      for (const glm::vec3& v : vectors)
        for (int i = 0; i < 3; ++i)
          if (!std::isfinite(v[i])) std::abort();
    for (const glm::uvec3& t : mesh.triangles)
      for (int i = 0; i < 3; ++i)
        if (t[i] >= mesh.positions.size()) std::abort();
  } catch (const TraceError& error) {
    require_one_line(error.what());
  }
  return 0;
}
