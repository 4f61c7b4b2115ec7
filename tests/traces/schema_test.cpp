// The schema and the reader must not drift apart: both name, require and limit the same things.
#include <nlohmann/json.hpp>
#include <set>

#include "tests/traces/test_folder.h"

namespace beampipe {
namespace {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;

// Every key of the format, in two frames and two meshes.
const char kComplete[] = R"({ "beampipe_trace": 1,
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

// Objects of the complete trace, and the part of the schema that describes each.
const std::pair<const char*, const char*> kObjects[] = {
    {"", ""},
    {"/meshes/file", "/$defs/obj_mesh"},
    {"/meshes/inline", "/$defs/inline_mesh"},
    {"/frames/0", "/$defs/frame"},
    {"/frames/1", "/$defs/frame"},
    {"/frames/0/camera", "/$defs/camera"},
    {"/frames/0/light", "/$defs/light"},
    {"/frames/0/draws/0", "/$defs/draw"},
};

class SchemaTest : public FolderTest {
 protected:
  SchemaTest() {
    write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    std::ifstream file(std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/trace.schema.json");
    schema_ = Json::parse(file);
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
    return result;
  }

  Json schema_;
};

TEST_F(SchemaTest, TheCompleteTraceIsComplete) {
  const Json complete = Json::parse(kComplete);
  ASSERT_EQ(error_in(complete), "no error");
  std::set<std::pair<std::string, std::string>> named, used;
  for (const auto& [at, described_by] : kObjects) {
    for (const auto& [key, value] : schema_.at(Pointer(described_by))["properties"].items())
      named.emplace(described_by, key);
    for (const auto& [key, value] : complete.at(Pointer(at)).items()) used.emplace(described_by, key);
  }
  EXPECT_EQ(named, used);
}

TEST_F(SchemaTest, TheReaderKnowsTheSameKeys) {
  for (const auto& [at, described_by] : kObjects) {
    const Json& object = schema_.at(Pointer(described_by));
    EXPECT_EQ(object["additionalProperties"], false) << described_by;
    std::string keys;
    for (const auto& [key, value] : object["properties"].items()) keys += (keys.empty() ? "\"" : ", \"") + key + '"';
    Json trace = Json::parse(kComplete);
    trace.at(Pointer(at))["typo"] = 1;
    EXPECT_EQ(error_in(trace),
              std::string("scene.json: ") + at + "/typo: expected one of the keys " + keys + ", found \"typo\"");
  }
}

TEST_F(SchemaTest, TheReaderRequiresTheSameKeys) {
  for (const auto& [at, described_by] : kObjects) {
    const Json& object = schema_.at(Pointer(described_by));
    const auto required = object["required"].get<std::set<std::string>>();
    const Json complete = Json::parse(kComplete).at(Pointer(at));
    for (const auto& [key, value] : complete.items()) {
      Json trace = Json::parse(kComplete);
      trace.at(Pointer(at)).erase(key);
      // The schema's oneOf says that a frame needs a camera or matrices; the meshes are needed by the draw.
      const bool is_needed = required.contains(key) || key == "camera" || key == "view" || key == "projection";
      EXPECT_EQ(error_in(trace) != "no error", is_needed) << at << " without " << key;
    }
  }
}

TEST_F(SchemaTest, TheReaderRequiresTheSameTypes) {
  const std::pair<const char*, Json> values[] = {
      {"object", Json::object()}, {"string", "text"}, {"number", 1.5},
      {"boolean", true},          {"null", nullptr},  {"array", Json::parse("[[]]")}};
  for (const auto& [at, described_by] : kObjects) {
    const Json complete = Json::parse(kComplete).at(Pointer(at));
    for (const auto& [key, value] : complete.items()) {
      const Json rule = property(described_by, key);
      for (const auto& [type, mistyped] : values) {
        if (rule.value("type", "") == type) continue;
        Json trace = Json::parse(kComplete);
        trace.at(Pointer(at))[key] = mistyped;
        const std::string start = std::string("scene.json: ") + at + '/' + key + ": expected ";
        EXPECT_EQ(error_in(trace).substr(0, start.size()), start) << type;
      }
    }
  }
}

TEST_F(SchemaTest, TheReaderHasTheSameLimits) {
  int limits = 0;
  for (const auto& [at, described_by] : kObjects) {
    const Json complete = Json::parse(kComplete).at(Pointer(at));
    for (const auto& [key, value] : complete.items()) {
      const Json rule = property(described_by, key);
      const auto expect = [&](const char* word, bool accepted, const Json& replacement) {
        ++limits;
        Json trace = Json::parse(kComplete);
        trace.at(Pointer(at))[key] = replacement;
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
      if (rule.contains("enum")) {
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
    }
  }
  EXPECT_GT(limits, 30);
  EXPECT_EQ(schema_["properties"]["frames"]["minItems"], 1);
}

TEST_F(SchemaTest, EveryKeyIsDescribed) {
  for (const auto& [at, described_by] : kObjects) {
    for (const auto& [key, value] : schema_.at(Pointer(described_by))["properties"].items()) {
      EXPECT_GT(property(described_by, key).value("description", "").size(), 10u) << described_by << '/' << key;
    }
  }
}

}  // namespace
}  // namespace beampipe
