// beampipe info: lists the frames and meshes of a trace.

#include <cstdio>
#include <glm/glm.hpp>
#include <iostream>
#include <limits>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/report/report_text.h"
#include "traces/json.h"
#include "traces/trace_io.h"

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
        const glm::dvec3 point(transform * glm::dvec4(mesh.positions[triangle[corner]], 1.0));
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

Json info_json(const Trace& trace, const std::string& file) {
  Json json = {{"beampipe_info", 1}, {"trace", file}, {"frames", Json::array()}, {"meshes", Json::array()}};
  for (std::size_t i = 0; i < trace.frames.size(); ++i) {
    const Frame& frame = trace.frames[i];
    const FrameInfo info = info_of(trace, frame);
    json["frames"].push_back({{"index", i},
                              {"width", frame.width},
                              {"height", frame.height},
                              {"draws", frame.draws.size()},
                              {"triangles", info.triangles},
                              {"bounds", to_json(info.bounds)}});
  }
  for (const Mesh& mesh : trace.meshes) {
    json["meshes"].push_back({{"name", mesh.name},
                              {"positions", mesh.positions.size()},
                              {"triangles", mesh.triangles.size()},
                              {"bounds", to_json(bounds_of(mesh))}});
  }
  return json;
}

std::string info_text(const Trace& trace) {
  std::vector<std::vector<std::string>> frames = {{"frame", "size", "draws", "triangles", "bounds in the world"}};
  for (std::size_t i = 0; i < trace.frames.size(); ++i) {
    const Frame& frame = trace.frames[i];
    const FrameInfo info = info_of(trace, frame);
    frames.push_back({std::to_string(i), std::to_string(frame.width) + " x " + std::to_string(frame.height),
                      std::to_string(frame.draws.size()), std::to_string(info.triangles), text_of(info.bounds)});
  }
  std::vector<std::vector<std::string>> meshes = {{"mesh", "positions", "triangles", "bounds"}};
  for (const Mesh& mesh : trace.meshes) {
    meshes.push_back({mesh.name, std::to_string(mesh.positions.size()), std::to_string(mesh.triangles.size()),
                      text_of(bounds_of(mesh))});
  }
  return align_columns(frames, {4}) + "\n" + align_columns(meshes, {0, 3});
}

}  // namespace

void add_info_command(CommandLine& line) {
  const auto arguments = std::make_shared<InfoArguments>();
  Command command = line.add_command("info", "List the frames and meshes of a trace");
  command.add("TRACE", arguments->trace, "the trace, a JSON file").required();
  command.add_flag("--json", arguments->json, "print the list as JSON");
  command.add_flag("--allow-outside", arguments->allow_outside,
                   "allow the trace to name meshes outside its own folder");
  command.set_work([arguments] {
    const Trace trace = read_trace(arguments->trace, {.allow_outside = arguments->allow_outside});
    std::cout << (arguments->json ? json_text(info_json(trace, arguments->trace)) : info_text(trace));
  });
}

}  // namespace beampipe
