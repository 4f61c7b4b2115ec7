// beampipe info: what is in a trace.

#include <algorithm>
#include <cstdio>
#include <glm/glm.hpp>
#include <iostream>
#include <limits>
#include <memory>
#include <numeric>

#include "tools/cli/commands.h"
#include "tools/cli/trace_notes.h"
#include "tools/evaluate/draw_notes.h"
#include "tools/files/format.h"
#include "tools/report/report_text.h"
#include "traces/files/json.h"
#include "traces/files/trace_io.h"
#include "traces/size_text.h"

namespace beampipe {
namespace {

struct InfoArguments {
  std::string trace;
  bool json = false, allow_outside = false;
};

struct Bounds {
  glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};

  bool empty() const { return min.x > max.x; }

  // Adds the transformed vertices of all triangles.
  void add(const Mesh& mesh, const glm::dmat4& transform) {
    for (const glm::uvec3& triangle : mesh.triangles) {
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t vertex = triangle[corner];
        const double w = mesh.ws.empty() ? 1.0 : mesh.ws[vertex];
        const glm::dvec4 homogeneous = transform * glm::dvec4(mesh.positions[vertex], w);
        if (!(homogeneous.w > 0)) continue;  // at infinity, or behind the eye of a captured frame
        const glm::dvec3 point = glm::dvec3(homogeneous) / homogeneous.w;
        min = glm::min(min, point);
        max = glm::max(max, point);
      }
    }
  }
};

struct FrameInfo {
  std::uint64_t triangles = 0;
  Bounds bounds;  // world space
};

FrameInfo info_of(const Trace& trace, const Frame& frame) {
  FrameInfo info;
  for (const Draw& draw : frame.draws) {
    info.triangles += trace.meshes[draw.mesh].triangles.size();
    info.bounds.add(trace.meshes[draw.mesh], draw.transform);
  }
  return info;
}

Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds;
  bounds.add(mesh, glm::dmat4(1.0));
  return bounds;
}

// What the mesh has beside positions, triangles and their colours, by its names in traces.
std::vector<std::string> attributes_of(const Mesh& mesh) {
  std::vector<std::string> names;
  const auto add = [&](const auto& values, const char* name) {
    if (!values.empty()) names.push_back(name);
  };
  add(mesh.normals, "normals");
  add(mesh.tangents, "tangents");
  add(mesh.uvs[0], "uv0");
  add(mesh.uvs[1], "uv1");
  add(mesh.vertex_colors, "vertex_colors");
  add(mesh.varyings, "varyings");
  add(mesh.materials, "materials");
  return names;
}

// Items of draw state, and for how many draws of a frame they differ from the defaults.
std::vector<std::pair<std::string, std::size_t>> state_of(const Frame& frame) {
  const DrawState defaults;
  std::vector<std::pair<std::string, std::size_t>> items;
  const auto count = [&](const char* name, auto differs) {
    const auto draws = static_cast<std::size_t>(
        std::ranges::count_if(frame.draws, [&](const Draw& draw) { return differs(draw.state); }));
    if (draws > 0) items.emplace_back(name, draws);
  };
  count("viewport", [&](const DrawState& state) { return state.viewport.has_value(); });
  count("scissor", [&](const DrawState& state) { return state.scissor.has_value(); });
  count("no depth test", [&](const DrawState& state) { return !state.depth.test; });
  count("no depth write", [&](const DrawState& state) { return !state.depth.write; });
  count("depth function", [&](const DrawState& state) { return state.depth.function != defaults.depth.function; });
  count("depth range", [&](const DrawState& state) { return state.depth.near != 0 || state.depth.far != 1; });
  count("depth bias", [&](const DrawState& state) { return state.depth.bias != defaults.depth.bias; });
  count("depth clamp", [&](const DrawState& state) { return !state.depth.clip; });
  count("depth clear", [&](const DrawState& state) { return state.depth.cleared_before; });
  count("blend", [&](const DrawState& state) { return state.blend.has_value(); });
  count("colour mask", [&](const DrawState& state) { return state.color_mask != defaults.color_mask; });
  count("alpha to coverage", [&](const DrawState& state) { return state.alpha_to_coverage; });
  count("stencil", [&](const DrawState& state) { return state.stencil.has_value(); });
  return items;
}

