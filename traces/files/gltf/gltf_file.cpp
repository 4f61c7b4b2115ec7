#include "traces/files/gltf/gltf_file.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <set>

#include "traces/files/input_file.h"
#include "traces/files/json.h"
#include "traces/files/json_cursor.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

const std::set<std::string_view> kExtensionsRead = {"KHR_lights_punctual", "KHR_materials_emissive_strength",
                                                    "KHR_materials_unlit", "KHR_mesh_quantization",
                                                    "KHR_texture_transform"};

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
  return value;
}

// The JSON of a binary glTF file. tinygltf reads past the end of files whose second chunk is too long, so all lengths
// are checked here. Source: glTF 2.0 Specification, section 4.4.
std::string_view json_chunk(std::string_view glb, const std::string& where) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kJson = 0x4E4F534A;
  if (glb.size() < kHeader + kChunkHeader) fail_trace(where, "a binary glTF file", "one that ends early");
  if (little_endian(glb, 4) != 2)
    fail_trace(where, "version 2 of binary glTF", "version " + std::to_string(little_endian(glb, 4)));
  const std::size_t length = little_endian(glb, 8);
  std::size_t at = kHeader;
  for (int chunk = 0; at < length; ++chunk) {
    const bool has_header = length <= glb.size() && length - at >= kChunkHeader;
    if (!has_header || little_endian(glb, at) > length - at - kChunkHeader)
      fail_trace(where, "chunks that fit into the file", "one that is longer");
    if (chunk == 0 && little_endian(glb, at + 4) != kJson) fail_trace(where, "a chunk of JSON first", "another one");
    at += kChunkHeader + little_endian(glb, at);
  }
  if (at == kHeader) fail_trace(where, "a chunk of JSON first", "none");
  return glb.substr(kHeader + kChunkHeader, little_endian(glb, kHeader));
}

enum class Type { integer, number, numbers, number_or_numbers, integers, boolean, string, array, object };

// Members whose type is the same wherever glTF has them, apart from extensions. tinygltf takes most members of another
// type as missing, and keeps the low 32 bits of integers.
struct TypedMembers {
  Type type;
  std::string_view keys;  // with a blank before and after each
};
constexpr TypedMembers kTypes[] = {
    {Type::integer,
     " buffer bufferView byteLength byteOffset byteStride camera componentType count index"
     " input inverseBindMatrices magFilter material mesh minFilter mode node output sampler"
     " scene skin source texCoord wrapS wrapT "},
    {Type::number, " alphaCutoff metallicFactor roughnessFactor xmag yfov ymag zfar znear "},
    {Type::numbers, " baseColorFactor emissiveFactor matrix rotation translation weights "},
    {Type::number_or_numbers, " scale "},
    {Type::integers, " children joints "},
    {Type::boolean, " doubleSided normalized "},
    {Type::string, " alphaMode interpolation path type uri "},
    {Type::array,
     " accessors animations bufferViews buffers cameras channels extensionsRequired"
     " extensionsUsed images materials meshes nodes primitives samplers scenes skins"
     " targets textures "},
    {Type::object,
     " attributes baseColorTexture emissiveTexture metallicRoughnessTexture normalTexture"
     " orthographic pbrMetallicRoughness perspective sparse "},
};

std::optional<Type> type_of(const std::string& key) {
  for (const TypedMembers& members : kTypes)
    if (members.keys.find(' ' + key + ' ') != members.keys.npos) return members.type;
  return {};
}

bool is_number(const Json& json) { return json.is_number(); }
bool is_index(const Json& json) {
  return json.is_unsigned() && json.get<std::uint64_t>() <= std::uint64_t{std::numeric_limits<int>::max()};
}

template <class Is>
bool all_are(const Json& json, Is is) {
  return json.is_array() && std::all_of(json.elements().begin(), json.elements().end(), is);
}

// How many numbers a member must have; 0: any number.
std::size_t length_of(const std::string& key) {
  if (key == "matrix") return 16;
  if (key == "rotation" || key == "baseColorFactor") return 4;
  return key == "translation" || key == "emissiveFactor" ? 3 : 0;
}

// What a member must be; empty if it is that.
std::string missing_in(const Json::Member& member) {
  const std::optional<Type> type = type_of(member.key);
  if (!type) return "";
  const Json& value = member.value;
  const bool is_size = member.key.starts_with("byte") || member.key == "count";
  switch (*type) {
    case Type::integer:
      if (is_size) return value.is_unsigned() ? "" : "an integer of 0 and up";
      return is_index(value) ? "" : "an integer from 0 to 2147483647";
    case Type::number:
      return value.is_number() ? "" : "a number";
    case Type::numbers:
      if (const std::size_t length = length_of(member.key)) {
        const bool fits = all_are(value, is_number) && value.size() == length;
        return fits ? "" : "an array of " + std::to_string(length) + " numbers";
      }
      return all_are(value, is_number) ? "" : "an array of numbers";
    case Type::number_or_numbers:
      return value.is_number() || all_are(value, is_number) ? "" : "a number or an array of numbers";
    case Type::integers:
      return all_are(value, is_index) ? "" : "an array of integers from 0 to 2147483647";
    case Type::boolean:
      return value == Json(true) || value == Json(false) ? "" : "true or false";
    case Type::string:
      return value.is_string() ? "" : "a string";
    case Type::array:
      return value.is_array() ? "" : "an array";
    case Type::object:
      return value.is_object() ? "" : "an object";
  }
  return "";
}

