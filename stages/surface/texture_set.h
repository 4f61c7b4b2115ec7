// The textures of a trace as its materials read them, and its programs.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "stages/surface/mip_chain.h"
#include "stages/surface/program_set.h"
#include "stages/surface/tested_alpha.h"
#include "traces/trace.h"

namespace beampipe {

inline constexpr std::uint32_t kNoAlphaTest = ~0u;

// The alpha test of each material, from 0 without gaps; materials that test the same texture in the same way share
// one. kNoAlphaTest: it is no cutout with a base texture, or passes everywhere.
std::vector<std::uint32_t> number_alpha_tests(const Trace& trace);

// The images of a trace in the colour spaces in which its materials read them, and the tested alpha of those cutouts
// for which it was asked. And the trace's programs.
class TextureSet {
 public:
  // `name`: of the trace, for messages.
  explicit TextureSet(const Trace& trace, std::string name = "trace");

  static constexpr std::uint64_t kMostTestedBytes = std::uint64_t{4} << 30;

  // Tests alpha for those of these materials (one flag each) that have a test, unless that was done before. `trace`: as
  // in the constructor. May be called from any thread. Throws std::runtime_error, one line, before memory is taken, if
  // all results together would need more than kMostTestedBytes.
  void test_alphas(const Trace& trace, const std::vector<bool>& materials) const;

  // Of a texture that a material of the trace reads in this colour space.
  const MipChain& chain(std::uint32_t image, ColorSpace space) const { return chains_[index(image, space)]; }

  // Of a material that has an alpha test, after test_alphas().
  const TestedAlpha& tested_alpha(std::uint32_t material) const { return tested_[alpha_tests_[material]]; }

  std::uint32_t alpha_test(std::uint32_t material) const { return alpha_tests_[material]; }
  const std::vector<std::uint32_t>& images_of_tests() const { return images_of_tests_; }  // by alpha test

  static std::size_t index(std::uint32_t image, ColorSpace space) {
    return 2 * std::size_t{image} + static_cast<std::size_t>(space);
  }
  const ProgramSet& programs() const { return programs_; }
  const std::vector<MipChain>& chains() const { return chains_; }  // by index; those without a use are empty

 private:
  std::string name_;
  ProgramSet programs_;
  std::vector<MipChain> chains_;
  std::vector<std::uint32_t> alpha_tests_;  // by material
  std::vector<std::uint32_t> images_of_tests_;
  mutable std::vector<TestedAlpha> tested_;  // by alpha test; without levels until it is asked for
  mutable std::uint64_t tested_bytes_ = 0;
  mutable std::mutex mutex_;
};

}  // namespace beampipe
