#include "tools/evaluate/machine_memory.h"

#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "stages/data/setup_triangle.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/surface/surface_shader.h"
#include "traces/size_text.h"

namespace beampipe {
namespace {

std::uint64_t triangles_of(const Trace& trace, const Frame& frame) {
  std::uint64_t triangles = 0;
  for (const Draw& draw : frame.draws) triangles += trace.meshes[draw.mesh].triangles.size();
  return triangles;
}

// By material.
std::vector<bool> drawn_materials(const Trace& trace, const Frame& frame) {
  std::vector<bool> drawn(trace.materials.size());
  for (const Draw& draw : frame.draws) {
    if (draw.kd) continue;
    if (draw.material) {
      drawn[*draw.material] = true;
      continue;
    }
    for (const std::uint32_t material : trace.meshes[draw.mesh].materials)
      if (material != kNoMaterial) drawn[material] = true;
  }
  return drawn;
}

// Of the tested alpha of cutouts. They are made one after the other: while one is made there is also a copy of its
// image, and two of its levels are linear numbers.
std::uint64_t tested_alpha_memory(const Trace& trace, const Frame& frame) {
  const std::vector<std::uint32_t> tests = number_alpha_tests(trace);
  const std::vector<bool> drawn = drawn_materials(trace, frame);
  std::vector<bool> counted(trace.materials.size());  // by test
  std::uint64_t bytes = 0, most_texels = 0;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    if (!drawn[i] || tests[i] == kNoAlphaTest || counted[tests[i]]) continue;
    counted[tests[i]] = true;
    const TextureImage& image = trace.images[trace.materials[i].base_texture->image];
    bytes += tested_alpha_bytes(image);
    most_texels = std::max<std::uint64_t>(most_texels, image.texels.size());
  }
  return bytes + most_texels * sizeof(glm::u8vec4) + most_texels * 5 / 4 * sizeof(glm::vec4);
}

// Of all textures while they are made, which happens at the same time. The levels have 4/3 as many texels as the image.
// Those of one level and the next one are linear numbers until they are rounded.
std::uint64_t texture_memory(const Trace& trace, const Frame& frame) {
  std::vector<bool> used(2 * trace.images.size());  // in linear light, as sRGB
  for (const Material& material : trace.materials) {
    for (const auto* srgb : {&material.base_texture, &material.emissive_texture})
      if (*srgb) used[TextureSet::index((*srgb)->image, ColorSpace::srgb)] = true;
    for (const auto* linear : {&material.metallic_roughness_texture, &material.normal_texture})
      if (*linear) used[TextureSet::index((*linear)->image, ColorSpace::linear)] = true;
  }
  std::uint64_t texels = 0;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) texels += trace.images[i / 2].texels.size();
  return texels * 4 / 3 * sizeof(glm::u8vec4) + texels * 5 / 4 * sizeof(glm::vec4) + tested_alpha_memory(trace, frame);
}

}  // namespace

std::uint64_t machine_memory() {
  return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t frame_memory(const Trace& trace, const Frame& frame, std::uint32_t bytes_per_pixel) {
  const std::uint64_t pixels = std::uint64_t{frame.width} * frame.height, triangles = triangles_of(trace, frame);
  std::uint64_t bytes = pixels * bytes_per_pixel + triangles * SetupTriangles::kTriangleBytes;
  if (!has_varying_surfaces(trace, frame)) return bytes;
  std::uint64_t vertices = 0;
  for (const Draw& draw : frame.draws) vertices += trace.meshes[draw.mesh].positions.size();
  bytes += triangles * sizeof(SetupSurface) + vertices * sizeof(SurfaceVertex) + texture_memory(trace, frame);
  // A material is shaded in another way for each of 8 sets of what meshes may have.
  return bytes + std::uint64_t{trace.materials.size()} * 8 * sizeof(SurfaceShader::Work);
}

void require_memory(const Trace& trace, const Frame& frame, std::uint32_t bytes_per_pixel, const std::string& name,
                    std::uint64_t memory) {
  const std::uint64_t needed = frame_memory(trace, frame, bytes_per_pixel);
  if (needed <= memory) return;
  throw std::runtime_error(
      name + ": " + size_text(frame.width, frame.height) + " pixels and " + std::to_string(triangles_of(trace, frame)) +
      " triangles" +
      (has_varying_surfaces(trace, frame) ? ", with " + std::to_string(trace.materials.size()) + " materials and " +
                                                std::to_string(trace.images.size()) + " images,"
                                          : "") +
      " may need " + std::to_string(needed >> 20) + " MiB, and this machine has " + std::to_string(memory >> 20));
}

}  // namespace beampipe
