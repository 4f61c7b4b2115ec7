#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include "traces/files/input_file.h"
#include "traces/files/json.h"
#include "traces/files/model_folder.h"
#include "traces/files/model_import.h"
#include "traces/files/obj_material.h"
#include "traces/files/trace_io.h"
#include "traces/files/triangulate.h"
#include "traces/files/unique_names.h"
#include "traces/files/vertex_frames.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

constexpr glm::vec3 kGrey = kDefaultColor;    // of faces without a material, and of materials without Kd
constexpr std::uint32_t kMostCorners = 4096;  // of a face: triangulating takes the cube of this in the worst case
constexpr std::string_view kBlanks = " \t";

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// Takes a line off the text. It ends with \n, \r\n or \r, as the loader's lines do.
std::string_view take_line(std::string_view& text) {
  const auto end = std::find_if(text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; });
  const std::string_view line(text.begin(), end);
  text.remove_prefix(line.size());
  text.remove_prefix(text.starts_with("\r\n") ? 2 : !text.empty());
  return line;
}

std::string_view take_word(std::string_view& line) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  const auto start = std::find_if_not(line.begin(), line.end(), is_blank);
  const auto end = std::find_if(start, line.end(), is_blank);
  line = {end, line.end()};
  return {start, end};
}

// The whole word is a number, and a float can hold it.
template <class Number>
bool is_number(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  Number value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && std::isfinite(static_cast<float>(value));
}

bool has_numbers(std::string_view line, int count) {
  for (int i = 0; i < count; ++i)
    if (!is_number<double>(take_word(line))) return false;
  return true;
}

// All words are numbers, of which there is at least one.
bool has_only_numbers(std::string_view line) {
  std::string_view word = take_word(line);
  do {
    if (!is_number<double>(word)) return false;
    word = take_word(line);
  } while (!word.empty());
  return true;
}

// "3", "3/1", "3//1", "3/1/1": vertex, texture coordinate, normal.
bool is_corner(std::string_view word) {
  for (int part = 0; part < 3; ++part) {
    const std::string_view index = word.substr(0, word.find('/'));
    if (!is_number<int>(index) && (part == 0 || !index.empty())) return false;
    if (index.size() == word.size()) return true;
    word.remove_prefix(index.size() + 1);
  }
  return false;
}

bool has_only_corners(std::string_view line) {
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line))
    if (!is_corner(word)) return false;
  return true;
}

// What a line must have after its keyword; empty if it has that. Only what is read is checked.
std::string missing_in(std::string_view keyword, std::string_view line, ObjMaterials materials) {
  if ((keyword == "v" || keyword == "Kd") && !has_numbers(line, 3)) return "three finite numbers";
  if (keyword == "f" && !has_only_corners(line)) return "corners such as 3, 3/1, 3//1 or 3/1/1";
  if (materials == ObjMaterials::none) return "";
  if ((keyword == "vn" || keyword == "Ks" || keyword == "Ke") && !has_numbers(line, 3)) return "three finite numbers";
  if (keyword == "vt" && !has_only_numbers(line)) return "one to three finite numbers";
  for (std::string_view single : {"Ns", "d", "Tr", "Pr", "Pm"})
    if (keyword == single && !has_numbers(line, 1)) return "a finite number";
  return "";
}

// The loader reads "nan", "1,5" and missing coordinates as 0, and "3x" and 2^32 + 3 as 3. Such lines are found here,
// and the loader reads a text only after this check.
void check_lines(std::string_view text, const std::string& where, ObjMaterials materials) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view whole = take_line(text);
    std::string_view line = whole;
    const std::string_view keyword = take_word(line);
    const std::string expected = missing_in(keyword, line, materials);
    if (expected.empty()) continue;
    fail_trace(where + ": line " + std::to_string(number), expected + " after " + in_quotes(keyword),
               in_quotes(trim(whole)));
  }
}

// Counts the lines whose keyword is not in the list.
void count_not_read(std::string_view text, std::initializer_list<std::string_view> read, NotRead& not_read) {
  while (!text.empty()) {
    std::string_view line = take_line(text);
    const std::string_view keyword = take_word(line);
    if (keyword.empty() || keyword.starts_with('#')) continue;
    if (std::find(read.begin(), read.end(), keyword) == read.end()) ++not_read[std::string(keyword)];
  }
}

