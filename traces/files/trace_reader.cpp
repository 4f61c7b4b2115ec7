#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "traces/files/array_reader.h"
#include "traces/files/capture_reader.h"
#include "traces/files/draw_state_reader.h"
#include "traces/files/json_cursor.h"
#include "traces/files/model_import.h"
#include "traces/files/program_reader.h"
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

// What each position has one of.
template <class Vector>
struct Attribute {
  const char *key, *meaning;
  Json number;  // the schema of its numbers
  std::vector<Vector> (ArrayReader::*read)(const JsonCursor&) const;
  std::vector<Vector>& (*of)(Mesh&);
  void (*check)(const JsonCursor&, std::vector<Vector>&) = nullptr;
};

template <class Vector>
Field<Mesh> field(const ArrayReader& arrays, const Attribute<Vector>& attribute) {
  return {attribute.key, attribute.meaning, false, numbers_schema(attribute.number),
          [&arrays, attribute](const JsonCursor& at, Mesh& mesh) {
            std::vector<Vector>& vectors = attribute.of(mesh);
            vectors = per_position(at, (arrays.*attribute.read)(at), mesh);
            if (attribute.check) attribute.check(at, vectors);
          }};
}

void check_tangents(const JsonCursor& at, std::vector<glm::vec4>& tangents) {
  normalize_all(at, tangents);
  for (std::size_t i = 0; i < tangents.size(); ++i)
    if (std::abs(tangents[i].w) != 1) at.fail("w of 1 or -1", "another at position " + std::to_string(i));
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

void read_homogeneous(const JsonCursor& at, const ArrayReader& arrays, Mesh& mesh) {
  for (const glm::vec4& position : arrays.vec4s(at)) {
    mesh.positions.emplace_back(position);
    mesh.ws.push_back(position.w);
  }
}

void read_colors(const JsonCursor& at, const ArrayReader& arrays, Mesh& mesh) {
  mesh.colors = arrays.colors(at);
  if (mesh.colors.size() != mesh.triangles.size())
    at.fail("an array of " + std::to_string(3 * mesh.triangles.size()) + " numbers, r, g, b for each triangle");
}

ObjectForm<Mesh> inline_mesh_form(const Reader& reader) {
  const ArrayReader& arrays = reader.arrays;
  const Json number = form::number().schema, amount = form::number(0, kMostColor).schema,
             integer = {{"type", "integer"}, {"minimum", 0}};
  ObjectForm<Mesh> mesh;
  mesh.add({"positions", "x, y, z of each vertex, in scene units, rounded to 32-bit floats.", reader.version == 1,
            numbers_schema(number),
            [&arrays](const JsonCursor& at, Mesh& result) { result.positions = arrays.vec3s(at); }});
  if (reader.version > 1)
    mesh.add({"positions4",
              "x, y, z, w of each vertex, in place of `positions`. In a frame without camera and matrices these are in "
              "clip space.",
              false, numbers_schema(number),
              [&arrays](const JsonCursor& at, Mesh& result) { read_homogeneous(at, arrays, result); }});
  mesh.add({"indices", "Three for each triangle, counted from 0, each below the number of vertices.", true,
            numbers_schema(integer),
            [&arrays](const JsonCursor& at, Mesh& result) {
              result.triangles = arrays.triples(at, static_cast<std::uint32_t>(result.positions.size()));
              result.colors.assign(result.triangles.size(), kDefaultColor);
            }})
      .add({"colors", "Linear r, g, b for each triangle; 0.8 grey when left out.", false, numbers_schema(amount),
            [&arrays](const JsonCursor& at, Mesh& result) { read_colors(at, arrays, result); }});
  if (reader.version == 1) return mesh;
  const auto normals = [](Mesh & result) -> auto& { return result.normals; };
  const auto tangents = [](Mesh & result) -> auto& { return result.tangents; };
  const auto uv0 = [](Mesh & result) -> auto& { return result.uvs[0]; };
  const auto uv1 = [](Mesh & result) -> auto& { return result.uvs[1]; };
  const auto vertex_colors = [](Mesh & result) -> auto& { return result.vertex_colors; };
  return mesh
      .add(field<glm::vec3>(
          arrays, {"normals",
                   "x, y, z for each vertex; of any length but 0. Only triangles with a material use this and the next "
                   "four; without it, they have their own normals.",
                   number, &ArrayReader::vec3s, normals, normalize_all<glm::vec3>}))
      .add(field<glm::vec4>(
          arrays, {"tangents",
                   "x, y, z, of any length but 0, in the direction of u, and the sign of the bitangent, 1 or -1, for "
                   "each vertex, as in glTF.",
                   number, &ArrayReader::vec4s, tangents, check_tangents}))
      .add(field<glm::vec2>(
          arrays,
          {"uv0", "u, v for each vertex; (0, 0) is the upper left corner of an image, and (1, 1) its lower right one.",
           number, &ArrayReader::vec2s, uv0}))
      .add(field<glm::vec2>(arrays, {"uv1", "A second set of u, v for each vertex.", number, &ArrayReader::vec2s, uv1}))
      .add(field<glm::vec4>(
          arrays, {"vertex_colors",
                   "Linear r, g, b and opacity, which is at most 1, for each vertex; multiplied by the material's base "
                   "colour.",
                   amount, &ArrayReader::rgbas, vertex_colors}))
      .add({"varyings",
            "What the programs of draws read, for each vertex: numbers in the order of the program's `inputs`. Bits of "
            "integers are in base64 or in a view.",
            false, numbers_schema(number, true),
            [&arrays](const JsonCursor& at, Mesh& result) { result.varyings = arrays.bits(at); }})
      .add({"materials",
            "The names of the `materials` that the mesh uses; null stands for flat triangles with `colors`. A single "
            "one is that of all triangles.",
            false,
            {{"type", "array"}, {"minItems", 1}, {"items", {{"type", Json::array({"string", "null"})}}}},
            [](const JsonCursor&, Mesh&) {}})
      .add({"material_of_triangle",
            "For each triangle, which of `materials` it has, counted from 0. May be left out where `materials` has "
            "one.",
            false, numbers_schema(integer), [](const JsonCursor&, Mesh&) {}})
      .check([&reader](const JsonCursor& at, Mesh& result) { read_mesh_materials(at, reader, result); });
}

// Its name is known.
Form<Mesh> obj_form(Reader& reader) {
  return ObjectForm<Mesh>().add(
      {"obj",
       "Path of a Wavefront OBJ file, relative to the trace's folder, which it may not leave: neither by .. nor by a "
       "symbolic link. Its mtllib stays in the OBJ's folder. The mesh has the Kd of its .mtl for each face, 0.8 grey "
       "where there is none. Polygons are triangulated.",
       true, form::text().schema, [&reader](const JsonCursor& at, Mesh& mesh) {
         NotRead not_read;
         const ObjMaterials wanted = reader.version == 1 ? ObjMaterials::none : ObjMaterials::textured;
         const bool allow_outside = reader.options.allow_outside;
         read_obj(side_file(at, reader.file, allow_outside),
                  {.materials = wanted, .follow_links = allow_outside, .named_by = at.where()}, reader.trace, not_read);
         const std::string name = mesh.name;
         mesh = std::move(reader.trace.meshes.back());
         mesh.name = name;
         reader.trace.meshes.pop_back();
       }});
}

void expect_positions(const JsonCursor& at) {
  if (!at.has("positions") && !at.has("positions4") && !at.has("indices"))
    at.fail("the key \"obj\", or \"positions\" and \"indices\"", "none");
  const auto homogeneous = at.find("positions4");
  if (!homogeneous) at["positions"];
  if (homogeneous && at.has("positions")) homogeneous->fail("either \"positions\" or \"positions4\"", "both");
}

Form<Mesh> mesh_form(Reader& reader) {
  const Form<Mesh> obj = obj_form(reader), arrays = inline_mesh_form(reader);
  return {{{"oneOf", Json::array({obj.schema, arrays.schema})}}, [obj, arrays](const JsonCursor& at, Mesh& mesh) {
            const bool is_obj = at.has("obj");
            if (!is_obj) expect_positions(at);
            (is_obj ? obj : arrays).read(at, mesh);
          }};
}

void check_camera(const JsonCursor& at, const Camera& camera) {
  if (camera.near >= camera.far) at["far"].fail("a number above near, " + at["near"].found());
  const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
  if (!std::isfinite(glm::length(forward))) at["target"].fail("a point other than the eye", "the same point");
  const double sine = glm::length(glm::cross(forward, glm::normalize(camera.up)));
  if (!(sine > 1e-9)) at["up"].fail("a vector not parallel to the view direction", "one that is zero or parallel");
}

Form<Camera> camera_form() {
  const Form<double> distance = form::number_between(0, kInfinity);
  return ObjectForm<Camera>()
      .required("eye", &Camera::eye, form::vec3(), "Where the camera is, in world space, in scene units.")
      .required("target", &Camera::target, form::vec3(),
                "A point in the middle of the picture, in world space, in scene units; not the eye.")
      .required("up", &Camera::up, form::vec3(),
                "A direction in world space that points up in the picture; of any length, not parallel to the view.")
      .required("fovy_deg", &Camera::fovy_deg, form::number_between(0, 180),
                "The whole vertical angle of view, in degrees.")
      .required("near", &Camera::near, distance, "Distance of the near plane, in scene units.")
      .required("far", &Camera::far, distance, "Distance of the far plane, in scene units; more than `near`.")
      .check(check_camera);
}

// Without any of these, the meshes are in clip space.
void read_view(const JsonCursor& at, int version, Frame& frame) {
  const bool has_matrices = at.has("view") || at.has("projection");
  if (version > 1 && !has_matrices && !at.has("camera")) return;
  if (at.has("camera") == has_matrices) {
    at.fail("either \"camera\", or \"view\" and \"projection\"", has_matrices ? "both" : "neither");
  }
  if (has_matrices) at["view"], at["projection"];
  if (frame.camera) set_camera(frame, *frame.camera);
}

Form<glm::vec3> direction_form() {
  return {form::vec3().schema, [](const JsonCursor& at, glm::vec3& value) {
            const std::optional<glm::vec3> direction = unit_vector(at.vec3());
            if (!direction) at.fail("a vector with a length", "none or an infinite one");
            value = *direction;
          }};
}

constexpr const char* kLightDirection = "The way the light travels, in world space; of any length but 0.";

Form<Light> light_form() {
  return ObjectForm<Light>()
      .required("direction", &Light::direction, direction_form(), kLightDirection)
      .optional("color", &Light::color, form::color(),
                "Linear RGB that a white diffuse surface reflects when it faces the light.");
}

Form<Ambient> ambient_form() {
  return ObjectForm<Ambient>()
      .required("sky", &Ambient::sky, form::color(), "Linear RGB that a white surface reflects when it faces up.")
      .required("ground", &Ambient::ground, form::color(),
                "Linear RGB that a white surface reflects when it faces down.")
      .optional("up", &Ambient::up, direction_form(), "Where the sky is, in world space; of any length but 0.");
}

// Version 1 has one light, which is white.
void add_lighting(ObjectForm<Frame>& frame, int version) {
  if (version == 1) {
    const Form<Light> light =
        ObjectForm<Light>().required("direction", &Light::direction, direction_form(), kLightDirection);
    frame.add({"light", "One white light, which draws with lambert shading need.", false, light.schema,
               [light](const JsonCursor& at, Frame& result) { result.lighting.lights = {light(at)}; }});
    return;
  }
  Form<std::vector<Light>> lights = form::list(light_form());
  lights.schema["maxItems"] = kMostLights;
  frame
      .add({"lights", "The lights. Draws with lambert shading need one, or `ambient`.", false, lights.schema,
            [lights](const JsonCursor& at, Frame& result) {
              if (at.elements().size() > kMostLights) at.fail("at most " + std::to_string(kMostLights) + " lights");
              lights.read(at, result.lighting.lights);
            }})
      .optional(
          "ambient", [](auto& result) -> auto& { return result.lighting.ambient; }, ambient_form(),
          "Light from all around: a mix of `sky` and `ground`, as much of each as the surface's normal points up "
          "and down.");
}

constexpr std::string_view kCulls[] = {"none", "back", "front"}, kShadings[] = {"unlit", "lambert"};

Form<Draw> draw_form(const Reader& reader) {
  ObjectForm<Draw> draw;
  draw.required("mesh", &Draw::mesh, name_form(reader.meshes, "the name of a mesh in /meshes"),
                "The name of one of `meshes`.")
      .optional("transform", &Draw::transform, form::matrix(),
                "Mesh to world space, column-major: the first four numbers are the first column; the identity when "
                "left out.")
      .optional("kd", &Draw::kd, form::color(), "Linear RGB for the whole mesh, in place of its own colours.")
      .optional("cull", &Draw::cull, form::choice<Cull>(kCulls),
                "Which faces are left out; front faces are counter-clockwise in the picture.")
      .optional("shading", &Draw::shading, form::choice<Shading>(kShadings),
                "Of triangles without a material. unlit: the colour as it is. lambert: times the sum over the lights "
                "of color * max(0, dot(n, -direction)), with n the triangle's own normal, turned towards the viewer, "
                "and of the ambient light.");
  if (reader.version == 1) return draw;
  return draw
      .optional("material", &Draw::material, name_form(reader.materials, kMaterialName),
                "The name of one of `materials`, in place of the mesh's own; not together with `kd`.")
      .optional("state", &Draw::state, draw_state_form(),
                "The fixed-function state of a draw, as OpenGL and Vulkan know it.")
      .optional("program", &Draw::program, program_use_form(reader.arrays, reader.trace),
                "The program's own fragment shader and what it reads; not together with `kd` or `material`.")
      .check([&reader](const JsonCursor& at, const Draw& result) {
        if (result.program) {
          if (result.kd || result.material) at.fail("\"program\" without \"kd\" and \"material\"", "both");
          expect_varyings(at["program"], reader.trace, result);
        }
        if (!result.material) return;
        if (result.kd) at.fail("either \"kd\" or \"material\"", "both");
        expect_uvs(at["material"], reader.trace.materials[*result.material], reader.trace.meshes[result.mesh]);
      });
}

void read_draws(const JsonCursor& at, const Form<Draw>& draw, const Reader& reader, Frame& frame) {
  std::uint64_t triangles = 0;
  for (const JsonCursor& each : at.elements()) {
    draw.read(each, frame.draws.emplace_back());
    if (frame.draws.back().shading == Shading::lambert && frame.lighting.lights.empty() && !frame.lighting.ambient) {
      each["shading"].fail(reader.version == 1 ? "a \"light\" in the frame" : "\"lights\" or \"ambient\" in the frame",
                           "none");
    }
    triangles += reader.trace.meshes[frame.draws.back().mesh].triangles.size();
    if (triangles > kMostTriangles) {
      each.fail("at most " + std::to_string(kMostTriangles) + " triangles in a frame", std::to_string(triangles));
    }
  }
}

Form<Frame> frame_form(const Reader& reader) {
  const Form<std::uint32_t> side = form::integer(1, kLargestSide);
  const Form<Draw> draw = draw_form(reader);
  ObjectForm<Frame> frame;
  frame.required("width", &Frame::width, side, "Width of the picture, in pixels.")
      .required("height", &Frame::height, side, "Height of the picture, in pixels.")
      .optional("background", &Frame::background, form::color(), "Linear RGB where nothing is drawn.")
      .optional("camera", &Frame::camera, camera_form(),
                "A pinhole camera with square pixels, right-handed, looking from `eye` to `target`.")
      .optional("view", &Frame::view, form::matrix(), "World to eye space; in place of `camera`, with `projection`.")
      .optional("projection", &Frame::projection, form::matrix(), "Eye to clip space.");
  add_lighting(frame, reader.version);
  frame.add({"draws", "What is drawn, in this order; may be empty.", true, form::list(draw).schema,
             [draw, &reader](const JsonCursor& at, Frame& result) { read_draws(at, draw, reader, result); }});
  if (reader.version > 1) {
    frame.optional("background_alpha", &Frame::background_alpha, form::fraction(),
                   "What blend functions read of the destination's alpha where nothing is drawn.");
    frame.optional("target", &Frame::target, color_target_form(),
                   "What is stored of what programs' shaders return: srgb: its code as sRGB; unorm: the number itself, "
                   "which is the picture's code divided by 255; float: any number, as linear colour.");
    add_capture(frame, reader.trace.images, reader.images, reader.arrays);
  }
  return frame.check(
      [version = reader.version](const JsonCursor& at, Frame& result) { read_view(at, version, result); });
}

int read_version(const JsonCursor& at) {
  const double version = at.number();
  if (version != 1 && version != 2) at.fail("version 1 or 2");
  return static_cast<int>(version);
}

// Fills the trace of the reader, which the parts refer to.
Form<Reader> trace_form(Reader& reader) {
  const auto version = static_cast<std::uint32_t>(reader.version);
  const Form<std::vector<Mesh>> meshes = form::named(mesh_form(reader), &Mesh::name);
  const Form<std::vector<Frame>> frames = form::list(frame_form(reader), "frame");
  ObjectForm<Reader> form;
  form.add(form::unused<Reader>("beampipe_trace", true, form::version(version), "The version of this format."));
  if (version > 1) {
    form.optional(
            "source", [](auto& each) -> auto& { return each.trace.source; }, source_form(),
            "Where a captured trace comes from; for information.")
        .add({"buffers",
              "Binary files of arrays, little-endian, by the names that views use; together at most 2^32 bytes. All "
              "views together have at most four times as many.",
              false, buffers_schema(),
              [](const JsonCursor& at, Reader& each) { each.arrays = ArrayReader(at, each.file, each.options); }});
    const Form<std::vector<TextureImage>> images = images_form(reader.file, reader.options);
    form.add({"images", "The images of textures, by the names that textures use; together at most 2^28 texels.", false,
              images.schema, [images](const JsonCursor& at, Reader& each) {
                each.trace.images = images(at);
                each.images = index_of(each.trace.images);
              }});
    const Form<std::vector<ProgramImage>> program_images = program_images_form(reader.arrays);
    const Form<std::vector<ProgramSampler>> program_samplers = program_samplers_form();
    const Form<std::vector<ShaderProgram>> programs = programs_form(reader.arrays);
    form.add({"program_images", "Images that the programs of draws read.", false, program_images.schema,
              [program_images](const JsonCursor& at, Reader& each) {
                program_images.read(at, each.trace.program_images);
              }})
        .add({"program_samplers", "How the programs of draws read images.", false, program_samplers.schema,
              [program_samplers](const JsonCursor& at, Reader& each) {
                program_samplers.read(at, each.trace.program_samplers);
              }})
        .add({"programs", "Fragment shaders of the program that was captured.", false, programs.schema,
              [programs](const JsonCursor& at, Reader& each) { programs.read(at, each.trace.programs); }});
    const Form<std::vector<Material>> materials = materials_form(reader.images);
    form.add({"materials",
              "What surfaces are made of, by the names that meshes and draws use: glTF 2.0's metallic-roughness model. "
              "A mesh that has a material with a texture has the texture's coordinates.",
              false, materials.schema, [materials](const JsonCursor& at, Reader& each) {
                each.trace.materials = materials(at);
                each.materials = index_of(each.trace.materials);
              }});
  }
  return form
      .add({"meshes", "The meshes, by the names that draws use.", true, meshes.schema,
            [meshes](const JsonCursor& at, Reader& each) {
              each.trace.meshes = meshes(at);  // while they are read, those of the trace are OBJ files alone
              each.meshes = index_of(each.trace.meshes);
            }})
      .add({"frames", "The frames, in the order in which they are shown.", true, frames.schema,
            [frames](const JsonCursor& at, Reader& each) { frames.read(at, each.trace.frames); }});
}

}  // namespace

