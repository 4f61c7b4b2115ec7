#include "tools/cli/model_trace.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <iterator>
#include <optional>

#include "tools/cli/camera_file.h"
#include "tools/cli/framing.h"
#include "tools/cli/viewpoint.h"
#include "traces/files/model_import.h"

namespace beampipe {
namespace {

constexpr float kSky = 0.35f;             // of white light over the shoulder
constexpr float kGround = 0.15f / 0.35f;  // of what the sky gives
constexpr const char* kViewOptions[] = {"--view", "--eye", "--target", "--up", "--fovy", "--near", "--far"};
constexpr const char* kOtherOptions[] = {"--light",     "--ambient",   "--background",  "--unlit",
                                         "--materials", "--animation", "--follow-links"};

glm::dvec3 vector_of(const std::vector<double>& values) { return {values.at(0), values.at(1), values.at(2)}; }

CameraWishes wishes_of(const ModelOptions& options, const Command& command) {
  CameraWishes wishes = options.camera.empty() ? CameraWishes{} : read_camera_file(options.camera);
  if (!options.eye.empty()) wishes.eye = vector_of(options.eye);
  if (!options.target.empty()) wishes.target = vector_of(options.target);
  if (!options.up.empty()) wishes.up = vector_of(options.up);
  if (command.was_given("--fovy")) wishes.fovy_deg = options.fovy;
  if (command.was_given("--near")) wishes.near = options.near;
  if (command.was_given("--far")) wishes.far = options.far;
  return wishes;
}

// Names on standard error, once, what the model has and the trace has not.
void say_not_read(const std::string& model, const NotRead& not_read) {
  std::string list;
  for (const auto& [name, count] : not_read)
    list += (list.empty() ? "" : ", ") + name + (count > 1 ? " (" + std::to_string(count) + ")" : "");
  if (!list.empty()) std::cerr << "beampipe: " << model << ": not read: " << list << "\n";
}

// `lit`: the light was chosen for it.
void say_standpoint(const std::string& model, Standpoint standpoint, bool lit) {
  if (standpoint == Standpoint::outside) return;
  const bool is_inside = standpoint == Standpoint::inside;
  std::cerr << "beampipe: note: " << model
            << ": its faces show their backs outside, as the walls of a room do, so the camera "
            << (is_inside ? "stands inside" : "looks in through an open side") << (lit ? ", with --ambient 0.35" : "")
            << "; move it with --eye and --target, or with --view " << (is_inside ? "outside" : "inside") << "\n";
}

// Where the user has put the eye inside, only the light over the shoulder reaches.
void say_dark(const std::string& model, const Trace& trace, const Viewpoint& viewpoint) {
  const Bounds bounds = shown_bounds(trace);
  const glm::dvec3& eye = viewpoint.camera.eye;
  const bool is_in = glm::all(glm::greaterThan(eye, bounds.low)) && glm::all(glm::lessThan(eye, bounds.high));
  if (is_in && viewpoint.standpoint == Standpoint::outside && trace.materials.empty() &&
      trace.frames[0].lighting.lights.empty())
    std::cerr << "beampipe: note: " << model
              << ": the eye is among the model's surfaces, and those turned away from the light are black; --ambient "
                 "0.35 lights them, as with --view inside\n";
}

ImportedModel read_obj_model(const std::string& file, const ModelOptions& options, std::uint32_t width,
                             std::uint32_t height) {
  const ObjMaterials materials = options.materials == "all"        ? ObjMaterials::all
                                 : options.materials == "textured" ? ObjMaterials::textured
                                                                   : ObjMaterials::none;
  ImportedModel model;
  read_obj(file, {.materials = materials, .follow_links = options.follow_links}, model.trace, model.not_read);
  Frame& frame = model.trace.frames.emplace_back();
  frame.width = width;
  frame.height = height;
  frame.draws.emplace_back().shading = Shading::lambert;
  return model;
}

Viewpoint viewpoint_of(const Trace& trace, const ModelOptions& options, const Command& command) {
  const CameraWishes wishes = wishes_of(options, command);
  const std::uint32_t width = trace.frames.at(0).width, height = trace.frames[0].height;
  if (wishes.eye) return {Standpoint::outside, frame_model(trace, width, height, wishes)};
  std::optional<Standpoint> asked;
  if (options.view == "outside") asked = Standpoint::outside;
  if (options.view == "inside") asked = Standpoint::inside;
  return choose_viewpoint(trace, width, height, wishes, asked);
}

// Where the user says; else over the shoulder of the first frame's camera.
glm::vec3 light_direction(const Trace& trace, const ModelOptions& options) {
  const Frame& first = trace.frames[0];
  if (!options.light.empty()) {
    const double length = glm::length(vector_of(options.light));
    if (!(length > 0 && std::isfinite(length))) throw UsageError("--light: expected a vector with a length");
    return vector_of(options.light) / length;
  }
  if (first.camera) return shoulder_light(*first.camera);
  // An orthographic camera.
  return glm::normalize(glm::vec3(glm::inverse(first.view) * glm::dvec4(0.4, -0.7, -1.0, 0.0)));
}

// Lights a model that has no lights or is to have another one. Without light from all around, real materials are black
// where the light does not reach, and so are half the walls of a room. There, and where the user asks for it, it is a
// part of all light, so that white walls are not too bright to show anything.
void add_light(Trace& trace, const ModelOptions& options, const Command& command, const Viewpoint& viewpoint) {
  const bool is_part = command.was_given("--ambient") || viewpoint.standpoint != Standpoint::outside;
  const float sky = command.was_given("--ambient")        ? static_cast<float>(options.ambient)
                    : is_part || !trace.materials.empty() ? kSky
                                                          : 0.0f;
  if (!(sky >= 0 && sky <= 1)) throw UsageError("--ambient: expected a number from 0 to 1");
  const Light light{.direction = light_direction(trace, options), .color = glm::vec3(is_part ? 1.0f - sky : 1.0f)};
  for (Frame& frame : trace.frames) {
    if (frame.lighting.lights.empty() || !options.light.empty()) frame.lighting.lights = {light};
    if (sky > 0)
      frame.lighting.ambient = {
          .sky = glm::vec3(sky), .ground = glm::vec3(sky * kGround), .up = glm::normalize(viewpoint.camera.up)};
  }
}

void remove_light(Trace& trace) {
  for (Frame& frame : trace.frames) {
    frame.lighting = {};
    for (Draw& draw : frame.draws) draw.shading = Shading::unlit;
  }
  for (Material& material : trace.materials) material.unlit = true;
}

// As many digits as tell the number from all others.
std::string text_of(double number) {
  char digits[32];
  return {digits, std::to_chars(digits, std::end(digits), number).ptr};
}

std::string text_of(const glm::dvec3& v) { return text_of(v.x) + "," + text_of(v.y) + "," + text_of(v.z); }

}  // namespace

Option add_model_options(Command& command, ModelOptions& options) {
  const Option view =
      command
          .add("--view", options.view,
               "where the camera stands: outside, so that all of the model is seen, or inside, as in a room (default: "
               "outside, unless its walls show their backs there)")
          .one_of({"outside", "inside"});
  command.add("--camera", options.camera, kCameraHelp).excludes(view);
  command
      .add("--eye", options.eye,
           "the position of the camera, in place of the one in the file of --camera, like the options that follow "
           "(default: chosen as --view says)")
      .exactly(3, "X,Y,Z")
      .excludes(view);
  command.add("--target", options.target, "the point that the camera looks at (default: the middle of the model)")
      .exactly(3, "X,Y,Z");
  command.add("--up", options.up, "the direction that is up (default: 0,1,0)").exactly(3, "X,Y,Z");
  command.add("--fovy", options.fovy,
              "the full vertical angle of view in degrees (default: 36; inside, 75 across the longer side)");
  command.add("--near", options.near, "the distance of the near plane (default: just in front of the model)");
  command.add("--far", options.far, "the distance of the far plane (default: just behind the model)");
  command.add("--background", options.background, "the colour of the background, linear (default: 1,1,1)")
      .exactly(3, "R,G,B");
  const Option light = command
                           .add("--light", options.light,
                                "the direction in which the light travels, in place of the model's own lights "
                                "(default: over the camera's left shoulder)")
                           .exactly(3, "X,Y,Z");
  const Option ambient =
      command.add("--ambient", options.ambient,
                  "the part of the light that comes from all around, 0 to 1; half of it or less from below "
                  "(default: 0.35 where the camera chose to stand inside, else 0; beside real "
                  "materials' full light, 0.35)");
  command.add_flag("--unlit", options.unlit, "draw the plain colours of the materials")
      .excludes(light)
      .excludes(ambient);
  command
      .add("--materials", options.materials,
           "of an .obj: which triangles are shaded as real materials, with normals and textures, instead of in the "
           "colour Kd: all, those that have textures, or none")
      .one_of({"all", "textured", "none"})
      .shows_default();
  command.add_flag("--follow-links", options.follow_links,
                   "follow symbolic links from the model's files to files outside its folder");
  return command.add("--animation", options.animation,
                     "of a glTF model: the name of the animation to show, or its number from 0 (default: 0)");
}

void require_no_model_options(const Command& command) {
  const auto require_none = [&command](const auto& names) {
    for (const char* option : names)
      if (command.was_given(option)) throw UsageError(std::string(option) + " is for models (.obj, .gltf, .glb) only");
  };
  require_none(kViewOptions);
  require_none(kOtherOptions);
}

void require_options_of(const std::string& model, const Command& command) {
  if (command.was_given("--materials") && !is_obj_file(model)) throw UsageError("--materials is for .obj files only");
  if (command.was_given("--animation") && is_obj_file(model))
    throw UsageError("--animation is for .gltf and .glb files only");
}

Trace trace_of_model(const std::string& file, const ModelOptions& options, const Command& command,
                     const ModelFrames& frames) {
  ImportedModel model = is_obj_file(file) ? read_obj_model(file, options, frames.width, frames.height)
                                          : read_gltf(file, {.width = frames.width,
                                                             .height = frames.height,
                                                             .frames = frames.count,
                                                             .animation = options.animation,
                                                             .animation_if_any = frames.count > 1 && !frames.move,
                                                             .follow_links = options.follow_links});
  say_not_read(file, model.not_read);
  Trace& trace = model.trace;
  Viewpoint viewpoint;
  viewpoint.camera.up = {0, 1, 0};
  const bool has_wishes =
      !options.camera.empty() || std::any_of(std::begin(kViewOptions), std::end(kViewOptions),
                                             [&](const char* option) { return command.was_given(option); });
  if (!model.has_camera || has_wishes) {
    try {
      viewpoint = viewpoint_of(trace, options, command);
      for (Frame& frame : trace.frames) set_camera(frame, viewpoint.camera);
    } catch (const std::invalid_argument& error) {
      throw UsageError(file + ": " + error.what());
    }
    const bool lit = !options.unlit && !command.was_given("--ambient");
    if (options.view.empty()) say_standpoint(file, viewpoint.standpoint, lit);
    if (lit) say_dark(file, trace, viewpoint);
  }
  const glm::vec3 background = options.background.empty() ? glm::vec3(1.0f) : glm::vec3(vector_of(options.background));
  if (glm::clamp(background, 0.0f, kMostColor) != background)
    throw UsageError("--background: expected numbers from 0 to 65504");
  for (Frame& frame : trace.frames) frame.background = background;
  options.unlit ? remove_light(trace) : add_light(trace, options, command, viewpoint);
  return std::move(trace);
}

std::string text_of(const Camera& camera, const ModelOptions& options, const Command& command) {
  const CameraWishes wishes = wishes_of(options, command);
  std::string text = "--eye " + text_of(camera.eye) + " --target " + text_of(camera.target);
  if (camera.up != glm::dvec3(0, 1, 0)) text += " --up " + text_of(camera.up);
  text += " --fovy " + text_of(camera.fovy_deg);
  if (wishes.near) text += " --near " + text_of(camera.near);
  if (wishes.far) text += " --far " + text_of(camera.far);
  return text;
}

}  // namespace beampipe
