// What must hold of every trace that a reader of models gives: its parts fit together, and its numbers are finite.
#pragma once

#include <cmath>
#include <cstdlib>

#include "traces/trace.h"

namespace beampipe {

template <class Vector>
void require_finite(const std::vector<Vector>& vectors) {
  for (const Vector& vector : vectors)
    for (int i = 0; i < Vector::length(); ++i)
      if (!std::isfinite(vector[i])) std::abort();
}

inline void require_texture(const std::optional<Texture>& texture, const Trace& trace, const Mesh& mesh) {
  if (!texture) return;
  if (texture->image >= trace.images.size() || texture->uv_set > 1) std::abort();
  if (mesh.uvs[texture->uv_set].size() != mesh.positions.size()) std::abort();
}

inline void require_sound(const Trace& trace) {
  for (const TextureImage& image : trace.images)
    if (image.width == 0 || image.texels.size() != std::size_t{image.width} * image.height) std::abort();
  for (const Mesh& mesh : trace.meshes) {
    const std::size_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
    const auto fits = [](std::size_t size, std::size_t whole) { return size == 0 || size == whole; };
    if (mesh.colors.size() != triangles || !fits(mesh.materials.size(), triangles)) std::abort();
    if (!fits(mesh.normals.size(), vertices) || !fits(mesh.tangents.size(), vertices) ||
        !fits(mesh.uvs[0].size(), vertices) || !fits(mesh.uvs[1].size(), vertices) ||
        !fits(mesh.vertex_colors.size(), vertices)) {
      std::abort();
    }
    require_finite(mesh.positions);
    require_finite(mesh.colors);
    require_finite(mesh.normals);
    require_finite(mesh.tangents);
    require_finite(mesh.uvs[0]);
    require_finite(mesh.uvs[1]);
    require_finite(mesh.vertex_colors);
    for (const glm::vec3& normal : mesh.normals)
      if (!(std::abs(glm::length(normal) - 1.0f) < 1e-4f)) std::abort();
    for (const glm::uvec3& t : mesh.triangles)
      for (int i = 0; i < 3; ++i)
        if (t[i] >= vertices) std::abort();
    for (std::uint32_t index : mesh.materials) {
      if (index == kNoMaterial) continue;
      if (index >= trace.materials.size()) std::abort();
      const Material& material = trace.materials[index];
      require_finite(std::vector{material.base_color});
      require_finite(std::vector{material.emissive});
      require_texture(material.base_texture, trace, mesh);
      require_texture(material.metallic_roughness_texture, trace, mesh);
      require_texture(material.normal_texture, trace, mesh);
      require_texture(material.emissive_texture, trace, mesh);
      if (material.normal_texture && mesh.tangents.empty()) std::abort();
    }
  }
  for (const Frame& frame : trace.frames)
    for (const Draw& draw : frame.draws) {
      if (draw.mesh >= trace.meshes.size()) std::abort();
      require_finite(std::vector{draw.transform[0], draw.transform[1], draw.transform[2], draw.transform[3]});
    }
}

}  // namespace beampipe
