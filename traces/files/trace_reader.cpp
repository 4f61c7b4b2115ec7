#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "traces/files/array_reader.h"
#include "traces/files/capture_reader.h"
#include "traces/files/draw_state_reader.h"
#include "traces/files/json_cursor.h"
#include "traces/files/model_import.h"
#include "traces/files/side_file.h"
#include "traces/files/surface_reader.h"
#include "traces/files/trace_io.h"
#include "traces/unit_vector.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kLargestSide = 16384;
constexpr std::uint64_t kMostTriangles = 1'000'000'000;  // of a frame, whose triangles are numbered in 32 bits
constexpr const char* kMaterialName = "the name of a material in /materials";
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What the parts of a trace refer to.
struct Reader {
  const fs::path& file;
  const ReadOptions& options;
  int version;
  Trace trace;
  ArrayReader arrays{};
  NameIndex images{}, materials{}, meshes{};
};

template <class Vector>
std::vector<Vector> per_position(const JsonCursor& at, std::vector<Vector> vectors, const Mesh& mesh) {
  if (vectors.size() != mesh.positions.size()) {
    at.fail("an array of " + std::to_string(Vector::length() * mesh.positions.size()) + " numbers, " +
            std::to_string(Vector::length()) + " for each position");
  }
  return vectors;
}

// Gives all vectors length 1, in the first three of their components.
template <class Vector>
void normalize_all(const JsonCursor& at, std::vector<Vector>& vectors) {
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const std::optional<glm::vec3> unit = unit_vector(glm::vec3(vectors[i]));
    if (!unit) at.fail("vectors with a length", "none at position " + std::to_string(i));
    for (int k = 0; k < 3; ++k) vectors[i][k] = (*unit)[k];
  }
}

void read_attributes(const JsonCursor& at, const ArrayReader& arrays, Mesh& mesh) {
  if (const auto normals = at.find("normals")) {
    mesh.normals = per_position(*normals, arrays.vec3s(*normals), mesh);
    normalize_all(*normals, mesh.normals);
  }
  if (const auto tangents = at.find("tangents")) {
    mesh.tangents = per_position(*tangents, arrays.vec4s(*tangents), mesh);
    normalize_all(*tangents, mesh.tangents);
    for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
      if (std::abs(mesh.tangents[i].w) != 1) tangents->fail("w of 1 or -1", "another at position " + std::to_string(i));
    }
  }
  if (const auto uvs = at.find("uv0")) mesh.uvs[0] = per_position(*uvs, arrays.vec2s(*uvs), mesh);
  if (const auto uvs = at.find("uv1")) mesh.uvs[1] = per_position(*uvs, arrays.vec2s(*uvs), mesh);
  if (const auto colors = at.find("vertex_colors")) {
    mesh.vertex_colors = per_position(*colors, arrays.rgbas(*colors), mesh);
  }
}

// "materials" lists those that the mesh uses, and "material_of_triangle" says which of them each triangle has.
void read_mesh_materials(const JsonCursor& at, const Reader& reader, Mesh& mesh) {
  const auto names = at.find("materials");
  const auto of_triangle = at.find("material_of_triangle");
  if (!names && of_triangle) of_triangle->fail("\"materials\" beside it", "none");
  if (!names) return;
  std::vector<std::uint32_t> materials;
  for (const JsonCursor& name : names->elements()) {
    materials.push_back(name.is_null() ? kNoMaterial : read_name(name, reader.materials, kMaterialName));
    if (!name.is_null()) expect_uvs(name, reader.trace.materials[materials.back()], mesh);
  }
  if (materials.empty() || (materials.size() > 1 && !of_triangle)) {
    names->fail("one material, or \"material_of_triangle\" beside several");
  }
  mesh.materials.assign(mesh.triangles.size(), materials[0]);
  if (!of_triangle) return;
  const std::vector<std::uint32_t> numbers =
      reader.arrays.integers(*of_triangle, static_cast<std::uint32_t>(materials.size()));
  if (numbers.size() != mesh.triangles.size()) {
    of_triangle->fail("an array of " + std::to_string(mesh.triangles.size()) + " numbers, one for each triangle");
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) mesh.materials[i] = materials[numbers[i]];
}

