// beampipe make: makes a trace from a procedural scene or from the user's own model.

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/cli/framing.h"
#include "tools/files/output.h"
#include "tools/report/report_text.h"
#include "traces/atomic_file.h"
#include "traces/model_import.h"
#include "traces/scenes.h"
#include "traces/trace_io.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kMaxSide = 16384;  // as in a trace
constexpr glm::vec3 kSky{0.35f}, kGround{0.15f};

struct MakeArguments {
  std::string scene, output;
  SceneOptions options;
  std::uint32_t frames = 1;
  double orbit = 0;
  std::vector<double> pan;
  bool list = false, binary = false;
  // For models only.
  std::vector<double> eye, target, up, background;
  double fovy = 0, near = 0, far = 0;
  bool unlit = false, lambert = false;
  std::string materials = "textured", animation;
};

glm::dvec3 vector_of(const std::vector<double>& values) { return {values.at(0), values.at(1), values.at(2)}; }

CameraWishes wishes_of(const MakeArguments& arguments, const Command& command) {
  CameraWishes wishes;
  if (!arguments.eye.empty()) wishes.eye = vector_of(arguments.eye);
  if (!arguments.target.empty()) wishes.target = vector_of(arguments.target);
  if (!arguments.up.empty()) wishes.up = vector_of(arguments.up);
  if (command.was_given("--fovy")) wishes.fovy_deg = arguments.fovy;
  if (command.was_given("--near")) wishes.near = arguments.near;
  if (command.was_given("--far")) wishes.far = arguments.far;
  return wishes;
}

// Names on standard error, once, what the model has and the trace has not.
void say_not_read(const std::string& model, const NotRead& not_read) {
  std::string list;
  for (const auto& [name, count] : not_read)
    list += (list.empty() ? "" : ", ") + name + (count > 1 ? " (" + std::to_string(count) + ")" : "");
  if (!list.empty()) std::cerr << "beampipe: " << model << ": not read: " << list << "\n";
}

ImportedModel read_obj_model(const MakeArguments& arguments) {
  const ObjMaterials materials = arguments.materials == "all"        ? ObjMaterials::all
                                 : arguments.materials == "textured" ? ObjMaterials::textured
                                                                     : ObjMaterials::none;
  ImportedModel model;
  read_obj(arguments.scene, "", materials, model.trace, model.not_read);
  Frame& frame = model.trace.frames.emplace_back();
  frame.width = arguments.options.width;
  frame.height = arguments.options.height;
  frame.draws.emplace_back().shading = Shading::lambert;
  return model;
}

ImportedModel read_gltf_model(const MakeArguments& arguments, const Command& command) {
  const bool moves_otherwise = command.was_given("--orbit") || command.was_given("--pan");
  GltfOptions options;
  options.width = arguments.options.width;
  options.height = arguments.options.height;
  options.frames = arguments.frames;
  options.animation = arguments.animation;
  options.animation_if_any = arguments.frames > 1 && !moves_otherwise;
  return read_gltf(arguments.scene, options);
}

// Lights a model that has no lights: with a light over the shoulder of the first frame's camera, and from all around,
// so that no real material is black.
void add_light(Trace& trace) {
  const Frame& first = trace.frames[0];
  Light light;
  if (first.camera) {
    light.direction = shoulder_light(*first.camera);
  } else {  // an orthographic camera
    light.direction = glm::normalize(glm::vec3(glm::inverse(first.view) * glm::dvec4(0.4, -0.7, -1.0, 0.0)));
  }
  for (Frame& frame : trace.frames) {
    if (frame.lighting.lights.empty()) frame.lighting.lights.push_back(light);
    if (!trace.materials.empty()) frame.lighting.ambient = {.sky = kSky, .ground = kGround};
  }
}

Trace make_from_model(const MakeArguments& arguments, const Command& command) {
  ImportedModel model = is_obj_file(arguments.scene) ? read_obj_model(arguments) : read_gltf_model(arguments, command);
  say_not_read(arguments.scene, model.not_read);
  Trace& trace = model.trace;
  const std::vector<const char*> view = {"--eye", "--target", "--up", "--fovy", "--near", "--far"};
  const bool has_wishes =
      std::any_of(view.begin(), view.end(), [&](const char* option) { return command.was_given(option); });
  if (!model.has_camera || has_wishes) {
    try {
      const Camera camera =
          frame_model(trace, arguments.options.width, arguments.options.height, wishes_of(arguments, command));
      for (Frame& frame : trace.frames) set_camera(frame, camera);
    } catch (const std::invalid_argument& error) {
      throw UsageError(arguments.scene + ": " + error.what());
    }
  }
  const glm::vec3 background =
      arguments.background.empty() ? glm::vec3(1.0f) : glm::vec3(vector_of(arguments.background));
  if (glm::clamp(background, 0.0f, kMostColor) != background)
    throw UsageError("--background: expected numbers from 0 to 65504");
  for (Frame& frame : trace.frames) frame.background = background;
  if (arguments.unlit) {
    for (Frame& frame : trace.frames) {
      frame.lighting = {};
      for (Draw& draw : frame.draws) draw.shading = Shading::unlit;
    }
    for (Material& material : trace.materials) material.unlit = true;
  } else {
    add_light(trace);
  }
  return std::move(trace);
}

