// Compares traces, bit by bit: 0 is not -0.
#pragma once

#include <cstring>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "traces/trace.h"

namespace beampipe {

inline auto fields(const TextureImage& i) { return std::tie(i.name, i.width, i.height, i.texels); }
inline auto fields(const Material& m) {
  return std::tie(m.name, m.base_color, m.base_texture, m.metallic, m.roughness, m.metallic_roughness_texture,
                  m.normal_texture, m.normal_scale, m.emissive, m.emissive_texture, m.alpha_mode, m.alpha_cutoff,
                  m.double_sided, m.unlit);
}
inline auto fields(const Mesh& m) {
  return std::tie(m.name, m.positions, m.ws, m.triangles, m.colors, m.materials, m.normals, m.tangents, m.uvs[0],
                  m.uvs[1], m.vertex_colors, m.varyings);
}
inline auto fields(const Draw& d) {
  return std::tie(d.mesh, d.transform, d.kd, d.cull, d.shading, d.material, d.state, d.program);
}
inline auto fields(const Camera& c) { return std::tie(c.eye, c.target, c.up, c.fovy_deg, c.near, c.far); }
inline auto fields(const Light& l) { return std::tie(l.direction, l.color); }
inline auto fields(const Ambient& a) { return std::tie(a.sky, a.ground, a.up); }
inline auto fields(const Frame& f) {
  return std::tie(f.width, f.height, f.background, f.camera, f.view, f.projection, f.lighting.lights,
                  f.lighting.ambient, f.draws, f.target, f.capture);
}
inline auto fields(const ShaderProgram& p) { return std::tie(p.name, p.spirv, p.specialization, p.inputs); }
inline auto fields(const ProgramImage& i) {
  return std::tie(i.name, i.shape, i.format, i.width, i.height, i.depth, i.layers, i.array, i.levels, i.texels);
}
inline auto fields(const ProgramSampler& s) {
  return std::tie(s.mag, s.min, s.mip, s.wrap, s.lod_bias, s.least_lod, s.most_lod, s.anisotropy, s.compare, s.border,
                  s.unnormalized);
}
inline auto fields(const Trace& t) {
  return std::tie(t.source, t.images, t.program_images, t.program_samplers, t.programs, t.materials, t.meshes,
                  t.frames);
}

// Where two traces, or two of their parts, differ first: "" if every number has the same bits.
template <class T>
std::string difference(const T& a, const T& b) {
  if constexpr (requires { fields(a); }) {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      std::string found;
      const auto differ = [&](std::size_t field, const std::string& inside) {
        if (!inside.empty()) found = " field " + std::to_string(field) + inside;
        return !inside.empty();
      };
      (differ(I, difference(std::get<I>(fields(a)), std::get<I>(fields(b)))) || ...);
      return found;
    }
    (std::make_index_sequence<std::tuple_size_v<decltype(fields(a))>>());
  } else if constexpr (requires { a.has_value(); }) {
    return a && b ? difference(*a, *b) : a.has_value() == b.has_value() ? "" : " is there or not";
  } else if constexpr (requires { a.begin(); } && !std::is_same_v<T, std::string>) {
    if (a.size() != b.size()) return " size";
    for (std::size_t i = 0; i < a.size(); ++i)
      if (const std::string inside = difference(a[i], b[i]); !inside.empty())
        return " element " + std::to_string(i) + inside;
    return "";
  } else if constexpr (std::is_floating_point_v<T> || requires { typename T::length_type; }) {  // numbers of glm, too
    return std::memcmp(&a, &b, sizeof(T)) == 0 ? "" : " differs";
  } else {
    return a == b ? "" : " differs";
  }
}

}  // namespace beampipe