Trace read_trace(const fs::path& file, const ReadOptions& options) {
  const std::string where = file.string();
  if (is_model_file(file))
    throw TraceError(where + ": expected a trace, found a model; beampipe make turns it into a trace");
  const Json json = parse_json(where);
  const JsonCursor root(json, where);
  Reader reader{.file = file, .options = options, .version = read_version(root["beampipe_trace"]), .trace = {}};
  trace_form(reader).read(root, reader);
  return std::move(reader.trace);
}

Json trace_schema() {
  const fs::path file;
  Reader first{.file = file, .options = {}, .version = 1, .trace = {}},
      second{.file = file, .options = {}, .version = 2, .trace = {}};
  return schema_file(
      {{"description",
        "A recorded draw stream: meshes, and frames that draw them. Matrices are column-major and multiply column "
        "vectors; clip space is OpenGL's (-w <= x, y, z <= w, y up). Colours and lights are linear RGB, 0 to 65504 "
        "(the "
        "largest fp16 number) in each channel. Lengths are in scene units of the user's choice. Every number is "
        "finite; keys that are not named here, and keys that come twice, are errors."},
       {"if", {{"properties", {{"beampipe_trace", {{"const", 1}}}}}}},
       {"then", trace_form(first).schema},
       {"else", trace_form(second).schema}},
      "beampipe trace, versions 1 and 2");
}

}  // namespace beampipe