// "positions4" has the homogeneous ones.
void read_positions(const JsonCursor& at, const ArrayReader& arrays, Mesh& mesh) {
  const auto homogeneous = at.find("positions4");
  if (!homogeneous) {
    mesh.positions = arrays.vec3s(at["positions"]);
    return;
  }
  if (at.has("positions")) homogeneous->fail("either \"positions\" or \"positions4\"", "both");
  for (const glm::vec4& position : arrays.vec4s(*homogeneous)) {
    mesh.positions.emplace_back(position);
    mesh.ws.push_back(position.w);
  }
}

Mesh read_inline_mesh(const JsonCursor& at, const std::string& name, const Reader& reader) {
  if (reader.version == 1) {
    at.expect_keys({"positions", "indices", "colors"});
  } else {
    at.expect_keys({"positions", "positions4", "indices", "colors", "normals", "tangents", "uv0", "uv1",
                    "vertex_colors", "materials", "material_of_triangle"});
  }
  Mesh mesh;
  mesh.name = name;
  read_positions(at, reader.arrays, mesh);
  mesh.triangles = reader.arrays.triples(at["indices"], static_cast<std::uint32_t>(mesh.positions.size()));
  mesh.colors.assign(mesh.triangles.size(), kDefaultColor);
  if (const auto colors = at.find("colors")) {
    mesh.colors = reader.arrays.colors(*colors);
    if (mesh.colors.size() != mesh.triangles.size()) {
      colors->fail("an array of " + std::to_string(3 * mesh.triangles.size()) + " numbers, r, g, b for each triangle");
    }
  }
  read_attributes(at, reader.arrays, mesh);
  read_mesh_materials(at, reader, mesh);
  return mesh;
}

