// The schema and the reader must not drift apart: both name, require and limit the same things.
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

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
                         "material_of_triangle": [0]},
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
                                      "blend": {"source": "one", "destination": "zero", "operation": "max"},
                                      "color_mask": "rg",
                                      "stencil": {"function": "less", "reference": 1, "mask": 2, "write_mask": 3,
                                                  "fail": "zero", "depth_fail": "invert", "pass": "replace"}}} ],
                "passes": [{"name": "main", "width": 4, "height": 3, "draws": 1, "triangles": 2, "kept": true,
                            "reason": "shown"}],
                "left_out": [{"reason": "lines", "draws": 1, "primitives": 2}],
                "captured": {"color": "picture", "depth": [0,0,0,0, 0,0,0,0, 1,1,1,1], "clear_depth": 0.5} },
              { "width": 4, "height": 3, "draws": [],
                "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
                "projection": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1] } ] })";

// An object of a complete trace, the part of the schema that describes it, and, in version 1, the part that lists its
// keys.
struct Object {
  int version;
  const char *at, *described_by, *keys = "";
};
const Object kObjects[] = {
    {1, "", "", "/then/propertyNames"},
    {1, "/meshes/file", "/$defs/obj_mesh"},
    {1, "/meshes/inline", "/$defs/inline_mesh", "/then/properties/meshes/additionalProperties/propertyNames"},
    {1, "/frames/0", "/$defs/frame", "/then/properties/frames/items/propertyNames"},
    {1, "/frames/1", "/$defs/frame", "/then/properties/frames/items/propertyNames"},
    {1, "/frames/0/camera", "/$defs/camera"},
    {1, "/frames/0/light", "/$defs/frame/properties/light"},
    {1, "/frames/0/draws/0", "/$defs/draw", "/then/properties/frames/items/properties/draws/items/propertyNames"},
    {2, "", ""},
    {2, "/source", "/$defs/source"},
    {2, "/buffers/b", "/$defs/buffer"},
    {2, "/images/file", "/$defs/image_file"},
    {2, "/images/inline", "/$defs/inline_image"},
    {2, "/materials/m", "/$defs/material"},
    {2, "/materials/m/base_texture", "/$defs/texture"},
    {2, "/meshes/file", "/$defs/obj_mesh"},
    {2, "/meshes/inline", "/$defs/inline_mesh"},
    {2, "/meshes/clip", "/$defs/inline_mesh"},
    {2, "/meshes/clip/positions4", "/$defs/view"},
    {2, "/frames/0", "/$defs/frame"},
    {2, "/frames/1", "/$defs/frame"},
    {2, "/frames/0/camera", "/$defs/camera"},
    {2, "/frames/0/lights/0", "/$defs/light"},
    {2, "/frames/0/ambient", "/$defs/ambient"},
    {2, "/frames/0/draws/0", "/$defs/draw"},
    {2, "/frames/0/draws/1", "/$defs/draw"},
    {2, "/frames/0/draws/1/state", "/$defs/state"},
    {2, "/frames/0/draws/1/state/depth_bias", "/$defs/depth_bias"},
    {2, "/frames/0/draws/1/state/blend", "/$defs/blend"},
    {2, "/frames/0/draws/1/state/stencil", "/$defs/stencil"},
    {2, "/frames/0/passes/0", "/$defs/pass"},
    {2, "/frames/0/left_out/0", "/$defs/left_out"},
    {2, "/frames/0/captured", "/$defs/captured"},
};

// Not required by the schema's `required`, but by its oneOf, by other keys, or by what is named elsewhere.
const std::set<std::string> kNeededElsewhere = {"view",   "projection", "file", "data", "positions", "positions4",
                                                "images", "materials",  "uv0",  "uv1",  "buffers"};

