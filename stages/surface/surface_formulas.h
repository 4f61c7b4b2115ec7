// The fragment shader of materials, for numbers and for numbers that count (stages/cost/counting.h).
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

// Lambert's law: kd times max(0, -normal . light).
template <class Real>
void lambert(const Real kd[3], const Real normal[3], const Real light[3], Real color[3]) {
  const Real zero(0.0f);
  const Real cosine = greater(zero - (normal[0] * light[0] + normal[1] * light[1] + normal[2] * light[2]), zero);
  for (int c = 0; c < 3; ++c) color[c] = kd[c] * cosine;
}

template <class Real>
using Triple = std::array<Real, 3>;

template <class Real>
Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Real>
Triple<Real> cross(const Triple<Real>& a, const Triple<Real>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class Real>
Triple<Real> scaled(const Triple<Real>& a, const Real& by) {
  return {a[0] * by, a[1] * by, a[2] * by};
}

template <class Real>
Triple<Real> sum(const Triple<Real>& a, const Triple<Real>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

// 0 stays 0.
template <class Real>
Triple<Real> unit(const Triple<Real>& a) {
  return scaled(a, Real(1.0f) / square_root(greater(dot(a, a), Real(1e-30f))));
}

template <class Real>
Triple<Real> triple(const glm::vec3& v) {
  return {Real(v.x), Real(v.y), Real(v.z)};
}

template <class Real>
Real mixed(const Real& a, const Real& b, const Real& share) {
  return a + share * (b - a);
}

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

// Light from all around, from a direction of any length up to 1.
template <class Real>
Real ambient_light(const Ambient& ambient, const Triple<Real>& direction, std::size_t channel) {
  const Real share = Real(0.5f) + Real(0.5f) * dot(direction, triple<Real>(ambient.up));
  const int c = static_cast<int>(channel);
  return mixed(Real(ambient.ground[c]), Real(ambient.sky[c]), share);
}

// Linear RGB towards the eye. Ambient light is reflected diffusely, and from the mirrored direction, which roughness
// turns towards the normal.
template <class Real>
Triple<Real> reflected_light(const Reflector<Real>& surface, const Lighting& lighting) {
  const Real zero(0.0f), one(1.0f);
  const Real roughness = greater(surface.roughness, Real(kLeastRoughness));
  const Real alpha = roughness * roughness, alpha2 = alpha * alpha;
  const Real normal_eye = greater(dot(surface.normal, surface.to_eye), Real(1e-3f));
  Triple<Real> diffuse, mirror;  // mirror: reflectance straight on
  for (std::size_t c = 0; c < 3; ++c) {
    diffuse[c] = surface.base[c] * (one - surface.metallic);
    // A base colour may be above 1, but nothing reflects more light than it receives.
    mirror[c] = lesser(mixed(Real(kDielectricReflectance), surface.base[c], surface.metallic), one);
  }
  Triple<Real> light{zero, zero, zero};
  for (const Light& source : lighting.lights) {
    const Triple<Real> to_light = triple<Real>(-source.direction);
    const Triple<Real> half_way = unit(sum(to_light, surface.to_eye));
    const Real normal_light = greater(dot(surface.normal, to_light), zero);
    const Real normal_half = dot(surface.normal, half_way);
    const Real density_root = normal_half * normal_half * (alpha2 - one) + one;
    const Real density = alpha2 / (density_root * density_root);
    const Real smith = (normal_eye + square_root(normal_eye * normal_eye * (one - alpha2) + alpha2)) *
                       (normal_light + square_root(normal_light * normal_light * (one - alpha2) + alpha2));
    const Real specular = density / smith;
    const Real grazing = one - lesser(greater(dot(surface.to_eye, half_way), zero), one), grazing2 = grazing * grazing;
    const Real fresnel = grazing2 * grazing2 * grazing;
    for (std::size_t c = 0; c < 3; ++c) {
      const Real reflectance = mirror[c] + (one - mirror[c]) * fresnel;
      const Real reflected = (one - reflectance) * diffuse[c] + reflectance * specular;
      light[c] = light[c] + Real(source.color[static_cast<int>(c)]) * normal_light * reflected;
    }
  }
  if (!lighting.ambient) return light;
  const Real twice = dot(surface.normal, surface.to_eye) * Real(2.0f);
  Triple<Real> mirrored;
  for (std::size_t axis = 0; axis < 3; ++axis)
    mirrored[axis] = mixed(surface.normal[axis] * twice - surface.to_eye[axis], surface.normal[axis], alpha);
  for (std::size_t c = 0; c < 3; ++c)
    light[c] = light[c] + (one - mirror[c]) * diffuse[c] * ambient_light(*lighting.ambient, surface.normal, c) +
               mirror[c] * ambient_light(*lighting.ambient, mirrored, c);
  return light;
}

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

// A vertex's attributes, as in SurfaceVertex and in that order.
template <class Real>
struct VertexInputs {
  Triple<Real> to_eye, normal;
  std::array<Real, 4> tangent;
  std::array<std::array<Real, 2>, 2> uvs;
  std::array<Real, 4> color;
};

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
  const std::array<VertexInputs<Real>, 3>& vertices;
  Barycentrics<Real> weights;
  Triple<Real> own_normal;  // of the triangle, towards the viewer
  Real facing;              // -1: the viewer sees the back, else 1
  Triple<Real> tangent;     // of the triangle, unless its vertices have tangents
  Real tangent_sign;        // of the bitangent

  template <std::size_t Size>
  Triple<Real> vector(std::array<Real, Size> VertexInputs<Real>::*attribute) const {
    Triple<Real> result;
    for (std::size_t axis = 0; axis < 3; ++axis)
      result[axis] = interpolated((vertices[0].*attribute)[axis], (vertices[1].*attribute)[axis],
                                  (vertices[2].*attribute)[axis], weights);
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

// Roughness with what normals differ within the texel: the mean of unit vectors is the shorter the more they differ.
// `mean`: a mean of normals if `is_mean` is 1; if it is 0, roughness stays. The variance of their directions adds to
// that of the microfacets, which is half of the squared alpha of GGX. Source: Toksvig 2005, "Mipmapping Normal Maps";
// Kaplanyan et al. 2016, "Filtering Distributions of Normals for Shading Antialiasing".
template <class Real>
Real rougher(const Real& roughness, const Triple<Real>& mean, const Real& is_mean) {
  const Real one(1.0f), squared = roughness * roughness;
  const Real length = lesser(greater(square_root(dot(mean, mean)), Real(0.1f)), one);
  const Real variance = is_mean * (one - length) / length;
  return square_root(square_root(lesser(squared * squared + variance + variance, one)));
}

// The first half of the fragment shader. place(uv set) gives the texture place; fetch(texture role, place) gives the
// filtered texel, as linear RGBA; of normals, A is 1 if the texel is a mean of several, else 0.
template <class Real, class Place, class Fetch>
SurfaceMaterial<Real> material_at(const ShaderInputs& shader, const SurfacePoint<Real>& point, Place&& place,
                                  Fetch&& fetch) {
  const Material& material = shader.material;
  const auto texel = [&](TextureRole role, const Texture& texture) -> std::array<Real, 4> {
    return fetch(role, place(texture.uv_set));
  };
  std::array<Real, 4> base;
  for (std::size_t c = 0; c < 4; ++c) base[c] = Real(material.base_color[static_cast<int>(c)]);
  if (material.base_texture) {
    const std::array<Real, 4> color = texel(TextureRole::base, *material.base_texture);
    for (std::size_t c = 0; c < 4; ++c) base[c] = base[c] * color[c];
  }
  if (shader.has_vertex_colors)
    for (std::size_t c = 0; c < 4; ++c)
      base[c] = base[c] * interpolated(point.vertices[0].color[c], point.vertices[1].color[c],
                                       point.vertices[2].color[c], point.weights);
  SurfaceMaterial<Real> surface{};
  Reflector<Real>& reflector = surface.reflector;
  reflector.base = {base[0], base[1], base[2]};
  surface.alpha = base[3];
  if (material.unlit) return surface;
  reflector.to_eye = unit(point.vector(&VertexInputs<Real>::to_eye));
  reflector.normal =
      shader.has_own_normal ? point.own_normal : scaled(unit(point.vector(&VertexInputs<Real>::normal)), point.facing);
  reflector.roughness = Real(material.roughness);
  reflector.metallic = Real(material.metallic);
  if (material.metallic_roughness_texture) {
    const std::array<Real, 4> factors = texel(TextureRole::metallic_roughness, *material.metallic_roughness_texture);
    reflector.roughness = reflector.roughness * factors[1];
    reflector.metallic = reflector.metallic * factors[2];
  }
  if (material.normal_texture) {
    const std::array<Real, 4> code = texel(TextureRole::normal, *material.normal_texture);
    const Triple<Real> normal = reflector.normal;
    Triple<Real> tangent = shader.has_tangents ? point.vector(&VertexInputs<Real>::tangent) : point.tangent;
    const Real along = dot(tangent, normal);
    for (std::size_t axis = 0; axis < 3; ++axis) tangent[axis] = tangent[axis] - along * normal[axis];
    tangent = unit(tangent);
    const Triple<Real> bitangent = scaled(cross(normal, tangent), point.facing * point.tangent_sign);
    const Real two(2.0f), one(1.0f), scale(material.normal_scale);
    const Real to_u = (code[0] * two - one) * scale, to_v = (code[1] * two - one) * scale;
    const Real outward = code[2] * two - one;
    for (std::size_t axis = 0; axis < 3; ++axis)
      reflector.normal[axis] = tangent[axis] * to_u + bitangent[axis] * to_v + normal[axis] * outward;
    reflector.roughness = rougher(reflector.roughness, reflector.normal, code[3]);
    reflector.normal = unit(reflector.normal);
  }
  surface.emissive = triple<Real>(material.emissive);
  if (material.emissive_texture) {
    const std::array<Real, 4> color = texel(TextureRole::emissive, *material.emissive_texture);
    for (std::size_t c = 0; c < 3; ++c) surface.emissive[c] = surface.emissive[c] * color[c];
  }
  return surface;
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

// The second half: linear RGB towards the eye.
template <class Real>
Triple<Real> lit_color(const Material& material, const SurfaceMaterial<Real>& surface, const Lighting& lighting) {
  if (material.unlit) return surface.reflector.base;
  const Triple<Real> light = reflected_light(surface.reflector, lighting);
  return material.emissive == glm::vec3(0.0f) ? light : sum(light, surface.emissive);
}

}  // namespace beampipe
