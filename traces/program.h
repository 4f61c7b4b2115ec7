// Fragment shaders that a program itself brought, and what their draws give them, as Vulkan knows it.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "traces/draw_state.h"
#include "traces/material.h"

namespace beampipe {

// How an input varies over a triangle: with perspective, linearly in the picture, or as its first vertex has it.
enum class InputInterpolation { smooth, linear, flat };

// Components of one location that the shader reads. Their bits are floats, or integers.
struct ProgramInput {
  std::uint32_t location = 0, component = 0, count = 4;  // component + count <= 4
  InputInterpolation interpolation = InputInterpolation::smooth;
  bool integer = false;
  bool operator==(const ProgramInput&) const = default;
};

struct SpecializationConstant {
  std::uint32_t id = 0, bits = 0;
  bool operator==(const SpecializationConstant&) const = default;
};

struct ShaderProgram {
  std::string name;
  std::vector<std::uint32_t> spirv;  // a module with one fragment shader
  std::vector<SpecializationConstant> specialization;
  std::vector<ProgramInput> inputs;  // in the order in which Mesh::varyings has them
};

enum class ImageShape { d1, d2, d3, cube };

// As in VkFormat; channels stand in this order.
enum class TexelFormat {
  R8_UNORM,
  R8G8_UNORM,
  R8G8B8A8_UNORM,
  R8G8B8A8_SRGB,
  B8G8R8A8_UNORM,
  B8G8R8A8_SRGB,
  R16_SFLOAT,
  R16G16_SFLOAT,
  R16G16B16A16_SFLOAT,
  R16G16B16A16_UNORM,
  R32_SFLOAT,
  R32G32B32A32_SFLOAT,
  R32G32B32A32_UINT,
  R32G32B32A32_SINT,
  D32_SFLOAT,
};

std::uint64_t texel_bytes(TexelFormat format);

// An image with its mip levels. A level of number n has max(1, side >> n) texels on each side.
struct ProgramImage {
  std::string name;
  ImageShape shape = ImageShape::d2;
  TexelFormat format = TexelFormat::R8G8B8A8_UNORM;
  std::uint32_t width = 0, height = 1, depth = 1;  // texels of level 0
  std::uint32_t layers = 1;                        // six for each cube
  bool array = false;
  std::uint32_t levels = 1;
  // Level by level, in a level layer by layer or slice by slice, and there row by row; row 0 is at v = 0.
  std::vector<std::uint8_t> texels;
};

// Where a level starts in an image's texels; at `levels`: how many bytes it has.
std::uint64_t level_start(const ProgramImage& image, std::uint32_t level);

enum class SamplerWrap { repeat, mirror, clamp_to_edge, clamp_to_border, mirror_clamp };

struct ProgramSampler {
  Filter mag = Filter::linear, min = Filter::linear, mip = Filter::linear;
  std::array<SamplerWrap, 3> wrap{};  // along u, v and w
  float lod_bias = 0, least_lod = 0, most_lod = 1000;
  float anisotropy = 1;              // 1..16; 1 is none
  std::optional<Compare> compare{};  // of a depth with the reference
  glm::vec4 border{0.0f};
  bool unnormalized = false;  // coordinates are texels
  bool operator==(const ProgramSampler&) const = default;
};

// What a draw binds. `set`, `binding`, `element`: as in SPIR-V; the element is that of an array.
struct BoundBuffer {
  std::uint32_t set = 0, binding = 0, element = 0;
  std::vector<std::uint8_t> bytes;
  bool operator==(const BoundBuffer&) const = default;
};
struct BoundImage {
  std::uint32_t set = 0, binding = 0, element = 0;
  std::optional<std::uint32_t> image{};    // index into Trace::program_images; none: a sampler alone
  std::optional<std::uint32_t> sampler{};  // index into Trace::program_samplers
  std::string swizzle = "rgba";            // of each component the channel that it shows: letters of "rgba01"
  // The part that is seen.
  std::uint32_t base_level = 0, base_layer = 0;
  std::optional<std::uint32_t> levels{}, layers{};  // to the last one
  bool operator==(const BoundImage&) const = default;
};

struct ProgramUse {
  std::uint32_t program = 0;  // index into Trace::programs
  std::vector<BoundBuffer> buffers;
  std::vector<std::uint8_t> push_constants;
  std::vector<BoundImage> images;
  bool operator==(const ProgramUse&) const = default;
};

// How many numbers a vertex has in Mesh::varyings.
std::uint64_t varyings_of(const ShaderProgram& program);

}  // namespace beampipe
