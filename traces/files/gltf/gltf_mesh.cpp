#include "traces/files/gltf/gltf_mesh.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "traces/files/gltf/gltf_accessor.h"
#include "traces/files/input_file.h"
#include "traces/files/vertex_frames.h"

namespace beampipe {
namespace {

constexpr std::size_t kMostVertices = std::size_t{1} << 28;  // of a primitive

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

class PrimitiveReader {
 public:
  PrimitiveReader(const GltfFile& file, const tinygltf::Primitive& from, const std::string& where, GltfBudget& budget,
                  NotRead& not_read)
      : file_(file), from_(from), where_(where), budget_(budget), not_read_(not_read) {}

  // False if it makes no triangles.
  bool read_triangles(GltfPrimitive& to) {
    if (from_.mode < TINYGLTF_MODE_TRIANGLES || from_.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      if (from_.mode < 0 || from_.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        fail_trace(where_ + "/mode", "a mode from 0 to 6", std::to_string(from_.mode));
      ++not_read_[from_.mode == TINYGLTF_MODE_POINTS ? "primitive of points" : "primitive of lines"];
      return false;
    }
    if (!has("POSITION")) {
      ++not_read_["primitive without POSITION"];
      return false;
    }
    const GltfAccessor positions = accessor("POSITION", "VEC3");
    count_ = positions.count();
    if (count_ > kMostVertices) fail_trace(positions.where(), "at most 2^28 vertices", std::to_string(count_));
    make_triangles(to.mesh);
    if (to.mesh.triangles.empty()) {
      ++not_read_["primitive without a triangle"];
      return false;
    }
    return true;
  }

  bool has(const std::string& name) const { return from_.attributes.contains(name); }

  // Gives each triangle vertices of its own. To be called before vertices are read.
  void split_vertices(Mesh& mesh) {
    std::vector<std::uint32_t> all;
    budget_.take(mesh.triangles.size(), 3);
    for (glm::uvec3& t : mesh.triangles) {
      const auto first = static_cast<std::uint32_t>(all.size());
      for (int i = 0; i < 3; ++i) all.push_back(used_[t[i]]);
      t = {first, first + 1, first + 2};
    }
    used_ = std::move(all);
  }

  void read_vertices(GltfPrimitive& to) {
    Mesh& mesh = to.mesh;
    mesh.positions =
        vectors<glm::vec3>("POSITION", "VEC3", [](const GltfAccessor& a, std::size_t i) { return a.vec3(i); });
    mesh.normals = vectors<glm::vec3>("NORMAL", "VEC3",
                                      [](const GltfAccessor& a, std::size_t i) { return unit_or_zero(a.vec3(i)); });
    if (const std::size_t mended = mend_normals(mesh)) not_read_["normal without a length"] += mended;
    if (!mesh.normals.empty()) {  // otherwise glTF asks to ignore tangents
      mesh.tangents = vectors<glm::vec4>("TANGENT", "VEC4", [](const GltfAccessor& a, std::size_t i) {
        return glm::vec4(unit_or_zero(a.vec3(i)), a.number(i, 3) < 0 ? -1.0f : 1.0f);
      });
      const bool broken = std::any_of(mesh.tangents.begin(), mesh.tangents.end(),
                                      [](const glm::vec4& t) { return glm::vec3(t) == glm::vec3(0.0f); });
      if (broken) {
        ++not_read_["TANGENT with vectors without a length"];
        mesh.tangents.clear();
      }
    }
    for (int set = 0; set < 2; ++set) {
      mesh.uvs[set] = vectors<glm::vec2>(
          "TEXCOORD_" + std::to_string(set), "VEC2",
          [](const GltfAccessor& a, std::size_t i) { return glm::vec2(a.number(i, 0), a.number(i, 1)); });
    }
    mesh.vertex_colors = vectors<glm::vec4>("COLOR_0", "VEC3 or VEC4", [](const GltfAccessor& a, std::size_t i) {
      return glm::clamp(a.vec4(i), 0.0f, 1.0f);
    });
    for (const auto& [name, index] : from_.attributes) {
      const bool known = name == "POSITION" || name == "NORMAL" || name == "TANGENT" || name == "TEXCOORD_0" ||
                         name == "TEXCOORD_1" || name == "COLOR_0" || name.starts_with("JOINTS_") ||
                         name.starts_with("WEIGHTS_");
      if (!known) ++not_read_["attribute " + name];
    }
  }

  void read_targets(GltfPrimitive& to) {
    for (std::size_t t = 0; t < from_.targets.size(); ++t) {
      GltfPrimitive::Target& target = to.targets.emplace_back();
      for (const auto& [name, index] : from_.targets[t]) {
        std::vector<glm::vec3>* const list = name == "POSITION"  ? &target.positions
                                             : name == "NORMAL"  ? &target.normals
                                             : name == "TANGENT" ? &target.tangents
                                                                 : nullptr;
        if (!list) {
          ++not_read_["morphed " + name];
          continue;
        }
        *list = read<glm::vec3>(GltfAccessor(file_, index, "VEC3", where_ + "/targets/" + std::to_string(t)),
                                [](const GltfAccessor& a, std::size_t i) { return a.vec3(i); });
      }
    }
  }

  void read_influences(GltfPrimitive& to) {
    for (int set = 0; has("JOINTS_" + std::to_string(set)); ++set) {
      const std::string joints = "JOINTS_" + std::to_string(set), weights = "WEIGHTS_" + std::to_string(set);
      if (!has(weights)) fail_trace(where_ + "/attributes", weights + " beside " + joints, "none");
      GltfPrimitive::Influences& influences = to.influences.emplace_back();
      influences.joints = vectors<glm::uvec4>(joints, "VEC4", [](const GltfAccessor& a, std::size_t i) {
        if (!a.holds_indices()) fail_trace(a.where(), "unsigned integers", "others");
        return glm::uvec4(a.integer(i, 0), a.integer(i, 1), a.integer(i, 2), a.integer(i, 3));
      });
      influences.weights =
          vectors<glm::vec4>(weights, "VEC4", [](const GltfAccessor& a, std::size_t i) { return a.vec4(i); });
    }
  }

 private:
  GltfAccessor accessor(const std::string& name, const std::string& type) const {
    return GltfAccessor(file_, from_.attributes.at(name), type, where_ + "/attributes/" + name);
  }

  // The elements of the vertices that triangles use.
  template <class Vector, class Get>
  std::vector<Vector> read(const GltfAccessor& from, Get get) {
    if (from.count() != count_) {
      fail_trace(from.where(), std::to_string(count_) + " elements, as POSITION has", std::to_string(from.count()));
    }
    budget_.take(used_.size(), static_cast<std::size_t>(from.components()));
    std::vector<Vector> vectors;
    vectors.reserve(used_.size());
    for (std::uint32_t i : used_) vectors.push_back(get(from, i));
    return vectors;
  }

  // The same for an attribute; empty if the primitive does not have it.
  template <class Vector, class Get>
  std::vector<Vector> vectors(const std::string& name, const std::string& type, Get get) {
    return has(name) ? read<Vector>(accessor(name, type), get) : std::vector<Vector>();
  }

  void make_triangles(Mesh& mesh) {
    std::optional<GltfAccessor> indices;
    if (from_.indices >= 0) {
      indices.emplace(file_, from_.indices, "SCALAR", where_ + "/indices");
      if (!indices->holds_indices()) fail_trace(indices->where(), "unsigned integers", "others");
    }
    const std::size_t corners = indices ? indices->count() : count_;
    const auto vertex = [&](std::size_t i) {
      const std::uint32_t index = indices ? indices->integer(i) : static_cast<std::uint32_t>(i);
      if (index >= count_) {
        fail_trace(indices->where(), "indices of " + std::to_string(count_) + " vertices",
                   std::to_string(index) + " in element " + std::to_string(i));
      }
      return index;
    };
    const bool is_list = from_.mode == TINYGLTF_MODE_TRIANGLES;
    const std::size_t triangles = is_list ? corners / 3 : corners < 3 ? 0 : corners - 2;
    if (is_list && corners % 3 != 0) ++not_read_["triangle that lacks a corner"];
    budget_.take(triangles, 7);  // corners, a colour and a material
    mesh.triangles.reserve(triangles);
    for (std::size_t i = 0; i < triangles; ++i) {
      if (is_list) {
        mesh.triangles.emplace_back(vertex(3 * i), vertex(3 * i + 1), vertex(3 * i + 2));
      } else if (from_.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        mesh.triangles.emplace_back(vertex(i), vertex(i + 1 + i % 2), vertex(i + 2 - i % 2));
      } else {
        mesh.triangles.emplace_back(vertex(i + 1), vertex(i + 2), vertex(0));
      }
    }
    renumber(mesh);
  }

  // Vertices that no triangle uses are left out, because some files share one list of vertices among all primitives.
  void renumber(Mesh& mesh) {
    if (count_ > 3 * mesh.triangles.size()) {  // the list may be far longer than what is used of it
      for (const glm::uvec3& t : mesh.triangles) used_.insert(used_.end(), {t.x, t.y, t.z});
      std::sort(used_.begin(), used_.end());
      used_.erase(std::unique(used_.begin(), used_.end()), used_.end());
    } else {
      std::vector<bool> is_used(count_, false);
      for (const glm::uvec3& t : mesh.triangles)
        for (int i = 0; i < 3; ++i) is_used[t[i]] = true;
      for (std::size_t i = 0; i < count_; ++i)
        if (is_used[i]) used_.push_back(static_cast<std::uint32_t>(i));
    }
    if (used_.size() == count_) return;
    for (glm::uvec3& t : mesh.triangles) {
      for (int i = 0; i < 3; ++i)
        t[i] = static_cast<std::uint32_t>(std::lower_bound(used_.begin(), used_.end(), t[i]) - used_.begin());
    }
  }

  const GltfFile& file_;
  const tinygltf::Primitive& from_;
  const std::string where_;
  GltfBudget& budget_;
  NotRead& not_read_;
  std::size_t count_ = 0;            // of vertices in the file
  std::vector<std::uint32_t> used_;  // those that triangles use
};

// Gives the mesh the coordinates that its material's textures read, each with its transform.
void transform_uvs(Mesh& mesh, const std::array<GltfUvs, 2>& uvs, GltfBudget& budget) {
  if (uvs == std::array{GltfUvs{.set = 0}, GltfUvs{.set = 1}}) return;
  const std::vector<glm::vec2> read[2] = {std::move(mesh.uvs[0]), std::move(mesh.uvs[1])};
  for (std::size_t set = 0; set < 2; ++set) {
    const std::vector<glm::vec2>& from = read[uvs[set].set];
    budget.take(from.size(), 2);
    mesh.uvs[set] = from;
    if (!uvs[set].is_moved()) continue;
    for (glm::vec2& uv : mesh.uvs[set]) uv = uvs[set](uv);
  }
}

// Gives the mesh what its material needs: texture coordinates, and tangents for a normal map.
void complete(Mesh& mesh, const Material& material, NotRead& not_read) {
  bool lacks_uvs = false;
  for (const Texture& texture : textures_of(material)) {
    if (!mesh.uvs[texture.uv_set].empty()) continue;
    mesh.uvs[texture.uv_set].assign(mesh.positions.size(), glm::vec2(0.0f));
    lacks_uvs = true;
  }
  if (lacks_uvs) ++not_read["texture on a primitive without texture coordinates"];
  if (material.normal_texture && mesh.tangents.empty()) add_tangents(mesh, material.normal_texture->uv_set);
}

template <class Add>
void for_each_morph(const std::vector<GltfPrimitive::Target>& targets, const std::vector<double>& weights, Add add) {
  for (std::size_t t = 0; t < weights.size(); ++t)
    if (weights[t] != 0) add(targets[t], weights[t]);
}

}  // namespace

void GltfBudget::take(std::size_t vertices, std::size_t numbers_each) {
  const std::uint64_t numbers = std::uint64_t{vertices} * numbers_each;  // less than 2^32 by a few
  if (numbers > left_) fail_trace(where_, "meshes of at most 2^30 numbers, over all frames", "more");
  left_ -= numbers;
}

Mesh GltfPrimitive::deformed(const GltfDeformation& deformation, const std::string& where) const {
  Mesh result = mesh;
  for_each_morph(targets, deformation.weights, [&](const Target& target, double weight) {
    const auto w = static_cast<float>(weight);
    for (std::size_t i = 0; i < target.positions.size(); ++i) result.positions[i] += w * target.positions[i];
    const std::size_t normals = std::min(target.normals.size(), result.normals.size());
    for (std::size_t i = 0; i < normals; ++i) result.normals[i] += w * target.normals[i];
    const std::size_t tangents = std::min(target.tangents.size(), result.tangents.size());
    for (std::size_t i = 0; i < tangents; ++i) result.tangents[i] += glm::vec4(w * target.tangents[i], 0.0f);
  });
  if (!deformation.joints.empty() && !influences.empty()) {
    for (std::size_t i = 0; i < result.positions.size(); ++i) {
      glm::dmat4 matrix(0.0);
      double sum = 0;
      for (const Influences& set : influences) {
        for (int k = 0; k < 4; ++k) {
          const double weight = set.weights[i][k];
          if (weight == 0) continue;
          if (set.joints[i][k] >= deformation.joints.size()) {
            fail_trace(where, "vertices with one of " + std::to_string(deformation.joints.size()) + " joints",
                       "joint " + std::to_string(set.joints[i][k]));
          }
          matrix += deformation.joints[set.joints[i][k]] * weight;
          sum += weight;
        }
      }
      if (!(sum > 0)) fail_trace(where, "vertices with weights above 0", "one without");
      matrix /= sum;  // rounding and normalised integers give sums near 1
      result.positions[i] = glm::vec3(matrix * glm::dvec4(result.positions[i], 1.0));
      // The adjugate's transpose is the inverse's but for a positive or negative factor, and always exists.
      const glm::dmat3 m(matrix);
      const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
      const double sign = glm::dot(m[0], cofactors[0]) < 0 ? -1 : 1;
      if (!result.normals.empty()) result.normals[i] = unit_or_zero(sign * (cofactors * glm::dvec3(result.normals[i])));
      if (!result.tangents.empty())
        result.tangents[i] = glm::vec4(unit_or_zero(m * glm::dvec3(result.tangents[i])), sign * result.tangents[i].w);
    }
  }
  for (const glm::vec3& position : result.positions)
    if (!is_finite(position)) fail_trace(where, "finite positions after skinning and morphing", "others");
  for (glm::vec3& normal : result.normals) normal = unit_or_zero(normal);
  mend_normals(result);
  for (glm::vec4& tangent : result.tangents) {
    const glm::vec3 direction = unit_or_zero(glm::dvec3(tangent));
    tangent = glm::vec4(direction == glm::vec3(0.0f) ? glm::vec3(1, 0, 0) : direction, tangent.w);
  }
  return result;
}

std::optional<GltfPrimitive> read_primitive(const GltfSource& source, std::size_t mesh, std::size_t primitive) {
  const auto& [file, materials, trace, budget, not_read] = source;
  const tinygltf::Primitive& from = file.model.meshes[mesh].primitives[primitive];
  const std::string where = file.place("meshes", mesh) + "/primitives/" + std::to_string(primitive);
  PrimitiveReader reader(file, from, where, budget, not_read);
  GltfPrimitive to;
  if (!reader.read_triangles(to)) return {};
  const std::uint32_t index = materials.material(from.material, where + "/material");
  const Material& material = trace.materials[index];
  const bool is_flat = !reader.has("NORMAL") && material.normal_texture;  // a normal map bends a normal of each vertex
  if (is_flat) reader.split_vertices(to.mesh);
  reader.read_vertices(to);
  transform_uvs(to.mesh, materials.uvs(index), budget);
  if (is_flat) add_flat_normals(to.mesh);
  to.double_sided = material.double_sided;
  to.mesh.colors.assign(to.mesh.triangles.size(), glm::vec3(material.base_color));
  to.mesh.materials.assign(to.mesh.triangles.size(), index);
  reader.read_targets(to);
  reader.read_influences(to);
  complete(to.mesh, material, not_read);
  return to;
}

}  // namespace beampipe
