// Materials, textures and images of a glTF file. Source: glTF 2.0 Specification, sections 3.8 and 3.9.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "traces/gltf/gltf_file.h"

namespace beampipe {

// Turns materials into those of a trace when they are asked for, each once, and the images that they use with them.
class GltfMaterials {
 public:
  // All of these must outlive this.
  GltfMaterials(const GltfFile& file, Trace& trace, NotRead& not_read)
      : file_(file), trace_(trace), not_read_(not_read) {}

  // Returns the index in the trace of the file's material `index`; of -1, the material that glTF gives to primitives
  // without one. `named_by` is the primitive's place. Throws TraceError.
  std::uint32_t material(int index, const std::string& named_by);

 private:
  Material read(const tinygltf::Material& from, const std::string& where);
  std::optional<Texture> texture(int index, int uv_set, const std::string& where);
  std::uint32_t image(int index, const std::string& named_by);

  const GltfFile& file_;
  Trace& trace_;
  NotRead& not_read_;
  std::map<int, std::uint32_t> materials_, images_;  // in the trace, by index in the file
};

// The textures that a material has.
std::vector<Texture> textures_of(const Material& material);

}  // namespace beampipe
