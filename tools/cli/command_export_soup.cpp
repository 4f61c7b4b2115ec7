// beampipe export-soup: writes a frame's triangles in a form that other renderers can draw.

#include <bit>
#include <cstring>
#include <memory>
#include <string>

#include "stages/geometry/vertex_setup.h"
#include "stages/picture/shade.h"
#include "tools/cli/commands.h"
#include "tools/evaluate/machine_memory.h"
#include "tools/files/output.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

struct ExportArguments {
  std::string trace, output;
  std::size_t frame = 0;
  bool allow_outside = false;
};

template <class Value>
void append(std::string& bytes, const Value& value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof raw);
}

// The bytes of the file: "SOUP"; uint32 version 1, width, height, triangles; float background[3]; and for each triangle
// float clip[3][4] (OpenGL clip space with w = 1, already projected and snapped) and float rgb[3] (linear, lit).
std::string soup_of(const Trace& trace, const Frame& frame) {
  StageCounters counters;
  const SetupTriangles setup = vertex_setup(trace, frame, counters);
  const std::vector<glm::vec3> colors = shade_triangles(setup, frame.lighting);
  std::string bytes = "SOUP";
  for (const std::size_t number : {std::size_t{1}, std::size_t{frame.width}, std::size_t{frame.height}, colors.size()})
    append(bytes, static_cast<std::uint32_t>(number));
  append(bytes, frame.background);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const SetupTriangle& triangle = setup.triangles[i];
    for (int k = 0; k < 3; ++k) {
      append(bytes, static_cast<float>(triangle.x[k] / (128.0 * frame.width) - 1));
      append(bytes, static_cast<float>(1 - triangle.y[k] / (128.0 * frame.height)));
      append(bytes, 2 * triangle.vertex_z[k] + 1);
      append(bytes, 1.0f);
    }
    append(bytes, colors[i]);
  }
  return bytes;
}

}  // namespace

void add_export_soup_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<ExportArguments>();
  Command command = line.add_command("export-soup",
                                     "Write a frame's triangles for other renderers: clipped, culled, snapped and lit");
  command.add("TRACE", arguments->trace, "the trace, a JSON file").required();
  command.add("-o,--output", arguments->output, "the file to write").required();
  command.add("--frame", arguments->frame, "the frame; the first one is 0 (default: 0)");
  command.add_flag("--allow-outside", arguments->allow_outside, "allow the trace to name files outside its own folder");
  command.footer(
      "For other rasterizers, to draw exactly these triangles. The file is little-endian: \"SOUP\"; uint32 version 1,\n"
      "width, height, triangles; float background[3]; then for each triangle float clip[3][4], in OpenGL clip space "
      "with\n"
      "w = 1, and float rgb[3], linear.");
  command.set_work([arguments, &gate] {
    const std::filesystem::path file = std::filesystem::absolute(arguments->output);
    if (std::error_code none; std::filesystem::equivalent(file, arguments->trace, none))
      throw UsageError("-o " + arguments->output + " is the trace itself");
    require_writable_file(file);
    const Trace trace = read_trace(arguments->trace, {.allow_outside = arguments->allow_outside});
    if (arguments->frame >= trace.frames.size())
      throw UsageError("--frame: expected 0 to " + std::to_string(trace.frames.size() - 1) + ", found " +
                       std::to_string(arguments->frame));
    const Frame& frame = trace.frames[arguments->frame];
    require_memory(trace, frame, 0, "frame " + std::to_string(arguments->frame), machine_memory());
    OutputFolder output(file.parent_path(), gate);
    output.write(file.filename(), soup_of(trace, frame));
    output.keep();
  });
}

}  // namespace beampipe
