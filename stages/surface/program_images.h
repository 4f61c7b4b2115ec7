// How programs' own shaders read images: texels, filters and mip levels.
//
// Source: Khronos Group, Vulkan 1.3 Specification, chapter "Image Operations". Filter weights are not rounded.
// Comparisons clamp their reference to 0..1, as those of fixed-point depths do. A gather reads level 0 of the view.
//
// Vulkan leaves open how anisotropic samplers filter. Here they do it as Mesa's software drivers, by ellipse_filter.h:
// in the level, rounded down, in which the shorter of the footprint's two slopes is one to two texels. How large
// ProgramSampler::anisotropy is does not matter: Mesa 22.3 compares the shorter slope with itself where it would limit
// their ratio (lp_build_pmin).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stages/spirv/image_reader.h"
#include "stages/spirv/lane_program.h"
#include "stages/surface/texel_requests.h"
#include "traces/program.h"

namespace beampipe {

// An image as a draw binds it. Without an image, all reads give 0.
struct ImageView {
  const ProgramImage* image = nullptr;
  std::uint32_t number = 0;                 // of the image, in Trace::program_images
  const ProgramSampler* sampler = nullptr;  // of the image itself
  std::uint32_t base_level = 0, levels = 0, base_layer = 0, layers = 0;
  std::array<char, 4> swizzle{'r', 'g', 'b', 'a'};
  std::vector<std::uint64_t> level_starts{};  // of the image, in bytes
};

// What a draw binds for its shader, by LaneProgram::images and samplers, and there by element.
struct BoundImages {
  std::vector<std::vector<ImageView>> images;
  std::vector<std::vector<const ProgramSampler*>> samplers;
};
BoundImages bound_images(const LaneProgram& program, const std::vector<BoundImage>& bound,
                         const std::vector<ProgramImage>& images, const std::vector<ProgramSampler>& samplers);

class ProgramImages : public ImageReader {
 public:
  // All must outlive it. Adds the texels that lanes of `counted` read to `requests`, if there are any: what four lanes
  // read with one instruction is one request.
  ProgramImages(const LaneProgram& program, const BoundImages& bound, std::uint64_t counted = 0,
                TexelRequests* requests = nullptr)
      : program_(program), bound_(bound), counted_(counted), requests_(requests) {}

  void read(const ImageRequest& request, const std::array<LaneRow*, 4>& texel) override;

 private:
  const LaneProgram& program_;
  const BoundImages& bound_;
  std::uint64_t counted_;
  TexelRequests* requests_;
};

}  // namespace beampipe
