// The fragment shader of materials, for numbers, for numbers that count (stages/cost/counting.h) and, where it does not
// depend on the triangle, for vectors with a point in each lane.
//
// Source: Khronos Group, glTF 2.0 Specification, appendix B (BRDF implementation): Lambert's diffuse and GGX specular
// reflection, Schlick's Fresnel term, the separable form of Smith's visibility. Everything is multiplied by pi, as
// Light::color is what a white diffuse surface reflects.
#pragma once

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

// A vertex attribute at a point of the triangle.
template <class Real>
Real interpolated(const Real& first, const Real& second, const Real& third, const Barycentrics<Real>& weights) {
  return first + weights.second * (second - first) + weights.third * (third - first);
}

// How it changes.
template <class Real>
Real interpolated_slope(const Real& first, const Real& second, const Real& third, const Barycentrics<Real>& slopes) {
  return slopes.second * (second - first) + slopes.third * (third - first);
}

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

// A point of a triangle.
template <class Real>
struct SurfacePoint {
  std::array<const SurfaceVertexOf<Real>*, 3> vertices;
  Barycentrics<Real> weights;
  Triple<Real> own_normal;  // of the triangle, towards the viewer
  Real facing;              // -1: the viewer sees the back, else 1
  Triple<Real> tangent;     // of the triangle, unless its vertices have tangents
  Real tangent_sign;        // of the bitangent

  template <std::size_t Size>
  Triple<Real> vector(std::array<Real, Size> SurfaceVertexOf<Real>::*attribute) const {
    Triple<Real> result;
    for (std::size_t axis = 0; axis < 3; ++axis)
      result[axis] = interpolated((vertices[0]->*attribute)[axis], (vertices[1]->*attribute)[axis],
                                  (vertices[2]->*attribute)[axis], weights);
    return result;
  }
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
  Real facing, tangent_sign;  // as in SurfacePoint
  std::array<Real, 4> color;  // of the vertices
  // Filtered, linear RGBA. Of normals, A is 1 if the texel is a mean of several, else 0.
  std::array<Real, 4> base_texel, metallic_roughness_texel, normal_texel, emissive_texel;
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

// The first part of the fragment shader. place(uv set) gives the texture place; fetch(texture role, place) gives the
// filtered texel, as in PointInputs. Sets what the material needs.
template <class Real, class Place, class Fetch>
void inputs_at(const ShaderInputs& shader, const SurfacePoint<Real>& point, Place&& place, Fetch&& fetch,
               PointInputs<Real>& found) {
  const Material& material = shader.material;
  const auto read = [&](TextureRole role, const std::optional<Texture>& texture, std::array<Real, 4>& texel) {
    if (texture) texel = fetch(role, place(texture->uv_set));
  };
  read(TextureRole::base, material.base_texture, found.base_texel);
  if (shader.has_vertex_colors)
    for (std::size_t c = 0; c < 4; ++c)
      found.color[c] = interpolated(point.vertices[0]->color[c], point.vertices[1]->color[c],
                                    point.vertices[2]->color[c], point.weights);
  if (material.unlit) return;
  found.to_eye = point.vector(&SurfaceVertexOf<Real>::to_eye);
  found.normal = shader.has_own_normal ? point.own_normal : point.vector(&SurfaceVertexOf<Real>::normal);
  found.facing = point.facing;
  read(TextureRole::metallic_roughness, material.metallic_roughness_texture, found.metallic_roughness_texel);
  if (material.normal_texture) {
    read(TextureRole::normal, material.normal_texture, found.normal_texel);
    found.tangent = shader.has_tangents ? point.vector(&SurfaceVertexOf<Real>::tangent) : point.tangent;
    found.tangent_sign = point.tangent_sign;
  }
  read(TextureRole::emissive, material.emissive_texture, found.emissive_texel);
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
