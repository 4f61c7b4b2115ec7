// The fragment shader of materials, for numbers, for numbers that count (stages/cost/counting.h) and for vectors with a
// point in each lane.
//
// Source: Khronos Group, glTF 2.0 Specification, appendix B (BRDF implementation): Lambert's diffuse and GGX specular
// reflection, Schlick's Fresnel term, the separable form of Smith's visibility. Everything is multiplied by pi, as
// Light::color is what a white diffuse surface reflects.
#pragma once

#include <algorithm>
#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "simd/scalar.h"
#include "stages/data/surface.h"
#include "traces/trace.h"

namespace beampipe {

template <class Real>
using Triple = std::array<Real, 3>;

// What the reflection of light depends on.
template <class Real>
struct Reflector {
  Triple<Real> base;  // linear RGB
  Real metallic, roughness;
  Triple<Real> normal, to_eye;  // unit length
};

// Roughness of 0 would reflect a light that has no size as a point without end.
inline constexpr float kLeastRoughness = 0.1f;
inline constexpr float kDielectricReflectance = 0.04f;

// What a material's shader is made for.
struct ShaderInputs {
  const Material& material;
  bool has_vertex_colors, has_own_normal, has_tangents;  // own normal, tangents: see SetupSurface and SurfaceVertex
};

// Texture coordinates at a point and how they change per pixel, to the right and down.
template <class Real>
struct TexturePlace {
  std::array<Real, 2> uv, dx, dy;
};

enum class TextureRole { base, metallic_roughness, normal, emissive };

// What a triangle has in addition to its vertices.
template <class Real>
struct TriangleInputs {
  Triple<Real> own_normal;  // towards the viewer
  Real facing;              // -1: the viewer sees the back, else 1
  Triple<Real> tangent;     // unless its vertices have tangents
  Real tangent_sign;        // of the bitangent
};

// What the surface is made of at a point.
template <class Real>
struct SurfaceMaterial {
  Reflector<Real> reflector;
  Triple<Real> emissive;  // linear RGB; not of unlit materials
  Real alpha;
};

// What the material's shader knows of a point, from the triangle and its vertices and from textures. What a material
// does not need has any value.
template <class Real>
struct PointInputs {
  Triple<Real> to_eye;        // not normalised
  Triple<Real> normal;        // not normalised, unless it is the triangle's own
  Triple<Real> tangent;       // not normalised
  Real facing, tangent_sign;  // as in TriangleInputs
  std::array<Real, 4> color;  // of the vertices
  // Filtered, linear RGBA. Of normals, A is 1 if the texel is a mean of several, else 0.
  std::array<Real, 4> base_texel, metallic_roughness_texel, normal_texel, emissive_texel;
};

// An area whose light may vary: its middle, and directions on its right and lower side. In the middle there are the
// means of normals, the least roughness and the most metal of the texels around it; other textures are white.
template <class Real>
struct AreaInputs {
  PointInputs<Real> middle;
  Triple<Real> right_to_eye, below_to_eye, right_normal, below_normal;  // not normalised
  Real around_of_texels, around_within_texels;  // by how much normals turn between texels, and within them
};

namespace scalar {
#include "stages/surface/surface_formulas-inl.h"
}
using namespace scalar;

// Lambert's law: kd times max(0, -normal . light).
template <class Real>
void lambert(const Real kd[3], const Real normal[3], const Real light[3], Real color[3]) {
  const Real zero(0.0f);
  const Real cosine = greater(zero - (normal[0] * light[0] + normal[1] * light[1] + normal[2] * light[2]), zero);
  for (int c = 0; c < 3; ++c) color[c] = kd[c] * cosine;
}

// Calls visit(role, texture, texel) for each texture that the material's shader reads; `texel` points to the member of
// PointInputs that its texel belongs to.
template <class Real, class Visit>
void for_each_texture(const Material& material, Visit&& visit) {
  const auto visit_one = [&](TextureRole role, const std::optional<Texture>& texture,
                             std::array<Real, 4> PointInputs<Real>::*texel) {
    if (texture) visit(role, *texture, texel);
  };
  visit_one(TextureRole::base, material.base_texture, &PointInputs<Real>::base_texel);
  if (material.unlit) return;
  visit_one(TextureRole::metallic_roughness, material.metallic_roughness_texture,
            &PointInputs<Real>::metallic_roughness_texel);
  visit_one(TextureRole::normal, material.normal_texture, &PointInputs<Real>::normal_texel);
  visit_one(TextureRole::emissive, material.emissive_texture, &PointInputs<Real>::emissive_texel);
}

// Alpha alone, as in SurfaceMaterial. place and fetch: as above; `vertex_alphas`: of the vertices' colours.
template <class Real, class Place, class Fetch>
Real alpha_at(const ShaderInputs& shader, const std::array<Real, 3>& vertex_alphas, const Barycentrics<Real>& weights,
              Place&& place, Fetch&& fetch) {
  Real alpha(shader.material.base_color.a);
  if (const auto& texture = shader.material.base_texture)
    alpha = alpha * fetch(TextureRole::base, place(texture->uv_set))[3];
  if (shader.has_vertex_colors)
    alpha = alpha * interpolated(vertex_alphas[0], vertex_alphas[1], vertex_alphas[2], weights);
  return alpha;
}

}  // namespace beampipe
