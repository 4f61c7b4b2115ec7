// Material libraries (.mtl) of OBJ files, as glTF's metallic-roughness materials.
//
//   Kd, map_Kd          base colour and its texture
//   Ns                  roughness = (2 / (Ns + 2))^(1/4), if Ks is above 0; otherwise 1. Phong's exponent Ns stands for
//                       Beckmann's width sqrt(2 / (Ns + 2)), which is glTF's roughness squared. Source: B. Walter, S.
//                       Marschner, H. Li, K. Torrance, Microfacet Models for Refraction through Rough Surfaces, EGSR
//                       2007, section 5.2; glTF 2.0 Specification, appendix B.2.3
//   Ks                  nothing else: the reflectance of all dielectrics is 4 %, as in glTF
//   Pr, Pm              roughness and metallic, if above 0
//   Ke, map_Ke          emission
//   d, Tr               opacity: below 1, the material is blended
//   map_d               a cutout (alpha mode mask). Alpha is the image's own if it has some below 255, otherwise red
//   norm                normal map; map_Bump too if its image is not grey, because many programs write it so
//   map_Bump, bump      height map, which becomes a normal map: from black to white, it rises by -bm times a texel's
//                       side. (The format does not say how high a height map is.)
//   -clamp, -bm         options of these maps: clamping, and the scale of normals or heights
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "traces/files/model_folder.h"
#include "traces/files/model_import.h"

namespace tinyobj {
struct material_t;
struct texture_option_t;
}  // namespace tinyobj

namespace beampipe {

// Adds materials and images to a trace when they are asked for.
class ObjMaterialReader {
 public:
  // Messages start with `where`. The folder, the trace and `not_read` must outlive this.
  ObjMaterialReader(const ModelFolder& folder, const std::string& where, Trace& trace, NotRead& not_read)
      : folder_(folder), where_(where), trace_(trace), not_read_(not_read) {}

  // Adds a material and its images; returns its index in the trace. Images that several materials use are added once.
  // Throws TraceError.
  std::uint32_t add(const tinyobj::material_t& material);

 private:
  std::optional<Texture> texture(const std::string& name, const tinyobj::texture_option_t& options,
                                 const std::string& keyword);
  std::uint32_t image(const std::string& name);
  std::uint32_t with_alpha(const std::optional<Texture>& base, std::uint32_t alpha);
  std::uint32_t normals_from(std::uint32_t heights, float scale, Wrap wrap);
  std::uint32_t keep(const std::string& key, TextureImage image);

  const ModelFolder& folder_;
  std::string where_;
  Trace& trace_;
  NotRead& not_read_;
  std::map<std::string, std::uint32_t> images_;  // by what they were made from
};

// Whether the material has a map that is read.
bool has_map(const tinyobj::material_t& material);

}  // namespace beampipe