// Of everything that glTF defines: other members of the file, extras and extensions may use the same names.
void check_types(const Json& json, const Json& root, const std::string& where) {
  if (json.is_array()) {
    for (const Json& element : json.elements()) check_types(element, root, where);
  } else if (json.is_object()) {
    for (const Json::Member& member : json.members()) {
      const bool is_other = &json == &root && !type_of(member.key);
      if (is_other || member.key == "extras" || member.key == "extensions") continue;
      const std::string expected = missing_in(member);
      if (!expected.empty())
        fail_trace(where + ": " + pointer_to(member.value, root), expected, JsonCursor(member.value, where).found());
      check_types(member.value, root, where);
    }
  }
}

// Reads what tinygltf asks for.
struct NamedFiles {
  const ModelFolder& folder;
  const std::string& where;
  std::string error;  // why a file could not be read
};

bool read_named_file(std::vector<unsigned char>* out, std::string* error, const std::string& name, void* user_data) {
  auto& files = *static_cast<NamedFiles*>(user_data);
  try {
    const std::string bytes = files.folder.read(name, files.where);
    out->assign(bytes.begin(), bytes.end());
    return true;
  } catch (const TraceError& failure) {
    *error = files.error = failure.what();
    return false;
  }
}

// Keeps an image's bytes, to be decoded when a material uses it. Those in buffers stay there: tinygltf does not check
// where they are.
bool keep_image(tinygltf::Image* image, const int, std::string*, std::string*, int, int, const unsigned char* bytes,
                int size, void*) {
  if (image->bufferView < 0 && size > 0) image->image.assign(bytes, bytes + size);
  return true;
}

// tinygltf leaves out primitives that it cannot read.
void check_primitives(const Json& root, const GltfFile& file) {
  const Json* meshes = root.find("meshes");
  if (!meshes || !meshes->is_array()) return;
  for (std::size_t i = 0; i < std::min(meshes->size(), file.model.meshes.size()); ++i) {
    const Json* primitives = meshes->at(i).find("primitives");
    if (!primitives || primitives->size() != file.model.meshes[i].primitives.size())
      fail_trace(file.place("meshes", i) + "/primitives", "objects with \"attributes\"", "others");
  }
}

// Before tinygltf reads the file, which may refuse it because of an extension.
void check_extensions(const Json& root, const std::string& where, NotRead& not_read) {
  const auto unread = [&](const char* key) {
    std::vector<std::string> names;
    if (const Json* list = root.find(key)) {
      for (const Json& name : list->elements())
        if (name.is_string() && !kExtensionsRead.contains(name.get<std::string>()))
          names.push_back(name.get<std::string>());
    }
    return names;
  };
  for (const std::string& name : unread("extensionsRequired"))
    fail_trace(where + ": /extensionsRequired", "only extensions that beampipe reads", in_quotes(name));
  for (const std::string& name : unread("extensionsUsed")) not_read["extension " + name] = 1;
}

}  // namespace

std::size_t checked_index(int index, std::size_t count, const std::string& where, const char* of_what) {
  if (index < 0 || static_cast<std::size_t>(index) >= count)
    fail_trace(where, "one of the " + std::to_string(count) + " " + of_what, std::to_string(index));
  return static_cast<std::size_t>(index);
}

GltfFile read_gltf_file(const fs::path& path, bool follow_links, NotRead& not_read) {
  const std::string bytes = read_input_file(path, path.string());
  GltfFile file{ModelFolder(path, follow_links), path.string(), {}};
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
    fail_trace(file.where, "at most 4 GiB", std::to_string(bytes.size() >> 30) + " GiB");
  const bool is_binary = bytes.starts_with("glTF");
  const std::string_view text = is_binary ? json_chunk(bytes, file.where) : bytes;
  // This limits the depth, which tinygltf does not, and says where broken JSON is broken.
  const Json root = parse_json_text(std::string(text), file.where);
  check_types(root, root, file.where);
  const Json* asset = root.find("asset");
  const Json* version = asset ? asset->find("version") : nullptr;
  if (!version || !version->is_string() || !version->get<std::string>().starts_with("2."))
    fail_trace(file.where + ": /asset/version", "glTF of version 2", version ? version->dump() : "none");

  check_extensions(root, file.where, not_read);

  NamedFiles files{file.folder, file.where, ""};
  tinygltf::TinyGLTF reader;
  reader.SetFsCallbacks({.FileExists = [](const std::string&, void*) { return true; },
                         .ExpandFilePath = [](const std::string& name, void*) { return name; },
                         .ReadWholeFile = read_named_file,
                         .WriteWholeFile = nullptr,
                         .user_data = &files});
  reader.SetImageLoader(keep_image, nullptr);
  std::string error, warning;
  const auto size = static_cast<unsigned>(bytes.size());
  bool is_read = false;
  try {
    is_read = is_binary ? reader.LoadBinaryFromMemory(&file.model, &error, &warning,
                                                      reinterpret_cast<const unsigned char*>(bytes.data()), size)
                        : reader.LoadASCIIFromString(&file.model, &error, &warning, bytes.data(), size, "");
  } catch (const std::exception& failure) {
    error = failure.what();
  }
  if (!is_read) {
    if (!files.error.empty()) throw TraceError(files.error);
    fail_trace(file.where, "a glTF 2.0 file",
               "one that tinygltf refuses: " + in_quotes(error.substr(0, error.find('\n'))));
  }
  check_primitives(root, file);
  return file;
}

}  // namespace beampipe
