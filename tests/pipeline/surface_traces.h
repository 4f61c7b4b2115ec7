// Small traces with materials for the pipeline tests, in pixel coordinates.
#pragma once

#include "tests/pipeline/test_traces.h"

namespace beampipe {

inline TextureImage checker_image(std::uint32_t size, const glm::u8vec4& even, const glm::u8vec4& odd) {
  TextureImage image{"checker", size, size, {}};
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) image.texels.push_back((x + y) % 2 ? odd : even);
  return image;
}

// Random triangles as in random_trace. Some are flat, the others have one of five materials in turn: textured, textured
// and lit, a cutout, translucent, translucent with a texture. The frame is lit by one light and from all around.
inline Trace random_surfaces(std::uint32_t width, std::uint32_t height, int count, std::uint32_t seed) {
  Trace trace = random_trace(width, height, count, seed);
  trace.images = {checker_image(8, {255, 64, 32, 255}, {16, 200, 255, 0}),
                  checker_image(4, {128, 128, 255, 255}, {90, 160, 230, 255})};
  const Texture color{.image = 0}, bumps{.image = 1};
  trace.materials.resize(5);
  trace.materials[0].base_texture = color, trace.materials[0].unlit = true;
  trace.materials[1].base_texture = color, trace.materials[1].normal_texture = bumps;
  trace.materials[1].metallic_roughness_texture = bumps;
  trace.materials[1].roughness = 0.5f, trace.materials[1].emissive = glm::vec3(0.125f, 0, 0.25f);
  trace.materials[2].base_texture = color, trace.materials[2].alpha_mode = AlphaMode::mask;
  trace.materials[3].base_color = glm::vec4(0.25f, 0.75f, 0.5f, 0.375f);
  trace.materials[3].alpha_mode = AlphaMode::blend, trace.materials[3].unlit = true;
  trace.materials[4].base_texture = color, trace.materials[4].base_color.a = 0.75f;
  trace.materials[4].alpha_mode = AlphaMode::blend;
  for (Material& material : trace.materials) material.double_sided = true;

  RandomNumbers random(seed + 1);
  Mesh& mesh = trace.meshes[0];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    mesh.materials.push_back(t % 6 == 5 ? kNoMaterial : static_cast<std::uint32_t>(t % 6));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.uvs[0].emplace_back(random.vector(glm::dvec2(-1), glm::dvec2(2)));
    mesh.normals.push_back(glm::normalize(glm::vec3(glm::vec2(random.vector(glm::dvec2(-0.5), glm::dvec2(0.5))), -1)));
    mesh.vertex_colors.emplace_back(glm::vec3(random.vector(glm::dvec3(0.5), glm::dvec3(1))), 1.0f);
  }
  trace.frames[0].lighting.lights = {{glm::normalize(glm::vec3(0.25f, 0.5f, 1)), glm::vec3(1, 0.75f, 0.5f)}};
  trace.frames[0].lighting.ambient = Ambient{glm::vec3(0.25f), glm::vec3(0.125f, 0.0625f, 0)};
  return trace;
}

// Random triangles with materials in four draws, whose fixed-function state varies as in a captured frame: viewports,
// a scissor, depth range, bias, function and clear, culling.
inline Trace random_states(std::uint32_t width, std::uint32_t height, int count, std::uint32_t seed) {
  Trace trace = random_surfaces(width, height, count, seed);
  std::vector<Draw>& draws = trace.frames[0].draws;
  draws.assign(4, draws[0]);
  draws[1].state.viewport =
      Viewport{0, static_cast<float>(height), static_cast<float>(width) * 0.75f, -static_cast<float>(height)};
  draws[1].state.depth.bias = {0.0625f, 0.5f, 0.125f};
  draws[1].cull = Cull::back;
  draws[2].state.scissor = Scissor{static_cast<std::int32_t>(width / 4), 3, width / 2, height / 2};
  draws[2].state.depth.cleared_before = true;
  draws[2].state.depth.far = 0.5f;
  draws[3].state.front_is_clockwise = true;
  draws[3].cull = Cull::front;
  draws[3].state.depth.function = Compare::less_equal;
  draws[3].state.depth.near = 0.25f;
  draws[3].state.depth.clip = false;
  return trace;
}

}  // namespace beampipe
