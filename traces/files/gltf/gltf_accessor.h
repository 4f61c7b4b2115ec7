// Numbers in the buffers of a glTF file. Source: glTF 2.0 Specification, section 3.6.2.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "traces/files/gltf/gltf_file.h"

namespace beampipe {

// A typed list of vectors in a buffer. Reading is lazy, and refers to the file, which must outlive this.
class GltfAccessor {
 public:
  // Throws TraceError if there is no such accessor, if any of its elements is not in its buffer, or if `type` is
  // another one than its own ("VEC3"; "VEC3 or VEC4").
  GltfAccessor(const GltfFile& file, int index, const std::string& type, const std::string& named_by);

  std::size_t count() const { return count_; }
  int components() const { return components_; }
  bool holds_indices() const;  // unsigned integers that are not normalised

  // A number of an element, normalised if the accessor says so. Throws TraceError if it is not finite.
  double number(std::size_t element, int component = 0) const;
  std::uint32_t integer(std::size_t element, int component = 0) const;  // only if it holds indices

  glm::vec3 vec3(std::size_t element) const;
  glm::vec4 vec4(std::size_t element) const;  // (x, y, z, 1) of three components

  const std::string& where() const { return where_; }

 private:
  // Elements at equal distances.
  struct Elements {
    const unsigned char* first = nullptr;  // null: all are 0
    std::size_t stride = 0;
  };

  Elements elements(const GltfFile& file, int view, std::size_t offset, std::size_t size, std::size_t count,
                    bool may_have_stride) const;
  void read_sparse(const GltfFile& file, const tinygltf::Accessor& accessor);
  const unsigned char* find(std::size_t element) const;

  std::string where_;
  std::size_t count_ = 0;
  int components_ = 0, component_type_ = 0;
  std::size_t component_size_ = 0;
  bool normalized_ = false;
  Elements dense_;
  std::vector<std::uint32_t> sparse_indices_;  // in ascending order
  Elements sparse_;                            // their values
};

}  // namespace beampipe
