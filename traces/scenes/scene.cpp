#include "traces/scenes/scene.h"

#include <algorithm>
#include <cmath>

#include "traces/closed_mesh.h"

namespace beampipe {

std::vector<Mesh> build_to_budget(const SceneOptions& options, std::uint32_t default_triangles,
                                  const BuildMeshes& build) {
  const double wanted = options.triangles > 0 ? options.triangles : default_triangles;
  std::vector<Mesh> best;
  double budget = wanted, smallest_miss = INFINITY;
  for (int attempt = 0; attempt < 8 && smallest_miss > 0.03; ++attempt) {
    Random random(options.seed);
    std::vector<Mesh> meshes = build(budget, random);
    double made = 0;
    for (const Mesh& mesh : meshes) made += static_cast<double>(mesh.triangles.size());
    const double miss = std::abs(made / wanted - 1);
    budget *= wanted / made;
    if (miss >= smallest_miss) continue;
    smallest_miss = miss;
    best = std::move(meshes);
  }
  return best;
}

Trace one_frame(const SceneOptions& options, const Camera& camera, std::vector<Mesh> meshes, Shoulder light_over) {
  Trace trace;
  Frame frame;
  frame.width = options.width;
  frame.height = options.height;
  frame.background = {0.25f, 0.45f, 0.80f};
  set_camera(frame, camera);
  const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
  const double sideways = light_over == Shoulder::left ? 0.35 : -0.35;
  const glm::dvec3 direction = glm::normalize(forward + sideways * right - 0.45 * glm::cross(right, forward));
  frame.lighting.lights.push_back({.direction = direction});
  for (std::uint32_t i = 0; i < meshes.size(); ++i) {
    Draw draw;
    draw.mesh = i;
    draw.shading = Shading::lambert;
    if (is_closed_body(meshes[i])) draw.cull = Cull::back;
    frame.draws.push_back(draw);
  }
  trace.meshes = std::move(meshes);
  trace.frames.push_back(std::move(frame));
  return trace;
}

Texture Surfaces::add(TextureImage image) {
  images.push_back(std::move(image));
  return {.image = static_cast<std::uint32_t>(images.size() - 1)};
}

std::uint32_t Surfaces::add(Material material) {
  materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(materials.size() - 1);
}

void add_surfaces(Trace& trace, Surfaces surfaces, const glm::vec3& sun, const Ambient& ambient) {
  const auto has_texture = [&](std::uint32_t material) {
    return std::ranges::any_of(kTextureSlots, [&](const TextureSlot& slot) {
      return (surfaces.materials[material].*slot.texture).has_value();
    });
  };
  for (Mesh& mesh : trace.meshes)
    if (std::ranges::none_of(mesh.materials, has_texture)) mesh.uvs[0].clear();
  trace.images = std::move(surfaces.images);
  trace.materials = std::move(surfaces.materials);
  Frame& frame = trace.frames[0];
  frame.lighting.lights[0].color = sun;
  frame.lighting.ambient = ambient;
  for (Draw& draw : frame.draws) draw.shading = Shading::unlit;  // of flat triangles, which there are none of
}

int divisions(double budget, double per_square, int least) {
  return std::max(least, static_cast<int>(std::lround(std::sqrt(std::max(budget, 0.0) / per_square))));
}

}  // namespace beampipe