struct MaterialInfo {
  std::size_t opaque = 0, mask = 0, blend = 0;
  std::size_t textured = 0;  // with one texture or more
};

MaterialInfo info_of(const std::vector<Material>& materials) {
  MaterialInfo info;
  for (const Material& material : materials) {
    ++(material.alpha_mode == AlphaMode::opaque ? info.opaque
       : material.alpha_mode == AlphaMode::mask ? info.mask
                                                : info.blend);
    info.textured += std::ranges::any_of(kTextureSlots,
                                         [&](const TextureSlot& slot) { return (material.*slot.texture).has_value(); });
  }
  return info;
}

std::string text_of(const Lighting& lighting) {
  return std::to_string(lighting.lights.size()) + (lighting.ambient ? " + ambient" : "");
}

Json to_json(const Bounds& bounds) {
  if (bounds.empty()) return nullptr;
  return {{"min", Json::array({bounds.min.x, bounds.min.y, bounds.min.z})},
          {"max", Json::array({bounds.max.x, bounds.max.y, bounds.max.z})}};
}

std::string text_of(const Bounds& bounds) {
  if (bounds.empty()) return "-";
  char text[160];
  std::snprintf(text, sizeof text, "(%.4g, %.4g, %.4g) .. (%.4g, %.4g, %.4g)", bounds.min.x, bounds.min.y, bounds.min.z,
                bounds.max.x, bounds.max.y, bounds.max.z);
  return text;
}

Json to_json(const Source& source) {
  Json json = {{"program", source.program}, {"api", source.api},   {"driver", source.driver},
               {"date", source.date},       {"tool", source.tool}, {"shading", source.shading}};
  if (source.frame) json["frame"] = *source.frame;
  return json;
}

Json to_json(const CaptureRecord& record) {
  Json json = {{"passes", Json::array()},
               {"left_out", Json::array()},
               {"color", record.pictures.color.has_value()},
               {"depth", !record.pictures.depth.empty()}};
  for (const RenderPass& pass : record.passes) {
    json["passes"].push_back({{"name", pass.name},
                              {"width", pass.width},
                              {"height", pass.height},
                              {"draws", pass.draws},
                              {"triangles", pass.triangles},
                              {"kept", pass.kept},
                              {"reason", pass.reason}});
  }
  for (const LeftOut& item : record.left_out) {
    json["left_out"].push_back({{"reason", item.reason}, {"draws", item.draws}, {"primitives", item.primitives}});
  }
  return json;
}

Json info_json(const Trace& trace, const std::string& file) {
  Json json = {{"beampipe_info", 1},
               {"trace", file},
               {"frames", Json::array()},
               {"meshes", Json::array()},
               {"images", Json::array()}};
  if (trace.source) json["source"] = to_json(*trace.source);
  for (std::size_t i = 0; i < trace.frames.size(); ++i) {
    const Frame& frame = trace.frames[i];
    const FrameInfo info = info_of(trace, frame);
    json["frames"].push_back({{"index", i},
                              {"width", frame.width},
                              {"height", frame.height},
                              {"draws", frame.draws.size()},
                              {"triangles", info.triangles},
                              {"lights", frame.lighting.lights.size()},
                              {"ambient", frame.lighting.ambient.has_value()},
                              {"bounds", to_json(info.bounds)}});
    Json state = Json::object();
    for (const auto& [name, draws] : state_of(frame)) state[name] = draws;
    json["frames"].elements().back()["state"] = std::move(state);
    if (frame.capture != CaptureRecord{}) json["frames"].elements().back()["capture"] = to_json(frame.capture);
  }
  for (const Mesh& mesh : trace.meshes) {
    json["meshes"].push_back({{"name", mesh.name},
                              {"positions", mesh.positions.size()},
                              {"triangles", mesh.triangles.size()},
                              {"attributes", attributes_of(mesh)},
                              {"bounds", to_json(bounds_of(mesh))}});
  }
  const auto add_images = [&](const auto& images) {
    for (const auto& image : images)
      json["images"].push_back({{"name", image.name}, {"width", image.width}, {"height", image.height}});
  };
  add_images(trace.images);
  add_images(trace.program_images);
  const MaterialInfo materials = info_of(trace.materials);
  json["materials"] = {{"opaque", materials.opaque},
                       {"mask", materials.mask},
                       {"blend", materials.blend},
                       {"textured", materials.textured}};
  return json;
}

