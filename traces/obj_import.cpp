#include <tiny_obj_loader.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>
#include <string_view>

#include "traces/input_file.h"
#include "traces/json.h"
#include "traces/trace_io.h"
#include "traces/triangulate.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

constexpr glm::vec3 kGrey{0.8f};              // of faces without a material
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

bool has_three_numbers(std::string_view line) {
  for (int i = 0; i < 3; ++i)
    if (!is_number<double>(take_word(line))) return false;
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

// The loader reads "nan", "1,5" and missing coordinates as 0, and "3x" and 2^32 + 3 as 3. Such lines are found here,
// and the loader reads a text only after this check.
void check_lines(std::string_view text, const std::string& where) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view whole = take_line(text);
    std::string_view line = whole;
    const std::string_view keyword = take_word(line);
    std::string expected;
    if ((keyword == "v" || keyword == "Kd") && !has_three_numbers(line)) expected = "three finite numbers";
    if (keyword == "f" && !has_only_corners(line)) expected = "corners such as 3, 3/1, 3//1 or 3/1/1";
    if (expected.empty()) continue;
    fail_trace(where + ": line " + std::to_string(number), expected + " after " + in_quotes(keyword),
               in_quotes(trim(whole)));
  }
}

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// A whole OBJ or material library, without the byte order mark with which some editors start UTF-8.
std::stringstream read_text(const fs::path& file, const std::string& where) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::string text = read_input_file(file, where);
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  check_lines(text, where);
  return std::stringstream(std::move(text));
}

// Reads the material libraries that an OBJ names, which must be in the OBJ's own folder.
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
    read(file, where_ + ": " + name);
    return true;
  }

  glm::vec3 kd(std::string_view material) const {
    const auto found = kd_.find(trim(material));
    return found == kd_.end() ? kGrey : found->second;
  }

 private:
  void read(const fs::path& file, const std::string& where) {
    std::stringstream text = read_text(file, where);
    std::map<std::string, int> index;
    std::vector<tinyobj::material_t> materials;
    std::string warning, error;
    tinyobj::LoadMtl(&index, &materials, &text, &warning, &error);
    for (const tinyobj::material_t& material : materials) {
      const glm::vec3 kd(material.diffuse[0], material.diffuse[1], material.diffuse[2]);
      if (!is_finite(kd) || glm::any(glm::lessThan(kd, glm::vec3(0.0f)))) {
        fail_trace(where, "finite Kd of 0 and up", "another one in material " + in_quotes(material.name));
      }
      kd_.emplace(trim(material.name), kd);
    }
  }

  fs::path obj_;
  std::string where_;
  std::map<std::string, glm::vec3, std::less<>> kd_;
};

// What the loader's callbacks collect: polygons of any size, in the order of the file.
struct Polygons {
  explicit Polygons(Materials& library) : materials(library) {}

  Materials& materials;
  std::vector<glm::vec3> positions;
  std::vector<std::int64_t> corners;  // vertices of all polygons, counted from 0; not checked yet
  std::vector<std::uint32_t> sizes;
  std::vector<glm::vec3> colors;
  glm::vec3 color = kGrey;
};

Polygons& polygons(void* user_data) { return *static_cast<Polygons*>(user_data); }

void add_polygon(void* user_data, tinyobj::index_t* indices, int count) {
  Polygons& out = polygons(user_data);
  for (int i = 0; i < count; ++i) {
    // The file counts vertices from 1 up, or from -1 down, which is the last vertex so far. 0 becomes -1 here.
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
  std::stringstream text = read_text(file, where);
  Materials materials(file, where);
  Polygons polygons = load(text, materials);
  if (polygons.sizes.empty()) fail_trace(where, "at least one face", "none");

  Mesh mesh;
  mesh.name = file.stem().string();
  mesh.positions = std::move(polygons.positions);
  const auto vertices = static_cast<std::int64_t>(mesh.positions.size());
  // The loader computes 0e500 as 0 times infinity, which is not a number.
  const auto odd = std::find_if_not(mesh.positions.begin(), mesh.positions.end(), is_finite);
  if (odd != mesh.positions.end()) {
    fail_trace(where + ": vertex " + std::to_string(odd - mesh.positions.begin() + 1), "finite numbers", "others");
  }
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
