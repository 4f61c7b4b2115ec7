// beampipe make: makes a trace from a procedural scene or from the user's own model.

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "tools/cli/commands.h"
#include "tools/cli/model_trace.h"
#include "tools/cli/trace_view.h"
#include "tools/files/format.h"
#include "tools/files/output.h"
#include "tools/report/report_text.h"
#include "traces/closed_mesh.h"
#include "traces/closest_name.h"
#include "traces/files/atomic_file.h"
#include "traces/files/model_import.h"
#include "traces/files/trace_io.h"
#include "traces/scenes.h"
#include "traces/size_text.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kMaxSide = 16384;  // as in a trace

struct MakeArguments {
  std::string scene, output;
  SceneOptions options;
  std::uint32_t frames = 1;
  double orbit = 0;
  std::vector<double> pan;
  bool list = false, binary = false;
  ModelOptions model;
  std::string cull;
};

bool hides_backs(const Mesh& mesh, const std::vector<Material>& materials) {
  const auto is_opaque = [&](std::uint32_t material) {
    return material == kNoMaterial || materials.at(material).alpha_mode == AlphaMode::opaque;
  };
  return std::ranges::all_of(mesh.materials, is_opaque) && is_closed_body(mesh);
}

// Of all draws, whose culling nothing else decides.
void set_culling(const std::string& cull, Trace& trace) {
  for (Frame& frame : trace.frames)
    for (Draw& draw : frame.draws) {
      const bool culls = cull == "back" || (cull == "closed" && hides_backs(trace.meshes[draw.mesh], trace.materials));
      draw.cull = culls ? Cull::back : Cull::none;
    }
}

Trace make_from_scene(const MakeArguments& arguments, const Command& command) {
  require_no_model_options(command);
  const std::vector<SceneKind>& kinds = scene_kinds();
  if (std::none_of(kinds.begin(), kinds.end(), [&](const SceneKind& kind) { return kind.name == arguments.scene; })) {
    std::vector<std::string> names;
    for (const SceneKind& kind : kinds) names.emplace_back(kind.name);
    throw UsageError("there is no scene named " + arguments.scene + did_you_mean(arguments.scene, names) +
                     " (see beampipe make --list), and it is not an .obj, .gltf or .glb file");
  }
  Trace trace = make_scene(arguments.scene, arguments.options);
  apply({.camera = arguments.model.camera}, {0}, arguments.scene, trace);
  return trace;
}

void list_scenes() {
  std::vector<std::vector<std::string>> rows;
  for (const SceneKind& kind : scene_kinds())
    rows.push_back({std::string(kind.name), std::string(kind.description) + (kind.is_held_out ? " (held out)" : "")});
  std::cout << align_columns(rows, {0, 1});
}

