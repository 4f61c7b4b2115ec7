// The textures of a trace as its materials read them.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/surface/mip_chain.h"
#include "stages/surface/tested_alpha.h"
#include "traces/trace.h"

namespace beampipe {

// The images of a trace in the colour spaces in which its materials read them, and the tested alpha of cutouts.
class TextureSet {
 public:
  // Throws std::runtime_error if cutouts test the images at so many cutoffs that the results need more than
  // kMostTestedBytes.
  explicit TextureSet(const Trace& trace);

  static constexpr std::uint64_t kMostTestedBytes = std::uint64_t{4} << 30;

  // Of a texture that a material of the trace reads in this colour space.
  const MipChain& chain(std::uint32_t image, ColorSpace space) const { return chains_[index(image, space)]; }

  // Of a cutout with a base texture. `material`: index into Trace::materials.
  const TestedAlpha& tested_alpha(std::uint32_t material) const { return tested_[tested_of_[material]]; }

  static std::size_t index(std::uint32_t image, ColorSpace space) {
    return 2 * std::size_t{image} + static_cast<std::size_t>(space);
  }
  const std::vector<MipChain>& chains() const { return chains_; }  // by index; those without a use are empty

 private:
  void test_alphas(const Trace& trace);

  std::vector<MipChain> chains_;
  std::vector<TestedAlpha> tested_;
  std::vector<std::size_t> tested_of_;  // by material; materials with the same texture and cutoff share it
};

}  // namespace beampipe