void add_mesh(const JsonCursor& at, const std::string& name, Reader& reader) {
  if (!at.has("obj") && !at.has("positions") && !at.has("positions4") && !at.has("indices")) {
    at.fail("the key \"obj\", or \"positions\" and \"indices\"", "none");
  }
  if (at.has("obj")) {
    at.expect_keys({"obj"});
    const JsonCursor obj = at["obj"];
    NotRead not_read;
    const ObjMaterials wanted = reader.version == 1 ? ObjMaterials::none : ObjMaterials::textured;
    read_obj(side_file(obj, reader.file, reader.options.allow_outside), obj.where(), wanted, reader.trace, not_read);
    reader.trace.meshes.back().name = name;
  } else {
    reader.trace.meshes.push_back(read_inline_mesh(at, name, reader));
  }
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

// Without any of these, the meshes are in clip space.
void read_view(const JsonCursor& at, int version, Frame& frame) {
  const bool has_matrices = at.has("view") || at.has("projection");
  if (version > 1 && !has_matrices && !at.has("camera")) return;
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

glm::vec3 read_direction(const JsonCursor& at) {
  const std::optional<glm::vec3> direction = unit_vector(at.vec3());
  if (!direction) at.fail("a vector with a length", "none or an infinite one");
  return *direction;
}

Light read_light(const JsonCursor& at) {
  at.expect_keys({"direction", "color"});
  Light light{.direction = read_direction(at["direction"])};
  if (const auto color = at.find("color")) light.color = color->color();
  return light;
}

Ambient read_ambient(const JsonCursor& at) {
  at.expect_keys({"sky", "ground", "up"});
  Ambient ambient{.sky = at["sky"].color(), .ground = at["ground"].color()};
  if (const auto up = at.find("up")) ambient.up = read_direction(*up);
  return ambient;
}

// Version 1 has one light, which is white.
Lighting read_lighting(const JsonCursor& at) {
  Lighting lighting;
  if (const auto light = at.find("light")) {
    light->expect_keys({"direction"});
    lighting.lights.push_back({.direction = read_direction((*light)["direction"])});
  }
  if (const auto lights = at.find("lights")) {
    const std::vector<JsonCursor> elements = lights->elements();
    if (elements.size() > kMostLights) lights->fail("at most " + std::to_string(kMostLights) + " lights");
    for (const JsonCursor& light : elements) lighting.lights.push_back(read_light(light));
  }
  if (const auto ambient = at.find("ambient")) lighting.ambient = read_ambient(*ambient);
  return lighting;
}

Draw read_draw(const JsonCursor& at, const Reader& reader, const Lighting& lighting) {
  if (reader.version == 1) {
    at.expect_keys({"mesh", "transform", "kd", "cull", "shading"});
  } else {
    at.expect_keys({"mesh", "transform", "kd", "cull", "shading", "material", "state"});
  }
  Draw draw;
  draw.mesh = read_name(at["mesh"], reader.meshes, "the name of a mesh in /meshes");
  if (const auto transform = at.find("transform")) draw.transform = transform->matrix();
  if (const auto kd = at.find("kd")) draw.kd = kd->color();
  if (const auto cull = at.find("cull")) draw.cull = Cull(cull->choice({"none", "back", "front"}));
  if (const auto shading = at.find("shading")) draw.shading = Shading(shading->choice({"unlit", "lambert"}));
  if (draw.shading == Shading::lambert && lighting.lights.empty() && !lighting.ambient) {
    at["shading"].fail(reader.version == 1 ? "a \"light\" in the frame" : "\"lights\" or \"ambient\" in the frame",
                       "none");
  }
  if (const auto material = at.find("material")) {
    if (draw.kd) at.fail("either \"kd\" or \"material\"", "both");
    draw.material = read_name(*material, reader.materials, kMaterialName);
    expect_uvs(*material, reader.trace.materials[*draw.material], reader.trace.meshes[draw.mesh]);
  }
  if (const auto state = at.find("state")) draw.state = read_draw_state(*state);
  return draw;
}

Frame read_frame(const JsonCursor& at, const Reader& reader) {
  if (reader.version == 1) {
    at.expect_keys({"width", "height", "background", "camera", "view", "projection", "light", "draws"});
  } else {
    at.expect_keys({"width", "height", "background", "camera", "view", "projection", "lights", "ambient", "draws",
                    "passes", "left_out", "captured"});
  }
  Frame frame;
  frame.width = at["width"].integer(1, kLargestSide);
  frame.height = at["height"].integer(1, kLargestSide);
  if (const auto background = at.find("background")) frame.background = background->color();
  read_view(at, reader.version, frame);
  frame.lighting = read_lighting(at);
  if (reader.version > 1) {
    frame.capture = read_capture_record(at, frame, reader.trace.images, reader.images, reader.arrays);
  }
  std::uint64_t triangles = 0;
  for (const JsonCursor& draw : at["draws"].elements()) {
    frame.draws.push_back(read_draw(draw, reader, frame.lighting));
    triangles += reader.trace.meshes[frame.draws.back().mesh].triangles.size();
    if (triangles > kMostTriangles) {
      draw.fail("at most " + std::to_string(kMostTriangles) + " triangles in a frame", std::to_string(triangles));
    }
  }
  return frame;
}

int read_version(const JsonCursor& at) {
  const double version = at.number();
  if (version != 1 && version != 2) at.fail("version 1 or 2");
  return static_cast<int>(version);
}

}  // namespace

Trace read_trace(const fs::path& file, const ReadOptions& options) {
  const std::string where = file.string();
  if (is_model_file(file))
    throw TraceError(where + ": expected a trace, found a model; beampipe make turns it into a trace");
  const Json json = parse_json(where);
  const JsonCursor root(json, where);
  Reader reader{.file = file, .options = options, .version = read_version(root["beampipe_trace"]), .trace = {}};
  if (reader.version == 1) {
    root.expect_keys({"beampipe_trace", "meshes", "frames"});
  } else {
    root.expect_keys({"beampipe_trace", "source", "buffers", "images", "materials", "meshes", "frames"});
  }
  Trace& trace = reader.trace;
  if (const auto source = root.find("source")) trace.source = read_source(*source);
  if (const auto buffers = root.find("buffers")) reader.arrays = ArrayReader(*buffers, file, options);
  if (const auto images = root.find("images")) {
    trace.images = read_images(*images, file, options);
    reader.images = index_of(trace.images);
  }
  if (const auto materials = root.find("materials")) {
    trace.materials = read_materials(*materials, reader.images);
    reader.materials = index_of(trace.materials);
  }
  for (const auto& [name, mesh] : root["meshes"].members()) add_mesh(mesh, name, reader);
  reader.meshes = index_of(trace.meshes);
  const std::vector<JsonCursor> frames = root["frames"].elements();
  if (frames.empty()) root["frames"].fail("at least one frame");
  for (const JsonCursor& frame : frames) trace.frames.push_back(read_frame(frame, reader));
  return std::move(trace);
}

}  // namespace beampipe