// What other parts of the trace allow only some values of.
const std::set<std::string> kGivenElsewhere = {"bytes", "count", "type"};

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
    std::ifstream file(std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/trace.schema.json");
    schema_ = Json::parse(file);
  }

  const Json& complete(int version) const { return complete_[version - 1]; }

  // The keys that the version has, in the order of the schema.
  std::vector<std::string> keys_of(const Object& object) const {
    std::vector<std::string> keys;
    const Json& properties = schema_.at(Pointer(object.described_by))["properties"];
    for (const auto& [key, value] : properties.items())
      if (object.version == 1 || key != "light") keys.push_back(key);
    if (*object.keys == '\0') return keys;
    const auto known = schema_.at(Pointer(object.keys))["enum"].get<std::set<std::string>>();
    std::erase_if(keys, [&](const std::string& key) { return !known.contains(key); });
    return keys;
  }

  std::string error_in(const Json& json) const {
    return error_of([&] { read_trace(write("scene.json", json.dump())); });
  }

  // A property's own schema together with what it refers to.
  Json property(const std::string& object, const std::string& key) const {
    Json result = schema_.at(Pointer(object))["properties"][key];
    if (result.contains("$ref")) {
      const std::string target = result["$ref"].get<std::string>().substr(1);
      const Json referred = schema_.at(Pointer(target));
      for (const auto& [name, value] : referred.items()) {
        if (!result.contains(name)) result[name] = value;
      }
    }
    if (result.contains("oneOf")) result.update(Json(result["oneOf"][0]));  // an array, or else a view
    return result;
  }

  Json schema_;

 private:
  Json complete_[2];
};

TEST_F(SchemaTest, TheCompleteTracesAreComplete) {
  std::set<std::tuple<int, std::string, std::string>> named, used;
  for (const Object& object : kObjects) {
    ASSERT_EQ(error_in(complete(object.version)), "no error");
    for (const std::string& key : keys_of(object)) named.emplace(object.version, object.described_by, key);
    for (const auto& [key, value] : complete(object.version).at(Pointer(object.at)).items())
      used.emplace(object.version, object.described_by, key);
  }
  EXPECT_EQ(named, used);
}

TEST_F(SchemaTest, TheReaderKnowsTheSameKeys) {
  for (const Object& object : kObjects) {
    EXPECT_EQ(schema_.at(Pointer(object.described_by))["additionalProperties"], false) << object.described_by;
    std::string keys;
    for (const std::string& key : keys_of(object)) keys += (keys.empty() ? "\"" : ", \"") + key + '"';
    Json trace = complete(object.version);
    trace.at(Pointer(object.at))["unlisted"] = 1;
    EXPECT_EQ(error_in(trace), std::string("scene.json: ") + object.at + "/unlisted: expected one of the keys " + keys +
                                   ", found \"unlisted\"");
  }
}

TEST_F(SchemaTest, TheReaderRequiresTheSameKeys) {
  for (const auto& [version, at, described_by, keys] : kObjects) {
    const auto required = schema_.at(Pointer(described_by))["required"].get<std::set<std::string>>();
    for (const auto& [key, value] : complete(version).at(Pointer(at)).items()) {
      Json trace = complete(version);
      trace.at(Pointer(at)).erase(key);
      const bool is_needed =
          required.contains(key) || kNeededElsewhere.contains(key) || (version == 1 && key == "camera");
      EXPECT_EQ(error_in(trace) != "no error", is_needed) << at << " without " << key;
    }
  }
}

TEST_F(SchemaTest, TheReaderRequiresTheSameTypes) {
  const std::pair<const char*, Json> values[] = {
      {"object", Json::object()}, {"string", "text"}, {"number", 1.5},
      {"boolean", true},          {"null", nullptr},  {"array", Json::parse("[[]]")}};
  for (const auto& [version, at, described_by, keys] : kObjects) {
    for (const auto& [key, value] : complete(version).at(Pointer(at)).items()) {
      const Json rule = property(described_by, key);
      for (const auto& [type, mistyped] : values) {
        if (rule.value("type", "") == type) continue;
        Json trace = complete(version);
        trace.at(Pointer(at))[key] = mistyped;
        const std::string start = std::string("scene.json: ") + at + '/' + key + ": expected ";
        EXPECT_EQ(error_in(trace).substr(0, start.size()), start) << type;
      }
    }
  }
}

