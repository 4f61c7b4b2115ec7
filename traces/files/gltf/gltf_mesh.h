// Primitives of a glTF file as meshes, at rest and deformed. Source: glTF 2.0 Specification, section 3.7.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "traces/files/gltf/gltf_file.h"
#include "traces/files/gltf/gltf_material.h"

namespace beampipe {

// How many numbers the meshes of a trace may hold, all together: what a few bytes of JSON ask for must fit into memory.
class GltfBudget {
 public:
  explicit GltfBudget(const std::string& where) : where_(where) {}
  void take(std::size_t vertices, std::size_t numbers_each);  // throws TraceError when nothing is left

 private:
  std::string where_;
  std::uint64_t left_ = std::uint64_t{1} << 30;
};

// What moves a vertex.
struct GltfDeformation {
  std::vector<double> weights;     // of morph targets; empty: none
  std::vector<glm::dmat4> joints;  // of a skin, from the mesh to the scene; empty: none
  bool operator==(const GltfDeformation&) const = default;
};

// Triangles with one material.
struct GltfPrimitive {
  Mesh mesh;
  bool double_sided = false;

  // What a morph target adds to each vertex; lists are empty where it adds nothing.
  struct Target {
    std::vector<glm::vec3> positions, normals, tangents;
  };
  std::vector<Target> targets;

  // Influences of a skin on each vertex, in sets of four.
  struct Influences {
    std::vector<glm::uvec4> joints;
    std::vector<glm::vec4> weights;
  };
  std::vector<Influences> influences;

  // The mesh under a deformation. Throws TraceError if the result is not finite, or if a vertex names a joint that
  // there is not.
  Mesh deformed(const GltfDeformation& deformation, const std::string& where) const;
};

// What primitives are read from, what is left for them, and where they note what is not read.
struct GltfSource {
  const GltfFile& file;
  GltfMaterials& materials;  // of `trace`
  const Trace& trace;
  GltfBudget& budget;
  NotRead& not_read;
};

// Nothing if the primitive makes no triangles. Throws TraceError.
std::optional<GltfPrimitive> read_primitive(const GltfSource& source, std::size_t mesh, std::size_t primitive);

}  // namespace beampipe
