// The schema and the reader come from the same forms. These tests hold complete traces, with every key, to both.
#include <nlohmann/json.hpp>

#include "tests/traces/test_folder.h"
#include "traces/files/base64.h"
#include "traces/files/image_file.h"

namespace beampipe::schema_test {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;

// Every key of version 1, in two frames and two meshes.
const char kVersion1[] = R"({ "beampipe_trace": 1,
  "meshes": { "file": {"obj": "mesh.obj"},
              "inline": {"positions": [0,0,0, 1,0,0, 0,1,0], "indices": [0,1,2], "colors": [1,0,0]} },
  "frames": [ { "width": 4, "height": 3, "background": [0,0,1],
                "camera": {"eye": [0,0,3], "target": [0,0,0], "up": [0,1,0], "fovy_deg": 36, "near": 1, "far": 9},
                "light": {"direction": [0,0,-1]},
                "draws": [ {"mesh": "inline", "transform": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "kd": [1,1,1],
                            "cull": "back", "shading": "unlit"} ] },
              { "width": 4, "height": 3, "draws": [],
                "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
                "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1] } ] })";

// Every key of version 2. The image is one white texel.
const char kVersion2[] = R"({ "beampipe_trace": 2,
  "source": {"program": "p", "api": "GL", "driver": "d", "date": "2026-01-01", "tool": "t", "shading": "s", "frame": 3},
  "buffers": { "b": {"file": "arrays.bin", "bytes": 48} },
  "images": { "file": {"file": "white.png"}, "inline": {"data": "DATA"}, "picture": {"file": "picture.png"} },
  "programs": [ {"name": "lit", "spirv": [119734787, 4294967295], "specialization": [{"id": 1, "bits": 4294967295}],
                 "inputs": [{"location": 0, "component": 1, "count": 2, "interpolation": "flat", "integer": true}]} ],
  "program_images": [ {"name": "map", "shape": "2d", "format": "R8G8_UNORM", "width": 2, "height": 3, "depth": 1,
                       "layers": 2, "array": true, "levels": 2, "texels": "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=="} ],
  "program_samplers": [ {"mag": "nearest", "min": "nearest", "mip": "nearest",
                         "wrap": ["mirror", "clamp_to_edge", "clamp_to_border"], "lod_bias": 0.5, "least_lod": 1,
                         "most_lod": 2, "anisotropy": 4, "compare": "less", "border": [0,1,2,3],
                         "unnormalized": true} ],
  "materials": { "m": { "base_color": [1,1,1,0.5],
                        "base_texture": {"image": "inline", "uv_set": 1, "wrap_u": "clamp", "wrap_v": "mirror",
                                         "magnify": "nearest", "minify": "nearest", "mip": "none",
                                         "anisotropy": 4},
                        "metallic": 0.1, "roughness": 0.2, "metallic_roughness_texture": {"image": "file"},
                        "normal_texture": {"image": "file"}, "normal_scale": -2, "emissive": [0,1,2],
                        "emissive_texture": {"image": "file"}, "alpha_mode": "mask", "alpha_cutoff": 0.3,
                        "double_sided": true, "unlit": false } },
  "meshes": { "file": {"obj": "mesh.obj"},
              "inline": {"positions": [0,0,0, 1,0,0, 0,1,0], "indices": [0,1,2], "colors": [1,0,0],
                         "normals": [0,0,1, 0,0,1, 0,0,1], "tangents": [1,0,0,1, 1,0,0,1, 1,0,0,-1],
                         "uv0": [0,0, 1,0, 0,1], "uv1": [0,0, 2,0, 0,2],
                         "vertex_colors": [1,0,0,1, 0,1,0,1, 0,0,1,0], "materials": ["m"],
                         "material_of_triangle": [0], "varyings": [1,2, 3,4, 5,6.5]},
              "clip": {"positions4": {"buffer": "b", "offset": 0, "count": 12, "type": "float32"},
                       "indices": [0,1,2]} },
  "frames": [ { "width": 4, "height": 3, "background": [0,0,1],
                "camera": {"eye": [0,0,3], "target": [0,0,0], "up": [0,1,0], "fovy_deg": 36, "near": 1, "far": 9},
                "lights": [{"direction": [0,0,-1], "color": [1,2,3]}],
                "ambient": {"sky": [1,1,1], "ground": [0,0,0], "up": [0,1,0]},
                "draws": [ {"mesh": "inline", "transform": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "kd": [1,1,1],
                            "cull": "back", "shading": "unlit"},
                           {"mesh": "inline", "material": "m",
                            "state": {"viewport": [0,1,2.5,-3], "scissor": [0,0,4,3], "depth_test": true,
                                      "depth_write": false, "depth_function": "equal", "depth_range": [0.5,1],
                                      "depth_bias": {"constant": 1, "slope": 2, "clamp": 0.5}, "depth_clip": false,
                                      "clears_depth": true, "front_face": "clockwise",
                                      "blend": {"source": "one", "destination": "zero", "operation": "max",
                                                "alpha": {"source": "zero", "destination": "one", "operation": "min"},
                                                "constant": [0,0.5,1,1]},
                                      "color_mask": "rg", "alpha_to_coverage": true,
                                      "stencil": {"function": "less", "reference": 1, "mask": 2, "write_mask": 3,
                                                  "fail": "zero", "depth_fail": "invert", "pass": "replace"},
                                      "stencil_back": {"function": "less", "reference": 1, "mask": 2, "write_mask": 3,
                                                       "fail": "zero", "depth_fail": "invert", "pass": "replace"},
                                      "clears_stencil": 7}},
                           {"mesh": "inline",
                            "program": {"program": 0, "push_constants": "AAA=",
                                        "buffers": [{"set": 0, "binding": 1, "element": 2, "bytes": "AAAA"}],
                                        "images": [{"set": 0, "binding": 2, "element": 1, "image": 0, "sampler": 0,
                                                    "swizzle": "rrr1", "base_level": 1, "base_layer": 1, "levels": 1,
                                                    "layers": 1}]}} ],
                "background_alpha": 0.5, "target": "unorm",
                "passes": [{"name": "main", "width": 4, "height": 3, "draws": 1, "triangles": 2, "kept": true,
                            "reason": "shown"}],
                "left_out": [{"reason": "lines", "draws": 1, "primitives": 2}],
                "captured": {"color": "picture", "depth": [0,0,0,0, 0,0,0,0, 1,1,1,1], "clear_depth": 0.5, "samples": 4} },
              { "width": 4, "height": 3, "draws": [],
                "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
                "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1] } ] })";

class SchemaTest : public FolderTest {
 protected:
  SchemaTest() {
    const TextureImage white{.name = "", .width = 1, .height = 1, .texels = {glm::u8vec4(255)}};
    write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("white.png", encode_png(white));
    write("picture.png", encode_png({.name = "", .width = 4, .height = 3, .texels = {12, glm::u8vec4(255)}}));
    write("arrays.bin", std::string(48, '\0'));
    complete_[0] = Json::parse(kVersion1);
    complete_[1] = Json::parse(kVersion2);
    complete_[1]["images"]["inline"]["data"] = to_base64(encode_png(white));
  }

  const Json& complete(int version) const { return complete_[version - 1]; }

  // Calls visit(version, pointer, value) for every value of the complete traces that is in an object.
  template <class Visit>
  void each_member(Visit visit) const {
    for (const int version : {1, 2})
      for (const auto& [pointer, value] : members_in(complete(version), Pointer())) visit(version, pointer, value);
  }

 private:
  static std::vector<std::pair<Pointer, Json>> members_in(const Json& json, const Pointer& at) {
    std::vector<std::pair<Pointer, Json>> members;
    for (const auto& [key, value] : json.items()) {
      const Pointer inner = json.is_array() ? at / std::stoul(key) : at / key;
      if (json.is_object()) members.emplace_back(inner, value);
      if (!value.is_structured()) continue;
      for (const auto& each : members_in(value, inner)) members.push_back(each);
    }
    return members;
  }

  Json complete_[2];
};

// Whether the schema describes a key of this name somewhere.
void keys_in(const Json& schema, std::set<std::string>& keys) {
  if (!schema.is_structured()) return;
  for (const auto& [word, rule] : schema.items()) {
    if (word == "properties" && schema.is_object())
      for (const auto& [key, member] : rule.items()) keys.insert(key);
    keys_in(rule, keys);
  }
}

TEST_F(SchemaTest, TheCompleteTracesHaveEveryKeyAndAreRead) {
  const Json schema = Json::parse(trace_schema().dump());
  for (const int version : {1, 2}) {
    EXPECT_EQ(error_in(complete(version)), "no error");
    std::set<std::string> described, used;
    keys_in(schema[version == 1 ? "then" : "else"], described);
    each_member([&](int of, const Pointer& at, const Json&) {
      if (of == version) used.insert(at.back());
    });
    if (version == 1)  // the form of arrays is that of both versions, but version 1 has no buffers to view
      for (const char* const of_views : {"buffer", "offset", "type", "count"}) described.erase(of_views);
    for (const std::string& key : described) EXPECT_TRUE(used.contains(key)) << "version " << version << ": " << key;
  }
}

TEST_F(SchemaTest, UnknownKeysAreErrorsEverywhere) {
  const std::set<std::string> named = {"/meshes", "/images", "/materials", "/buffers"};  // with keys of the user's
  int objects = 0;
  each_member([&](int version, const Pointer& at, const Json& value) {
    if (!value.is_object() || named.contains(at.to_string())) return;
    ++objects;
    Json trace = complete(version);
    trace.at(at)["unlisted"] = 1;
    const std::string start = "scene.json: " + at.to_string() + "/unlisted: expected one of the keys ";
    EXPECT_EQ(error_in(trace).substr(0, start.size()), start);
  });
  EXPECT_GT(objects, 20);
}

TEST_F(SchemaTest, WrongTypesAreErrorsEverywhere) {
  const std::pair<const char*, Json> values[] = {
      {"object", Json::object()}, {"string", "text"}, {"number", 1.5},
      {"boolean", true},          {"null", nullptr},  {"array", Json::parse("[[]]")}};
  each_member([&](int version, const Pointer& at, const Json& value) {
    for (const auto& [type, mistyped] : values) {
      if (value.type_name() == std::string(type) || at.parent_pointer().empty()) continue;
      Json trace = complete(version);
      trace.at(at) = mistyped;
      const std::string start = "scene.json: " + at.to_string();
      EXPECT_EQ(error_in(trace).substr(0, start.size()), start) << type;
    }
  });
}

TEST_F(SchemaTest, RequiredKeysAreRequired) {
  const std::pair<const char*, std::vector<const char*>> required[] = {
      {"", {"beampipe_trace", "meshes", "frames"}},
      {"/buffers/b", {"file", "bytes"}},
      {"/meshes/inline", {"positions", "indices"}},
      {"/meshes/clip/positions4", {"buffer", "offset", "count", "type"}},
      {"/materials/m/base_texture", {"image"}},
      {"/frames/0", {"width", "height", "draws"}},
      {"/frames/0/camera", {"eye", "target", "up", "fovy_deg", "near", "far"}},
      {"/frames/0/lights/0", {"direction"}},
      {"/frames/0/ambient", {"sky", "ground"}},
      {"/frames/0/draws/0", {"mesh"}},
      {"/frames/0/draws/1/state/blend", {"source", "destination"}},
      {"/frames/0/passes/0", {"name", "kept"}},
      {"/programs/0", {"name", "spirv"}},
      {"/program_images/0", {"texels"}},
      {"/frames/0/draws/2/program", {"program"}},
      {"/frames/0/draws/2/program/buffers/0", {"bytes"}},
      {"/frames/0/left_out/0", {"reason"}},
      {"/frames/1", {"view", "projection"}}};
  for (const auto& [parent, keys] : required)
    for (const char* const key : keys) {
      Json trace = complete(2);
      trace.at(Pointer(parent)).erase(key);
      EXPECT_EQ(error_in(trace), std::string("scene.json: ") + (*parent ? parent : "/") + ": expected the key \"" +
                                     key + "\", found none");
    }
}

}  // namespace beampipe::schema_test