using Rows = std::vector<std::vector<std::string>>;

std::string source_text(const Source& source) {
  std::string text = "captured from " + (source.program.empty() ? "a program" : source.program);
  for (const std::string& part : {source.api, source.driver, source.date})
    if (!part.empty()) text += ", " + part;
  if (source.frame) text += ", frame " + std::to_string(*source.frame);
  text += "\n";
  if (!source.shading.empty()) text += "colours: " + source.shading + "\n";
  return text;
}

std::string frames_text(const Trace& trace) {
  Rows rows = {{"frame", "size", "draws", "triangles", "lights", "bounds in the world"}};
  for (std::size_t i = 0; i < trace.frames.size(); ++i) {
    const Frame& frame = trace.frames[i];
    const FrameInfo info = info_of(trace, frame);
    rows.push_back({std::to_string(i), size_text(frame.width, frame.height), std::to_string(frame.draws.size()),
                    std::to_string(info.triangles), text_of(frame.lighting), text_of(info.bounds)});
  }
  return align_columns(rows, {5});
}

std::string materials_text(const Trace& trace) {
  const MaterialInfo info = info_of(trace.materials);
  return align_columns({{"materials", "opaque", "mask", "blend", "with textures"},
                        {std::to_string(trace.materials.size()), std::to_string(info.opaque), std::to_string(info.mask),
                         std::to_string(info.blend), std::to_string(info.textured)}},
                       {});
}

// What was captured with the first frame and how its draws differ from the defaults.
std::string capture_text(const Frame& frame) {
  std::string text;
  if (const auto state = state_of(frame); !state.empty()) {
    Rows rows = {{"state of draws", "draws"}};
    for (const auto& [name, draws] : state) rows.push_back({name, std::to_string(draws)});
    text += "\n" + align_columns(rows, {0});
  }
  if (!frame.capture.passes.empty()) {
    Rows rows = {{"pass", "size", "draws", "triangles", "kept", "because"}};
    for (const RenderPass& pass : frame.capture.passes) {
      rows.push_back({pass.name, size_text(pass.width, pass.height), std::to_string(pass.draws),
                      std::to_string(pass.triangles), pass.kept ? "yes" : "no", pass.reason});
    }
    text += "\n" + align_columns(rows, {0, 5});
  }
  if (!frame.capture.left_out.empty()) {
    Rows rows = {{"left out", "draws", "primitives"}};
    for (const LeftOut& item : frame.capture.left_out)
      rows.push_back({item.reason, std::to_string(item.draws), std::to_string(item.primitives)});
    text += "\n" + align_columns(rows, {0});
  }
  return text;
}

std::string info_text(const Trace& trace) {
  std::size_t triangles = 0;
  for (const Mesh& mesh : trace.meshes) triangles += mesh.triangles.size();
  std::string text = trace.source ? source_text(*trace.source) : "";
  text += with_noun(trace.meshes.size(), "mesh") + " of " + with_noun(triangles, "triangle") + ", " +
          with_noun(trace.images.size() + trace.program_images.size(), "image") + "\n\n";
  text += frames_text(trace);
  if (!trace.materials.empty()) text += "\n" + materials_text(trace);
  text += capture_text(trace.frames[0]);
  return text;
}

}  // namespace

void add_info_command(CommandLine& line) {
  const auto arguments = std::make_shared<InfoArguments>();
  Command command = line.add_command("info", "Tell what is in a trace");
  command.add("TRACE", arguments->trace, "the trace, a JSON file").required();
  command.add_flag("--json", arguments->json, "print everything as JSON, with the meshes and images");
  command.add_flag("--allow-outside", arguments->allow_outside, "allow the trace to name files outside its own folder");
  command.set_work([arguments] {
    const Trace trace = read_trace(arguments->trace, {.allow_outside = arguments->allow_outside});
    std::vector<std::size_t> frames(trace.frames.size());
    std::iota(frames.begin(), frames.end(), std::size_t{0});
    if (const std::string note = note_on_darkness(trace, frames, arguments->trace); !note.empty())
      std::cerr << "beampipe: " << note << "\n";
    tell_notes(notes_of(trace, frames, ProgramSet(trace), "techniques that draw by depth"));
    std::cout << (arguments->json ? json_text(info_json(trace, arguments->trace)) : info_text(trace));
  });
}

}  // namespace beampipe