Trace make_from_scene(const MakeArguments& arguments, const Command& command) {
  for (const char* option : {"--eye", "--target", "--up", "--fovy", "--near", "--far", "--background", "--lambert",
                             "--unlit", "--materials", "--animation"}) {
    if (command.was_given(option)) throw UsageError(std::string(option) + " is for models (.obj, .gltf, .glb) only");
  }
  const std::vector<SceneKind>& kinds = scene_kinds();
  if (std::none_of(kinds.begin(), kinds.end(), [&](const SceneKind& kind) { return kind.name == arguments.scene; })) {
    throw UsageError("there is no scene named " + arguments.scene +
                     " (see beampipe make --list), and it is not an .obj, .gltf or .glb file");
  }
  return make_scene(arguments.scene, arguments.options);
}

void list_scenes() {
  std::vector<std::vector<std::string>> rows;
  for (const SceneKind& kind : scene_kinds()) rows.push_back({std::string(kind.name), std::string(kind.description)});
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
  if (is_model && command.was_given("--materials") && !is_obj_file(arguments.scene))
    throw UsageError("--materials is for .obj files only");
  if (is_model && command.was_given("--animation") && is_obj_file(arguments.scene))
    throw UsageError("--animation is for .gltf and .glb files only");
  const std::filesystem::path file = arguments.output;
  if (std::error_code none; is_model && std::filesystem::equivalent(file, arguments.scene, none))
    throw UsageError("-o " + arguments.output + " is the model itself");
  require_writable_folder(file.has_parent_path() ? file.parent_path() : ".");
  if (command.was_given("--orbit") && arguments.frames < 2) throw UsageError("--orbit needs --frames N with N > 1");
  if (command.was_given("--pan") && arguments.frames < 2) throw UsageError("--pan needs --frames N with N > 1");
  Trace trace = is_model ? make_from_model(arguments, command) : make_from_scene(arguments, command);
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
    gate.set_unfinished(AtomicFile::temporary_of(file));
  }
  write_trace(trace, file, arguments.binary ? ArrayStorage::binary : ArrayStorage::text);
  std::cout << arguments.output << ": " << triangles << " triangles, " << arguments.options.width << " x "
            << arguments.options.height << " pixels\n";
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
      .add("--frames", arguments->frames,
           "the number of frames (default: 1); more than one show a glTF model's animation, unless --orbit or --pan is "
           "given")
      .between(1, 100000);
  const Option orbit =
      command.add("--orbit", arguments->orbit,
                  "move the camera around its target by so many degrees, over all frames together (default: 0)");
  const Option pan = command
                         .add("--pan", arguments->pan,
                              "move the picture by so many pixels, right and down, from each frame to the next")
                         .exactly(2, "X,Y")
                         .excludes(orbit);

  Command scene = command.add_group("Procedural scenes");
  scene
      .add("--triangles", arguments->options.triangles,
           "the approximate number of triangles (default: the scene's own)")
      .between(1, 100000000);
  scene
      .add("--seed", arguments->options.seed,
           "the seed of the scene's random numbers; the same seed makes the same scene")
      .shows_default();

  Command model = command.add_group("Models");
  model.add("--eye", arguments->eye, "the position of the camera (default: far enough away to see the whole model)")
      .exactly(3, "X,Y,Z");
  model.add("--target", arguments->target, "the point that the camera looks at (default: the middle of the model)")
      .exactly(3, "X,Y,Z");
  model.add("--up", arguments->up, "the direction that is up (default: 0,1,0)").exactly(3, "X,Y,Z");
  model.add("--fovy", arguments->fovy, "the full vertical angle of view in degrees (default: 36)");
  model.add("--near", arguments->near, "the distance of the near plane (default: just in front of the model)");
  model.add("--far", arguments->far, "the distance of the far plane (default: just behind the model)");
  model.add("--background", arguments->background, "the colour of the background, linear (default: 1,1,1)")
      .exactly(3, "R,G,B");
  const Option lambert = model.add_flag("--lambert", arguments->lambert,
                                        "shade the model with a light over the camera's shoulder (the default)");
  model.add_flag("--unlit", arguments->unlit, "draw the plain colours of the materials").excludes(lambert);
  model
      .add("--materials", arguments->materials,
           "of an .obj: which triangles are shaded as real materials, with normals and textures, instead of in the "
           "colour Kd: all, those that have textures, or none")
      .one_of({"all", "textured", "none"})
      .shows_default();
  model
      .add("--animation", arguments->animation,
           "of a glTF model: the name of the animation to show, or its number from 0 (default: 0)")
      .excludes(orbit)
      .excludes(pan);
  command.footer(
      "Examples:\n  beampipe make hairball --triangles 100000 --seed 7 -o hairball.json\n"
      "  beampipe make model.obj -o model.json\n  beampipe make model.obj --eye 3,2,5 --fovy 45 --unlit -o model.json\n"
      "  beampipe make model.glb --frames 60 -o model.json");
  command.set_work([arguments, command, &gate] { make(*arguments, command, gate); });
}

}  // namespace beampipe
