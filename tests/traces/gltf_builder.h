// Builds small glTF files with one embedded buffer.
#pragma once

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "traces/files/base64.h"

namespace beampipe {

class GltfBuilder {
 public:
  // A file with one triangle (accessor 0), mesh 0 of it, and node 0 that shows it.
  GltfBuilder() {
    json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
    json["nodes"] = {{{"mesh", 0}}};
    floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
    json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}};
  }

  // Adds a bufferView with these numbers, and an accessor of all of it. Returns the accessor's index.
  template <class Number>
  int add(const std::string& type, int component_type, const std::vector<Number>& numbers, bool normalized = false) {
    const int view = add_view({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)});
    const std::size_t width = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : static_cast<std::size_t>(type[3] - '0');
    json["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component_type}, {"count", numbers.size() / width}, {"type", type}});
    if (normalized) json["accessors"].back()["normalized"] = true;
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  int floats(const std::string& type, const std::vector<float>& numbers) { return add(type, 5126, numbers); }

  int add_view(std::string_view bytes) {
    while (buffer.size() % 4 != 0) buffer += '\0';
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
    buffer += bytes;
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }

  nlohmann::json& primitive(std::size_t index = 0) { return json["meshes"][0]["primitives"][index]; }
  nlohmann::json& attributes() { return primitive()["attributes"]; }
  nlohmann::json& node(std::size_t index = 0) { return json["nodes"][index]; }

  std::string text() const {
    nlohmann::json whole = json;
    if (!whole.contains("buffers"))
      whole["buffers"] = {
          {{"byteLength", buffer.size()}, {"uri", "data:application/octet-stream;base64," + to_base64(buffer)}}};
    return whole.dump();
  }

  // The same as a binary file.
  std::string binary() const {
    nlohmann::json whole = json;
    whole["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string first = whole.dump(), second = buffer;
    first.resize((first.size() + 3) / 4 * 4, ' ');
    second.resize((second.size() + 3) / 4 * 4, '\0');
    return "glTF" + number(2) + number(28 + first.size() + second.size()) + number(first.size()) + "JSON" + first +
           number(second.size()) + std::string("BIN\0", 4) + second;
  }

  static std::string number(std::size_t value) {
    const auto small = static_cast<std::uint32_t>(value);
    return {reinterpret_cast<const char*>(&small), 4};
  }

  nlohmann::json json;
  std::string buffer;
};

}  // namespace beampipe