// The colours of vertices that a widespread extension puts after the coordinates; empty unless all vertices have one.
std::vector<glm::vec3> vertex_colors(std::string_view text) {
  std::vector<glm::vec3> colors;
  while (!text.empty()) {
    std::string_view line = take_line(text);
    if (take_word(line) != "v") continue;
    for (int i = 0; i < 3; ++i) take_word(line);
    if (!has_numbers(line, 3)) return {};
    glm::vec3& color = colors.emplace_back();
    for (int i = 0; i < 3; ++i) {
      const std::string_view word = take_word(line);
      std::from_chars(word.data() + word.starts_with('+'), word.data() + word.size(), color[i]);
    }
    color = glm::clamp(color, 0.0f, 1.0f);
  }
  return colors;
}

bool is_finite(const glm::vec2& v) { return std::isfinite(v.x) && std::isfinite(v.y); }
bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

glm::vec3 kd_of(const tinyobj::material_t* material) {
  return material ? glm::vec3(material->diffuse[0], material->diffuse[1], material->diffuse[2]) : kGrey;
}

// A whole OBJ or material library, without the byte order mark with which some editors start UTF-8.
std::string read_text(const fs::path& file, const std::string& where, ObjMaterials materials) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::string text = read_input_file(file, where);
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  check_lines(text, where, materials);
  return text;
}

// The loader gives a material without Kd black or 0.6 grey, depending on its maps and on the materials before it. So
// each starts with the Kd that the trace format has where there is none.
std::string with_default_kd(std::string_view text) {
  std::ostringstream with;
  while (!text.empty()) {
    std::string_view line = take_line(text);
    with << line << "\n";
    if (take_word(line) == "newmtl") with << "Kd " << kGrey.r << " " << kGrey.g << " " << kGrey.b << "\n";
  }
  return with.str();
}

// "my\ room.mtl", as some programs write names with blanks, is "my room.mtl".
std::string without_escapes(std::string_view name) {
  std::string plain;
  for (std::size_t i = 0; i < name.size(); ++i)
    if (!name.substr(i).starts_with("\\ ")) plain += name[i];
  return plain;
}

// The material libraries that an OBJ names.
class Libraries {
 public:
  Libraries(const ModelFolder& folder, const std::string& where, ObjMaterials materials, NotRead& not_read)
      : folder_(folder), where_(where), materials_(materials), not_read_(not_read) {}

  // Reads those of all mtllib lines. Such a line has one name, in which blanks may be, or several names.
  void read_all(std::string_view obj_text) {
    while (!obj_text.empty()) {
      std::string_view line = take_line(obj_text);
      if (take_word(line) != "mtllib") continue;
      const std::string whole = without_escapes(trim(line));
      if (is_there(whole)) {
        read(whole);
        continue;
      }
      std::vector<std::string> missing;
      bool has_any = false;
      for (std::string_view name = take_word(line); !name.empty(); name = take_word(line)) {
        const bool was_read = read(std::string(name));
        has_any |= was_read;
        if (!was_read) missing.emplace_back(name);
      }
      if (!has_any && !missing.empty()) missing = {whole};  // whether it is one name or several
      missing_.insert(missing.begin(), missing.end());
    }
  }

  // Null if no library has it.
  const tinyobj::material_t* find(std::string_view material) {
    const std::string_view name = trim(material);
    const auto found = by_name_.find(name);
    if (found != by_name_.end()) return &found->second;
    if (!name.empty()) unknown_.emplace(name);
    return nullptr;
  }

  // Counts the libraries that are missing, and the materials that were asked for and are in none.
  void count_missing() {
    for (const std::string& name : missing_) ++not_read_["mtllib " + name + " (missing)"];
    if (unknown_.empty()) return;
    std::string names = *unknown_.begin();
    if (unknown_.size() > 1) names += " and " + std::to_string(unknown_.size() - 1) + " more";
    ++not_read_["usemtl " + names + " (in no mtllib)"];
  }

 private:
  bool is_there(const std::string& name) const {
    std::error_code ignored;
    try {
      return !name.empty() && fs::is_regular_file(folder_.file(name, where_), ignored);
    } catch (const TraceError&) {  // several names together may be too long for one, or leave the folder
      return false;
    }
  }

