// What a shader asks of images, which ShaderExecutor leaves to its caller: filters, formats, mip levels, and the
// counting of texels.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "stages/spirv/lane_program.h"

namespace beampipe {

inline constexpr std::size_t kShaderLanes = 64;

// 32 bits for each lane.
struct LaneRow {
  alignas(64) std::array<std::uint32_t, kShaderLanes> bits;

  float number(std::size_t lane) const { return std::bit_cast<float>(bits[lane]); }
  void set(std::size_t lane, float value) { bits[lane] = std::bit_cast<std::uint32_t>(value); }
};

// One instruction, for all lanes. A row that the instruction does not have is null. Coordinates: as in SPIR-V, numbers,
// or integers for `fetch`; of arrays, the layer comes last. Projective ones have been divided.
struct ImageRequest {
  ImageAction action;
  std::uint32_t image = 0;         // index in LaneProgram::images
  std::uint32_t sampler = kNoRow;  // index in LaneProgram::samplers; kNoRow: of the image itself, or none is needed
  const LaneRow *image_element = nullptr, *sampler_element = nullptr;  // integers, of an array; null: 0
  std::array<const LaneRow*, 4> coordinates{};
  std::array<const LaneRow*, 3> dx{},
      dy{};                                // how coordinates change per pixel, to the right and down, without the layer
  std::array<const LaneRow*, 3> offset{};  // integers, in texels
  const LaneRow *lod = nullptr, *bias = nullptr, *least_lod = nullptr;  // numbers; lod of fetch, query_size: integers
  const LaneRow* reference = nullptr;                                   // of a comparison of depths
  std::uint32_t component = 0;                                          // gather: which one
  std::size_t lanes = 0;                                                // so many at most
  const LaneRow* active = nullptr;                                      // lanes that ask: not 0

  bool asks(std::size_t lane) const { return active->bits[lane] != 0; }
};

class ImageReader {
 public:
  virtual ~ImageReader() = default;

  // Sets up to four components of each lane that asks: numbers or integers, as the image has them, and integers for
  // queries of sizes and levels. Of query_lod: the level that is read, and that before it is clamped.
  virtual void read(const ImageRequest& request, const std::array<LaneRow*, 4>& texel) = 0;
};

}  // namespace beampipe
