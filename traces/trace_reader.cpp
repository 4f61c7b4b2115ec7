#include <cmath>
#include <limits>
#include <map>

#include "traces/json_cursor.h"
#include "traces/model_import.h"
#include "traces/trace_io.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kLargestSide = 16384;
constexpr std::uint64_t kMostTriangles = 1'000'000'000;  // of a frame, whose triangles are numbered in 32 bits
constexpr glm::vec3 kGrey{0.8f};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using MeshIndex = std::map<std::string, std::uint32_t>;

bool is_inside(const fs::path& path, const fs::path& folder) {
  const fs::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

// Returns the path of an OBJ. Whether it stays in the trace's folder is decided after following symbolic links.
fs::path mesh_path(const JsonCursor& at, const fs::path& trace_file, const ReadOptions& options) {
  const fs::path named = at.string();
  if (named.native().find('\0') != std::string::npos) at.fail("a path without NUL characters");
  const fs::path folder = trace_file.has_parent_path() ? trace_file.parent_path() : ".";
  std::error_code error;
  const fs::path path = fs::weakly_canonical(folder / named, error);
  if (error) at.fail("a path that can be followed", in_quotes(named.string()) + ": " + error.message());
  if (!options.allow_outside && (named.is_absolute() || !is_inside(path, fs::canonical(folder)))) {
    at.fail("a path that stays in the trace's folder");
  }
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) at.fail("an existing file");
  if (!fs::is_regular_file(status)) at.fail("a regular file");
  return folder / named;
}

Mesh read_inline_mesh(const JsonCursor& at) {
  at.expect_keys({"positions", "indices", "colors"});
  Mesh mesh;
  mesh.positions = at["positions"].vec3s();
  mesh.triangles = at["indices"].triples(static_cast<std::uint32_t>(mesh.positions.size()));
  mesh.colors.assign(mesh.triangles.size(), kGrey);
  if (const auto colors = at.find("colors")) {
    mesh.colors = colors->colors();
    if (mesh.colors.size() != mesh.triangles.size()) {
      colors->fail("an array of " + std::to_string(3 * mesh.triangles.size()) + " numbers, r, g, b for each triangle");
    }
  }
  return mesh;
}

void add_mesh(Trace& trace, const JsonCursor& at, const fs::path& trace_file, const ReadOptions& options) {
  if (!at.has("obj") && !at.has("positions") && !at.has("indices")) {
    at.fail("the key \"obj\", or \"positions\" and \"indices\"", "none");
  }
  if (!at.has("obj")) {
    trace.meshes.push_back(read_inline_mesh(at));
    return;
  }
  at.expect_keys({"obj"});
  // Version 1 of the format knows only the colours of materials.
  NotRead not_read;
  read_obj(mesh_path(at["obj"], trace_file, options), at["obj"].where(), ObjMaterials::none, trace, not_read);
}

Camera read_camera(const JsonCursor& at) {
  at.expect_keys({"eye", "target", "up", "fovy_deg", "near", "far"});
  Camera camera;
  camera.eye = at["eye"].vec3();
  camera.target = at["target"].vec3();
  camera.up = at["up"].vec3();
  camera.fovy_deg = at["fovy_deg"].number_between(0, 180);
  camera.near = at["near"].number_between(0, kInfinity);
  camera.far = at["far"].number_between(0, kInfinity);
  if (camera.near >= camera.far) at["far"].fail("a number above near, " + at["near"].found());
  const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
  if (!std::isfinite(glm::length(forward))) at["target"].fail("a point other than the eye", "the same point");
  const double sine = glm::length(glm::cross(forward, glm::normalize(camera.up)));
  if (!(sine > 1e-9)) at["up"].fail("a vector not parallel to the view direction", "one that is zero or parallel");
  return camera;
}

void read_view(const JsonCursor& at, Frame& frame) {
  const bool has_matrices = at.has("view") || at.has("projection");
  if (at.has("camera") == has_matrices) {
    at.fail("either \"camera\", or \"view\" and \"projection\"", has_matrices ? "both" : "neither");
  }
  if (has_matrices) {
    frame.view = at["view"].matrix();
    frame.projection = at["projection"].matrix();
  } else {
    set_camera(frame, read_camera(at["camera"]));
  }
}

glm::vec3 read_light(const JsonCursor& at) {
  at.expect_keys({"direction"});
  const glm::dvec3 direction = at["direction"].vec3();
  const double length = glm::length(direction);
  if (!(length > 0) || std::isinf(length)) at["direction"].fail("a vector with a length", "none or an infinite one");
  // A vector that is normalised to a float's precision is kept, so that writing and reading change no bit.
  return glm::vec3(std::abs(length - 1) < 1e-6 ? direction : direction / length);
}

Draw read_draw(const JsonCursor& at, const MeshIndex& meshes, bool has_light) {
  at.expect_keys({"mesh", "transform", "kd", "cull", "shading"});
  Draw draw;
  const auto mesh = meshes.find(at["mesh"].string());
  if (mesh == meshes.end()) at["mesh"].fail("the name of a mesh in /meshes");
  draw.mesh = mesh->second;
  if (const auto transform = at.find("transform")) draw.transform = transform->matrix();
  if (const auto kd = at.find("kd")) draw.kd = kd->color();
  if (const auto cull = at.find("cull")) draw.cull = Cull(cull->choice({"none", "back", "front"}));
  if (const auto shading = at.find("shading")) draw.shading = Shading(shading->choice({"unlit", "lambert"}));
  if (draw.shading == Shading::lambert && !has_light) at["shading"].fail("a \"light\" in the frame", "none");
  return draw;
}

Frame read_frame(const JsonCursor& at, const MeshIndex& index, const std::vector<Mesh>& meshes) {
  at.expect_keys({"width", "height", "background", "camera", "view", "projection", "light", "draws"});
  Frame frame;
  frame.width = at["width"].integer(1, kLargestSide);
  frame.height = at["height"].integer(1, kLargestSide);
  if (const auto background = at.find("background")) frame.background = background->color();
  read_view(at, frame);
  if (const auto light = at.find("light")) frame.lighting.lights.push_back({.direction = read_light(*light)});
  std::uint64_t triangles = 0;
  for (const JsonCursor& draw : at["draws"].elements()) {
    frame.draws.push_back(read_draw(draw, index, !frame.lighting.lights.empty()));
    triangles += meshes[frame.draws.back().mesh].triangles.size();
    if (triangles > kMostTriangles) {
      draw.fail("at most " + std::to_string(kMostTriangles) + " triangles in a frame", std::to_string(triangles));
    }
  }
  return frame;
}

}  // namespace

Trace read_trace(const fs::path& file, const ReadOptions& options) {
  const std::string name = file.string();
  const Json json = parse_json(name);
  const JsonCursor root(json, name);
  root.expect_keys({"beampipe_trace", "meshes", "frames"});
  if (root["beampipe_trace"].number() != 1) root["beampipe_trace"].fail("version 1");

  Trace trace;
  MeshIndex index;
  for (const auto& [key, at] : root["meshes"].members()) {
    index[key] = static_cast<std::uint32_t>(trace.meshes.size());
    add_mesh(trace, at, file, options);
    trace.meshes.back().name = key;
  }
  const std::vector<JsonCursor> frames = root["frames"].elements();
  if (frames.empty()) root["frames"].fail("at least one frame");
  for (const JsonCursor& at : frames) trace.frames.push_back(read_frame(at, index, trace.meshes));
  return trace;
}

}  // namespace beampipe