  // False if there is no such file.
  bool read(const std::string& name) {
    const fs::path file = folder_.file(name, where_);
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return false;
    if (files_.insert(file).second) read(file, where_ + ": " + name);
    return true;
  }

  void read(const fs::path& file, const std::string& where) {
    const std::string bytes = read_text(file, where, materials_);
    if (materials_ != ObjMaterials::none) {
      count_not_read(bytes,
                     {"newmtl", "Kd", "Ks", "Ns", "Ke", "d", "Tr", "Pr", "Pm", "map_Kd", "map_Ke", "map_d", "map_Bump",
                      "map_bump", "bump", "norm"},
                     not_read_);
    }
    std::stringstream text(with_default_kd(bytes));
    std::map<std::string, int> index;
    std::vector<tinyobj::material_t> materials;
    std::string warning, error;
    tinyobj::LoadMtl(&index, &materials, &text, &warning, &error);
    for (tinyobj::material_t& material : materials) {
      const glm::vec3 kd = kd_of(&material);
      if (!is_finite(kd) || glm::clamp(kd, 0.0f, kMostColor) != kd) {
        fail_trace(where, "Kd from 0 to 65504", "another one in material " + in_quotes(material.name));
      }
      by_name_.emplace(trim(material.name), std::move(material));
    }
  }

  const ModelFolder& folder_;
  std::string where_;
  ObjMaterials materials_;
  NotRead& not_read_;
  std::set<fs::path> files_;
  std::set<std::string> missing_, unknown_;  // names of libraries and of materials
  std::map<std::string, tinyobj::material_t, std::less<>> by_name_;
};

// Indices into the file's lists, counted from 0 and not checked yet. -1: the corner has none.
struct Corner {
  std::int64_t position, uv, normal;
};

// What the loader's callbacks collect: polygons of any size, in the order of the file.
struct Polygons {
  explicit Polygons(Libraries& all) : libraries(all) {}

  Libraries& libraries;
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec2> uvs;
  std::vector<Corner> corners;  // of all polygons
  std::vector<std::uint32_t> sizes;
  std::vector<const tinyobj::material_t*> materials;  // null: none
  const tinyobj::material_t* material = nullptr;
};

Polygons& polygons(void* user_data) { return *static_cast<Polygons*>(user_data); }

// The file counts from 1 up, or from -1 down, which is the last element so far. 0 becomes -1 here.
std::int64_t from_zero(std::int64_t named, std::size_t so_far) {
  return named < 0 ? static_cast<std::int64_t>(so_far) + named : named - 1;
}

void add_polygon(void* user_data, tinyobj::index_t* indices, int count) {
  Polygons& out = polygons(user_data);
  for (int i = 0; i < count; ++i) {
    out.corners.push_back({from_zero(indices[i].vertex_index, out.positions.size()),
                           from_zero(indices[i].texcoord_index, out.uvs.size()),
                           from_zero(indices[i].normal_index, out.normals.size())});
  }
  out.sizes.push_back(static_cast<std::uint32_t>(count));
  out.materials.push_back(out.material);
}

Polygons load(std::istream& text, Libraries& libraries, ObjMaterials materials) {
  using tinyobj::real_t;
  tinyobj::callback_t callback;
  callback.vertex_cb = [](void* out, real_t x, real_t y, real_t z, real_t) {
    polygons(out).positions.emplace_back(x, y, z);
  };
  callback.index_cb = add_polygon;
  callback.usemtl_cb = [](void* out, const char* name, int) {
    polygons(out).material = polygons(out).libraries.find(name);
  };
  if (materials != ObjMaterials::none) {
    callback.normal_cb = [](void* out, real_t x, real_t y, real_t z) { polygons(out).normals.emplace_back(x, y, z); };
    // v is 0 at the bottom of the image, and in a trace on top.
    callback.texcoord_cb = [](void* out, real_t u, real_t v, real_t) { polygons(out).uvs.emplace_back(u, 1 - v); };
  }
  Polygons out(libraries);
  tinyobj::LoadObjWithCallback(text, callback, &out);
  return out;
}