TEST_F(SchemaTest, TheReaderHasTheSameLimits) {
  int limits = 0;
  for (const auto& [version, at, described_by, keys] : kObjects) {
    for (const auto& [key, value] : complete(version).at(Pointer(at)).items()) {
      const Json rule = property(described_by, key);
      const auto expect = [&](const char* word, bool accepted, const Json& replacement) {
        if (kGivenElsewhere.contains(key) && accepted) return;
        ++limits;
        Json trace = complete(version);
        trace.at(Pointer(at))[key] = replacement;
        if (key == "width" || key == "height") trace.at(Pointer(at)).erase("captured");  // pictures of the other size
        EXPECT_EQ(error_in(trace) == "no error", accepted) << at << '/' << key << ' ' << word << ' ' << replacement;
      };
      const auto number = [&](const char* word) { return rule[word].get<double>(); };
      if (rule.contains("minimum")) expect("minimum", true, number("minimum"));
      if (rule.contains("minimum")) expect("minimum", false, number("minimum") - 1);
      if (rule.contains("maximum")) expect("maximum", true, number("maximum"));
      if (rule.contains("maximum")) expect("maximum", false, number("maximum") + 1);
      if (rule.contains("exclusiveMinimum")) expect("exclusiveMinimum", false, number("exclusiveMinimum"));
      if (rule.contains("exclusiveMaximum")) expect("exclusiveMaximum", false, number("exclusiveMaximum"));
      if (rule.contains("exclusiveMaximum")) expect("exclusiveMaximum", true, number("exclusiveMaximum") - 1);
      if (rule.contains("enum") && key != "beampipe_trace") {
        for (const Json& choice : rule["enum"]) expect("enum", true, choice);
      }
      if (rule.contains("minItems") && rule.contains("maxItems")) {
        expect("maxItems", false, std::vector<int>(rule["maxItems"].get<std::size_t>() + 1, 1));
        expect("minItems", false, std::vector<int>(rule["minItems"].get<std::size_t>() - 1, 1));
      }
      if (rule.contains("items") && rule["items"].contains("minimum")) {
        Json negative = value;
        negative[0] = -1;
        expect("items/minimum", false, negative);
      }
      if (rule.contains("items") && rule["items"].contains("maximum")) {
        Json large = value;
        large[0] = rule["items"]["maximum"];
        expect("items/maximum", true, large);
        large[0] = rule["items"]["maximum"].get<double>() + 1;
        expect("items/maximum", false, large);
      }
    }
  }
  EXPECT_GT(limits, 90);
  EXPECT_EQ(schema_["properties"]["frames"]["minItems"], 1);
  EXPECT_EQ(schema_["properties"]["beampipe_trace"]["enum"], (std::vector<int>{1, 2}));
  EXPECT_EQ(schema_["$defs"]["frame"]["properties"]["lights"]["maxItems"], kMostLights);
  EXPECT_EQ(schema_["$defs"]["rgba"]["prefixItems"][3]["maximum"], 1);
  EXPECT_EQ(schema_["$defs"]["rgba"]["prefixItems"][0]["maximum"], kMostColor);
  EXPECT_EQ(schema_["$defs"]["color"]["items"]["maximum"], kMostColor);
  EXPECT_EQ(schema_["$defs"]["material"]["properties"]["normal_scale"]["maximum"], kMostNormalScale);
}

TEST_F(SchemaTest, EveryKeyIsDescribed) {
  for (const auto& [version, at, described_by, keys] : kObjects) {
    for (const auto& [key, value] : schema_.at(Pointer(described_by))["properties"].items()) {
      EXPECT_GT(property(described_by, key).value("description", "").size(), 10u) << described_by << '/' << key;
    }
  }
}

}  // namespace beampipe::schema_test
