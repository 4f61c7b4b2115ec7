// Materials, textures and images of a glTF file. Source: glTF 2.0 Specification, sections 3.8 and 3.9.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>

#include "traces/files/gltf/gltf_file.h"

namespace beampipe {

// Texture coordinates as a texture reads them: one of the file's sets, scaled, turned and then moved.
// Source: KHR_texture_transform.
struct GltfUvs {
  std::uint32_t set = 0;  // TEXCOORD_0 or TEXCOORD_1
  glm::dvec2 offset{0.0}, scale{1.0};
  double rotation = 0;  // radians, counter-clockwise as v points down

  bool is_moved() const { return offset != glm::dvec2(0.0) || scale != glm::dvec2(1.0) || rotation != 0; }
  glm::vec2 operator()(const glm::vec2& uv) const;
  bool operator==(const GltfUvs&) const = default;
};

// Turns materials into those of a trace when they are asked for, each once, and the images that they use with them.
class GltfMaterials {
 public:
  // All of these must outlive this.
  GltfMaterials(const GltfFile& file, Trace& trace, NotRead& not_read)
      : file_(file), trace_(trace), not_read_(not_read) {}

  // Returns the index in the trace of the file's material `index`; of -1, the material that glTF gives to primitives
  // without one. `named_by` is the primitive's place. Throws TraceError.
  std::uint32_t material(int index, const std::string& named_by);

  // What uv0 and uv1 of a mesh must be for a material of the trace.
  const std::array<GltfUvs, 2>& uvs(std::uint32_t material) const { return uvs_[material]; }

 private:
  // A texture of a material, whose uv_set is not known yet, and the coordinates that it reads.
  struct Wish {
    std::optional<Texture>* texture;
    GltfUvs uvs;
  };

  Material read(const tinygltf::Material& from, const std::string& where);
  template <class TextureInfo>
  void read_texture(const TextureInfo& info, const std::string& where, std::optional<Texture>& to,
                    std::vector<Wish>& wishes);
  std::optional<Texture> texture(int index, const std::string& where);
  std::array<GltfUvs, 2> place_uvs(const std::vector<Wish>& wishes);
  std::uint32_t image(int index, const std::string& named_by);

  const GltfFile& file_;
  Trace& trace_;
  NotRead& not_read_;
  std::map<int, std::uint32_t> materials_, images_;  // in the trace, by index in the file
  std::vector<std::array<GltfUvs, 2>> uvs_;          // by index in the trace
};

// Light limited to what a trace may have, which is noted where it changes something.
glm::vec3 limited_light(const glm::vec3& light, NotRead& not_read);

// The textures that a material has.
std::vector<Texture> textures_of(const Material& material);

}  // namespace beampipe