void check_corner(const Corner& corner, const Polygons& polygons, ObjMaterials materials, const std::string& face,
                  std::uint32_t number) {
  const auto check = [&](std::int64_t index, std::size_t count, const char* things) {
    if (index >= 0 && index < static_cast<std::int64_t>(count)) return;
    fail_trace(face, "indices of the " + std::to_string(count) + " " + things + ", from 1 up or from -1 down",
               "another one at corner " + std::to_string(number));
  };
  check(corner.position, polygons.positions.size(), "vertices");
  if (materials == ObjMaterials::none) return;
  if (corner.uv != -1) check(corner.uv, polygons.uvs.size(), "texture coordinates");
  if (corner.normal != -1) check(corner.normal, polygons.normals.size(), "normals");
}

// Makes vertices of corners: a vertex has a position, a texture coordinate and a normal. A corner without a normal
// shares its vertex only with corners of its own face, whose normal it takes.
class Vertices {
 public:
  Vertices(const Polygons& from, std::vector<glm::vec3> colors, Mesh& mesh)
      : from_(from), colors_(std::move(colors)), mesh_(mesh) {}

  // `face_normal` is what a vertex without a normal gets.
  std::uint32_t add(const Corner& corner, std::int64_t face, const glm::vec3& face_normal) {
    const Key key{corner.position, corner.uv, corner.normal, corner.normal < 0 ? face : -1};
    const auto [found, is_new] = numbers_.try_emplace(key, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (!is_new) return found->second;
    const auto position = static_cast<std::size_t>(corner.position);
    mesh_.positions.push_back(from_.positions[position]);
    mesh_.normals.push_back(corner.normal < 0 ? face_normal
                                              : unit_or_zero(from_.normals[static_cast<std::size_t>(corner.normal)]));
    mesh_.uvs[0].push_back(corner.uv < 0 ? glm::vec2(0.0f) : from_.uvs[static_cast<std::size_t>(corner.uv)]);
    if (!colors_.empty()) mesh_.vertex_colors.emplace_back(colors_[position], 1.0f);
    return found->second;
  }

 private:
  using Key = std::array<std::int64_t, 4>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t hash = 0;
      for (std::int64_t part : key) hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15u;
      return hash ^ hash >> 32;
    }
  };

  const Polygons& from_;
  std::vector<glm::vec3> colors_;
  Mesh& mesh_;
  std::unordered_map<Key, std::uint32_t, Hash> numbers_;
};

// +z if the triangle has no area.
glm::vec3 flat_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::vec3 normal = unit_or_zero(glm::cross(b - a, c - a));
  return normal == glm::vec3(0.0f) ? glm::vec3(0, 0, 1) : normal;
}

// Adds the materials of polygons to a trace, each once.
class MaterialsInUse {
 public:
  MaterialsInUse(ObjMaterials wanted, ObjMaterialReader reader, Trace& trace)
      : wanted_(wanted), reader_(std::move(reader)), trace_(trace) {}

  // kNoMaterial if the polygon's triangles are to be flat.
  std::uint32_t index_of(const tinyobj::material_t* material) {
    const bool is_real = wanted_ == ObjMaterials::all ||
                         (wanted_ == ObjMaterials::textured && material != nullptr && has_map(*material));
    if (!is_real) return kNoMaterial;
    const auto found = indices_.find(material);
    if (found != indices_.end()) return found->second;
    return indices_[material] = material != nullptr ? reader_.add(*material) : add_grey();
  }

 private:
  std::uint32_t add_grey() {
    Material grey;
    grey.base_color = glm::vec4(kGrey, 1.0f);
    grey.double_sided = true;
    trace_.materials.push_back(grey);
    return static_cast<std::uint32_t>(trace_.materials.size() - 1);
  }

  ObjMaterials wanted_;
  ObjMaterialReader reader_;
  Trace& trace_;
  std::map<const tinyobj::material_t*, std::uint32_t> indices_;
};

// Mends normals, and adds the tangents that normal maps need.
void complete(Mesh& mesh, const Trace& trace, NotRead& not_read) {
  if (const std::size_t mended = mend_normals(mesh)) not_read["normal without a length"] += mended;
  bool has_normal_map = false;
  for (std::uint32_t material : mesh.materials)
    has_normal_map |= material != kNoMaterial && trace.materials[material].normal_texture;
  if (has_normal_map) add_tangents(mesh, 0);
}