void make(const MakeArguments& arguments, const Command& command, InterruptGate& gate) {
  if (arguments.list) return list_scenes();
  if (arguments.scene.empty()) throw UsageError("make needs a SCENE or a model (see beampipe make --help)");
  if (arguments.output.empty()) throw UsageError("make needs -o FILE");
  const bool is_model = is_model_file(arguments.scene);
  if (is_model && (command.was_given("--triangles") || command.was_given("--seed"))) {
    throw UsageError("--triangles and --seed are for procedural scenes only");
  }
  if (is_model) require_options_of(arguments.scene, command);
  if (is_model && command.was_given("--cull") && !is_obj_file(arguments.scene))
    throw UsageError("--cull is for scenes and .obj files only: the materials of a glTF model say it");
  const std::filesystem::path file = arguments.output;
  if (std::error_code none; is_model && std::filesystem::equivalent(file, arguments.scene, none))
    throw UsageError("-o " + arguments.output + " is the model itself");
  require_writable_folder(file.has_parent_path() ? file.parent_path() : ".");
  if (command.was_given("--orbit") && arguments.frames < 2) throw UsageError("--orbit needs --frames N with N > 1");
  if (command.was_given("--pan") && arguments.frames < 2) throw UsageError("--pan needs --frames N with N > 1");
  const bool moves = command.was_given("--orbit") || command.was_given("--pan");
  Trace trace = is_model ? trace_of_model(arguments.scene, arguments.model, command,
                                          {.width = arguments.options.width,
                                           .height = arguments.options.height,
                                           .count = arguments.frames,
                                           .move = moves})
                         : make_from_scene(arguments, command);
  if (command.was_given("--cull")) set_culling(arguments.cull, trace);
  const std::optional<Camera> camera = trace.frames.at(0).camera;
  if (!arguments.pan.empty()) {
    pan_picture(trace, arguments.frames, arguments.pan.at(0), arguments.pan.at(1));
  } else if (arguments.frames > 1 && trace.frames.size() == 1) {  // otherwise the model itself moves
    if (!trace.frames[0].camera) throw UsageError("--orbit needs a perspective camera; give --eye or --fovy for one");
    orbit_camera(trace, arguments.frames, arguments.orbit);
  }
  std::size_t triangles = 0;
  for (const Mesh& mesh : trace.meshes) triangles += mesh.triangles.size();
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  {
    const auto held = gate.hold();
    gate.set_unfinished({AtomicFile::temporary_of(file), AtomicFile::temporary_of(arrays_file_of(file))});
  }
  write_trace(trace, file, arguments.binary ? ArrayStorage::binary : ArrayStorage::text);
  std::cout << arguments.output << ": " << with_noun(triangles, "triangle") << ", "
            << size_text(arguments.options.width, arguments.options.height) << " pixels\n";
  if (is_model && camera) std::cout << "camera: " << text_of(*camera, arguments.model, command) << "\n";
}

}  // namespace

void add_make_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<MakeArguments>();
  Command command = line.add_command("make", "Make a trace from a procedural scene, or from your own model");
  command.add("SCENE", arguments->scene,
              "the name of a procedural scene (see --list), or a model: MODEL.obj, MODEL.gltf or MODEL.glb");
  command.add("-o,--output", arguments->output, "the trace to write, a JSON file");
  command.add_flag("--list", arguments->list, "list the procedural scenes");
  command.add_flag("--binary", arguments->binary,
                   "write the arrays to a binary file beside the trace, which is smaller and faster to read");
  command.add("--width", arguments->options.width, "width of the picture in pixels")
      .between(1, kMaxSide)
      .shows_default();
  command.add("--height", arguments->options.height, "height of the picture in pixels")
      .between(1, kMaxSide)
      .shows_default();
  command
      .add(
          "--frames", arguments->frames,
          "the number of frames (default: 1); several frames play a glTF model's animation, unless --orbit or --pan is "
          "given")
      .between(1, 100000);
  const Option orbit = command.add("--orbit", arguments->orbit,
                                   "turn the camera around its target by N degrees over all frames (default: 0)");
  const Option pan = command
                         .add("--pan", arguments->pan,
                              "move the picture by X pixels to the right and Y down from each frame to the next")
                         .exactly(2, "X,Y")
                         .excludes(orbit);

  command
      .add("--cull", arguments->cull,
           "which back faces are not drawn: none, those of closed opaque meshes, for a camera outside of them, or all "
           "(back) (default: closed for scenes, none for an .obj)")
      .one_of({"none", "closed", "back"});

  Command scene = command.add_group("Procedural scenes");
  scene
      .add("--triangles", arguments->options.triangles,
           "the approximate number of triangles (default: the scene's own)")
      .between(1, 100000000);
  scene
      .add("--seed", arguments->options.seed,
           "the seed of the scene's random numbers; the same seed makes the same scene")
      .shows_default();

  Command model = command.add_group("Models; --camera is for scenes too");
  add_model_options(model, arguments->model).excludes(orbit).excludes(pan);
  command.footer(
      "Examples:\n  beampipe make hairball --triangles 100000 --seed 7 -o hairball.json\n"
      "  beampipe make model.obj -o model.json\n  beampipe make model.obj --eye 3,2,5 --fovy 45 --unlit -o model.json\n"
      "  beampipe make model.glb --frames 60 -o model.json\n  beampipe make room.obj --view inside -o room.json");
  command.set_work([arguments, command, &gate] { make(*arguments, command, gate); });
}

}  // namespace beampipe
