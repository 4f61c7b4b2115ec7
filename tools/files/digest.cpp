#include "tools/files/digest.h"

#include <lzma.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <type_traits>
#include <vector>

namespace beampipe {
namespace {

class Digest {
 public:
  void add_bytes(const void* bytes, std::size_t size) {
    crc_ = lzma_crc64(static_cast<const std::uint8_t*>(bytes), size, crc_);
  }

  template <class Value>
  void add(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    add_bytes(&value, sizeof value);
  }

  template <class Value>
  void add(const std::vector<Value>& values) {
    add(values.size());
    add_bytes(values.data(), values.size() * sizeof(Value));
  }

  template <class Value>
  void add(const std::optional<Value>& value) {
    add(value.has_value());
    if (value) add(*value);
  }

  template <class... Values>
  void add_all(const Values&... values) {
    (add(values), ...);
  }

  std::string text() const {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(crc_));
    return digits;
  }

 private:
  std::uint64_t crc_ = 0;
};

// Member by member: what lies between members is undefined.
void add(const Blend& blend, Digest& digest) { digest.add_all(blend.color, blend.alpha, blend.constant); }

void add(const ProgramUse& use, Digest& digest) {
  digest.add_all(use.program, use.push_constants);
  for (const BoundBuffer& each : use.buffers) digest.add_all(each.set, each.binding, each.element, each.bytes);
  for (const BoundImage& each : use.images) {
    digest.add_all(each.set, each.binding, each.element, each.image, each.sampler, each.base_level, each.base_layer,
                   each.levels, each.layers);
    digest.add_bytes(each.swizzle.data(), each.swizzle.size());
  }
}

}  // namespace

std::string digest_of(std::string_view bytes) {
  Digest digest;
  digest.add_bytes(bytes.data(), bytes.size());
  return digest.text();
}

std::string digest_of(const Trace& trace) {
  Digest digest;
  for (const TextureImage& image : trace.images) digest.add_all(image.width, image.height, image.texels);
  for (const Material& material : trace.materials) {
    digest.add_all(material.base_color, material.base_texture, material.metallic, material.roughness,
                   material.metallic_roughness_texture, material.normal_texture, material.normal_scale,
                   material.emissive, material.emissive_texture, material.alpha_mode, material.alpha_cutoff,
                   material.double_sided, material.unlit);
  }
  for (const ShaderProgram& program : trace.programs) {
    digest.add_all(program.spirv, program.specialization);
    for (const ProgramInput& input : program.inputs)
      digest.add_all(input.location, input.component, input.count, input.interpolation, input.integer);
  }
  for (const ProgramImage& image : trace.program_images)
    digest.add_all(image.shape, image.format, image.width, image.height, image.depth, image.layers, image.array,
                   image.levels, image.texels);
  for (const ProgramSampler& sampler : trace.program_samplers)
    digest.add_all(sampler.mag, sampler.min, sampler.mip, sampler.wrap, sampler.lod_bias, sampler.least_lod,
                   sampler.most_lod, sampler.anisotropy, sampler.compare, sampler.border, sampler.unnormalized);
  for (const Mesh& mesh : trace.meshes) {
    digest.add_all(mesh.positions, mesh.ws, mesh.triangles, mesh.colors, mesh.materials, mesh.normals, mesh.tangents,
                   mesh.uvs[0], mesh.uvs[1], mesh.vertex_colors);
    if (!mesh.varyings.empty()) digest.add(mesh.varyings);
  }
  for (const Frame& frame : trace.frames) {
    digest.add_all(frame.width, frame.height, frame.background, frame.view, frame.projection, frame.lighting.lights,
                   frame.lighting.ambient, frame.draws.size());
    if (frame.target != ColorTarget::srgb) digest.add(frame.target);
    if (frame.background_alpha != 1) digest.add(frame.background_alpha);
    const CapturedPictures& captured = frame.capture.pictures;
    if (captured.color || !captured.depth.empty()) digest.add_all(captured.samples, captured.clear_depth);
    for (const Draw& draw : frame.draws) {
      const DrawState& state = draw.state;
      const DepthState& depth = state.depth;
      digest.add_all(draw.mesh, draw.transform, draw.kd, draw.material, draw.cull, draw.shading);
      digest.add_all(state.viewport, state.scissor, state.front_is_clockwise, state.blend.has_value());
      if (state.blend) add(*state.blend, digest);
      digest.add_all(state.color_mask, state.stencil);
      digest.add_all(depth.test, depth.write, depth.function, depth.near, depth.far, depth.bias, depth.clip,
                     depth.cleared_before);
      if (state.alpha_to_coverage) digest.add(state.alpha_to_coverage);
      if (state.stencil_back) digest.add_all("back", *state.stencil_back);
      if (state.stencil_cleared_to) digest.add_all("cleared", *state.stencil_cleared_to);
      if (draw.program) add(*draw.program, digest);
    }
  }
  return digest.text();
}

std::string digest_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  Digest digest;
  std::vector<char> bytes(1 << 20);
  while (file.read(bytes.data(), std::ssize(bytes)) || file.gcount() > 0)
    digest.add_bytes(bytes.data(), static_cast<std::size_t>(file.gcount()));
  return digest.text();
}

}  // namespace beampipe