// In small letters, with its dot.
std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return extension;
}

}  // namespace

bool is_obj_file(const std::filesystem::path& file) { return extension_of(file) == ".obj"; }

bool is_model_file(const std::filesystem::path& file) {
  return is_obj_file(file) || extension_of(file) == ".gltf" || extension_of(file) == ".glb";
}

void read_obj(const fs::path& file, const ObjOptions& options, Trace& trace, NotRead& not_read) {
  const ObjMaterials materials = options.materials;
  const std::string where = (options.named_by.empty() ? "" : options.named_by + ": ") + file.string();
  std::string bytes = read_text(file, where, materials);
  std::vector<glm::vec3> colors;
  if (materials != ObjMaterials::none) {
    colors = vertex_colors(bytes);
    count_not_read(bytes, {"v", "vt", "vn", "f", "usemtl", "mtllib", "o", "g", "s"}, not_read);
  }
  const ModelFolder folder(file, options.follow_links);
  Libraries libraries(folder, where, materials, not_read);
  libraries.read_all(bytes);
  std::stringstream text(std::move(bytes));
  const Polygons polygons = load(text, libraries, materials);
  if (materials != ObjMaterials::none) libraries.count_missing();
  if (polygons.sizes.empty()) fail_trace(where, "at least one face", "none");

  // The loader computes 0e500 as 0 times infinity, which is not a number.
  const auto check_finite = [&](const auto& vectors, const char* what) {
    const auto odd = std::find_if_not(vectors.begin(), vectors.end(), [](const auto& v) { return is_finite(v); });
    if (odd != vectors.end())
      fail_trace(where + ": " + what + " " + std::to_string(odd - vectors.begin() + 1), "finite numbers", "others");
  };
  check_finite(polygons.positions, "vertex");
  check_finite(polygons.normals, "normal");
  check_finite(polygons.uvs, "texture coordinate");

  MaterialsInUse in_use(materials, ObjMaterialReader(folder, where, trace, not_read), trace);
  std::vector<std::uint32_t> indices;  // of the polygons' materials
  for (const tinyobj::material_t* material : polygons.materials) indices.push_back(in_use.index_of(material));
  const bool is_flat = std::all_of(indices.begin(), indices.end(), [](auto index) { return index == kNoMaterial; });

  Mesh mesh;
  mesh.name = file.stem().string();
  if (is_flat) mesh.positions = polygons.positions;
  Vertices vertices(polygons, std::move(colors), mesh);
  std::vector<glm::vec3> corners;
  const Corner* first = polygons.corners.data();
  for (std::size_t i = 0; i < polygons.sizes.size(); first += polygons.sizes[i], ++i) {
    const std::string face = where + ": face " + std::to_string(i + 1);
    const std::uint32_t size = polygons.sizes[i];
    if (size < 3) fail_trace(face, "three or more corners", std::to_string(size));
    if (size > kMostCorners)
      fail_trace(face, "at most " + std::to_string(kMostCorners) + " corners", std::to_string(size));
    corners.clear();
    for (std::uint32_t k = 0; k < size; ++k) {
      check_corner(first[k], polygons, materials, face, k + 1);
      corners.push_back(polygons.positions[static_cast<std::size_t>(first[k].position)]);
    }
    for (const glm::uvec3& t : triangulate(corners)) {
      const glm::vec3 normal = flat_normal(corners[t.x], corners[t.y], corners[t.z]);
      glm::uvec3& triangle = mesh.triangles.emplace_back();
      for (int k = 0; k < 3; ++k) {
        const Corner& corner = first[t[k]];
        triangle[k] = is_flat ? static_cast<std::uint32_t>(corner.position)
                              : vertices.add(corner, static_cast<std::int64_t>(i), normal);
      }
      mesh.colors.push_back(kd_of(polygons.materials[i]));
      if (!is_flat) mesh.materials.push_back(indices[i]);
    }
  }
  if (!is_flat) complete(mesh, trace, not_read);
  make_names_unique(trace.images, "image");
  make_names_unique(trace.materials, "material");
  trace.meshes.push_back(std::move(mesh));
}

}  // namespace beampipe
