// beampipe preview: a small picture of a trace or a model, quickly.

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/cli/model_trace.h"
#include "tools/cli/trace_notes.h"
#include "tools/cli/trace_view.h"
#include "tools/evaluate/machine_memory.h"
#include "tools/files/image_io.h"
#include "tools/files/output.h"
#include "traces/files/model_import.h"
#include "traces/files/trace_io.h"
#include "traces/size_text.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kLongerSide = 480, kShorterSide = 270;  // pixels
constexpr const char* kTechnique = "beam";

struct PreviewArguments {
  std::string scene, output = "preview.png";
  std::uint32_t width = 0, height = 0;
  std::size_t frame = 0;
  ModelOptions model;
  bool allow_outside = false;
};

Trace read_model(const PreviewArguments& arguments, const Command& command) {
  require_options_of(arguments.scene, command);
  if (command.was_given("--frame")) throw UsageError("--frame is for traces only");
  return trace_of_model(arguments.scene, arguments.model, command,
                        {.width = arguments.width > 0 ? arguments.width : kLongerSide,
                         .height = arguments.height > 0 ? arguments.height : kShorterSide});
}

// A captured frame keeps its size; others are made small unless the user chooses.
Trace read_small_trace(const PreviewArguments& arguments, const Command& command) {
  require_no_model_options(command);
  Trace trace = read_trace(arguments.scene, {.allow_outside = arguments.allow_outside});
  if (arguments.frame >= trace.frames.size())
    throw UsageError("--frame: expected 0 to " + std::to_string(trace.frames.size() - 1) + ", found " +
                     std::to_string(arguments.frame));
  const Frame& frame = trace.frames[arguments.frame];
  TraceView view{arguments.model.camera, arguments.width, arguments.height};
  if (view.width == 0 && view.height == 0 && frame.camera)
    (frame.width >= frame.height ? view.width : view.height) =
        std::min(kLongerSide, std::max(frame.width, frame.height));
  apply(view, {arguments.frame}, arguments.scene, trace);
  return trace;
}

void preview(const PreviewArguments& arguments, const Command& command, InterruptGate& gate) {
  const std::filesystem::path file = std::filesystem::absolute(arguments.output);
  if (file.extension() != ".png") throw UsageError("-o " + arguments.output + ": expected a name that ends in .png");
  require_writable_file(file);
  const bool is_model = is_model_file(arguments.scene);
  const Trace trace = is_model ? read_model(arguments, command) : read_small_trace(arguments, command);
  const Frame& frame = trace.frames.at(arguments.frame);
  const Technique technique = parse_technique(kTechnique);
  require_memory(trace, frame, technique.working_bytes_per_pixel, "the preview", machine_memory());
  if (const std::string note = note_on_darkness(trace, {arguments.frame}, arguments.scene); !note.empty())
    std::cerr << "beampipe: " << note << "\n";
  const TextureSet textures(trace, arguments.scene);
  FrameInput options;
  options.memory.modelled = false;
  options.memory_limit = machine_memory() / 2;
  options.textures = &textures;
  OutputFolder output(file.parent_path(), gate);
  output.write(file.filename(), encode_png(technique.render(trace, arguments.frame, options).image));
  output.keep();
  std::cout << arguments.output << ": " << size_text(frame.width, frame.height) << " pixels\n";
  if (frame.camera) std::cout << "camera: " << text_of(*frame.camera, arguments.model, command) << "\n";
}

}  // namespace

void add_preview_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<PreviewArguments>();
  Command command = line.add_command("preview", "Draw a small picture of a model or a trace, to see what is in view");
  command
      .add("FILE", arguments->scene,
           "a trace, or a model: MODEL.obj, MODEL.gltf or MODEL.glb, which is shown as `make` would show it")
      .required();
  command.add("-o,--output", arguments->output, "the picture, a PNG file").shows_default();
  command.add("--width", arguments->width, "width of the picture in pixels (default: 480, or in a trace's proportion)")
      .between(1, 16384);
  command.add("--height", arguments->height, "height of the picture in pixels (default: 270, or likewise)")
      .between(1, 16384);
  command.add("--frame", arguments->frame, "the frame of a trace; the first one is 0 (default: 0)");
  command.add_flag("--allow-outside", arguments->allow_outside, "allow a trace to name files outside its own folder");
  Command model = command.add_group("Models, as in `make`; --camera is for traces too");
  add_model_options(model, arguments->model);
  command.footer(
      "The technique is beam. A trace that was captured keeps its size.\n\nExamples:\n"
      "  beampipe preview model.obj\n  beampipe preview model.obj --eye 3,2,5 -o model.png\n"
      "  beampipe preview model.json --width 200");
  command.set_work([arguments, command, &gate] { preview(*arguments, command, gate); });
}

}  // namespace beampipe
