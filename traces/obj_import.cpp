#include <tiny_obj_loader.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string_view>

#include "traces/json_cursor.h"
#include "traces/trace_io.h"
#include "traces/triangulate.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

constexpr glm::vec3 kGrey{0.8f};              // of faces without a material
constexpr std::uint32_t kMostCorners = 4096;  // of a face: finding its triangles takes their cube in the worst case
constexpr std::string_view kBlanks = " \t\r";

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string_view take_word(std::string_view& line) {
  line = trim(line);
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

bool is_finite_float(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && std::isfinite(static_cast<float>(value));
}

// The loader reads "nan", "1,5" and missing coordinates as 0, so that they must be found before.
void check_numbers(std::string_view text, std::string_view keyword, const std::string& where) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view whole = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(whole.size() + 1, text.size()));
    std::string_view line = whole;
    if (take_word(line) != keyword) continue;
    for (int i = 0; i < 3; ++i) {
      if (is_finite_float(take_word(line))) continue;
      fail_trace(where + ": line " + std::to_string(number),
                 "three finite numbers after \"" + std::string(keyword) + "\"", in_quotes(trim(whole)));
    }
  }
}

// Reads the material libraries that an OBJ names; only from the OBJ's own folder.
class Materials : public tinyobj::MaterialReader {
 public:
  Materials(const fs::path& obj, const std::string& where) : obj_(obj), where_(where) {}

  bool operator()(const std::string& name, std::vector<tinyobj::material_t>*, std::map<std::string, int>*, std::string*,
                  std::string*) override {
    const fs::path folder = fs::canonical(obj_).parent_path();
    std::error_code error;
    const fs::path file = fs::weakly_canonical(folder / name, error);
    const fs::path relative = file.lexically_relative(folder);
    if (error || relative.empty() || *relative.begin() == ".." || fs::path(name).is_absolute()) {
      fail_trace(where_, "an mtllib in the OBJ's folder", in_quotes(name));
    }
    if (!fs::exists(file, error)) return false;
    require_input_file(file, where_ + ": " + name);
    std::stringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    read(text, where_ + ": " + name);
    return true;
  }

  glm::vec3 kd(std::string_view material) const {
    const auto found = kd_.find(trim(material));
    return found == kd_.end() ? kGrey : found->second;
  }

 private:
  void read(std::stringstream& text, const std::string& where) {
    check_numbers(text.view(), "Kd", where);
    std::map<std::string, int> index;
    std::vector<tinyobj::material_t> materials;
    std::string warning, error;
    tinyobj::LoadMtl(&index, &materials, &text, &warning, &error);
    for (const tinyobj::material_t& material : materials) {
      const glm::vec3 kd(material.diffuse[0], material.diffuse[1], material.diffuse[2]);
      if (glm::any(glm::lessThan(kd, glm::vec3(0.0f)))) {
        fail_trace(where, "a Kd of 0 and up", "a negative one in material " + in_quotes(material.name));
      }
      kd_.emplace(trim(material.name), kd);
    }
  }

  fs::path obj_;
  std::string where_;
  std::map<std::string, glm::vec3, std::less<>> kd_;
};

// What the loader's callbacks collect: polygons of any size, one after the other.
struct Polygons {
  explicit Polygons(Materials& library) : materials(library) {}

  Materials& materials;
  std::vector<glm::vec3> positions;
  std::vector<std::int64_t> corners;  // from 0, not yet checked
  std::vector<std::uint32_t> sizes;
  std::vector<glm::vec3> colors;
  glm::vec3 color = kGrey;
};

Polygons& polygons(void* user_data) { return *static_cast<Polygons*>(user_data); }

void add_polygon(void* user_data, tinyobj::index_t* indices, int count) {
  Polygons& out = polygons(user_data);
  for (int i = 0; i < count; ++i) {
    // Counted from 1, or backwards from the last vertex so far; 0 and what is not a number become -1.
    const std::int64_t named = indices[i].vertex_index;
    out.corners.push_back(named < 0 ? static_cast<std::int64_t>(out.positions.size()) + named : named - 1);
  }
  out.sizes.push_back(static_cast<std::uint32_t>(count));
  out.colors.push_back(out.color);
}

Polygons load(std::istream& text, Materials& materials) {
  tinyobj::callback_t callback;
  callback.vertex_cb = [](void* out, tinyobj::real_t x, tinyobj::real_t y, tinyobj::real_t z, tinyobj::real_t) {
    polygons(out).positions.emplace_back(x, y, z);
  };
  callback.index_cb = add_polygon;
  callback.usemtl_cb = [](void* out, const char* name, int) { polygons(out).color = polygons(out).materials.kd(name); };
  Polygons out(materials);
  tinyobj::LoadObjWithCallback(text, callback, &out, &materials);
  return out;
}

}  // namespace

Mesh read_obj(const fs::path& file, const std::string& named_by) {
  const std::string where = (named_by.empty() ? "" : named_by + ": ") + file.string();
  require_input_file(file, where);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail_trace(where, "a readable file", "none");
  std::stringstream text;
  text << stream.rdbuf();
  check_numbers(text.view(), "v", where);
  Materials materials(file, where);
  Polygons polygons = load(text, materials);
  if (polygons.sizes.empty()) fail_trace(where, "at least one face", "none");

  Mesh mesh;
  mesh.name = file.stem().string();
  mesh.positions = std::move(polygons.positions);
  const auto vertices = static_cast<std::int64_t>(mesh.positions.size());
  std::vector<glm::vec3> corners;
  const std::int64_t* first = polygons.corners.data();
  for (std::size_t i = 0; i < polygons.sizes.size(); first += polygons.sizes[i], ++i) {
    const std::string face = where + ": face " + std::to_string(i + 1);
    const std::uint32_t size = polygons.sizes[i];
    if (size < 3) fail_trace(face, "three or more corners", std::to_string(size));
    if (size > kMostCorners)
      fail_trace(face, "at most " + std::to_string(kMostCorners) + " corners", std::to_string(size));
    corners.clear();
    for (std::uint32_t k = 0; k < size; ++k) {
      if (first[k] < 0 || first[k] >= vertices) {
        fail_trace(face, "indices of the " + std::to_string(vertices) + " vertices, from 1 up or from -1 down",
                   "another one at corner " + std::to_string(k + 1));
      }
      corners.push_back(mesh.positions[static_cast<std::size_t>(first[k])]);
    }
    for (const glm::uvec3& t : triangulate(corners)) {
      mesh.triangles.emplace_back(first[t.x], first[t.y], first[t.z]);
      mesh.colors.push_back(polygons.colors[i]);
    }
  }
  return mesh;
}

}  // namespace beampipe
