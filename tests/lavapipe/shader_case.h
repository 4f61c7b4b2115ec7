// A fragment shader with all that it reads, for kSide x kSide pixels.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stages/spirv/simplify.h"
#include "traces/program.h"

namespace beampipe {

inline constexpr std::uint32_t kSide = 32;
inline constexpr std::size_t kPixels = std::size_t{kSide} * kSide;
// Of all pixels.
inline constexpr float kDepth = 0.25f;

using FourBits = std::array<std::uint32_t, 4>;

// What the shader reads at a location: of each vertex four floats or integers. Integers are flat.
struct CaseInput {
  bool is_integer = false, is_flat = false;
  std::vector<FourBits> vertices;
};

struct ShaderCase {
  std::vector<std::uint32_t> words;
  std::vector<SpecializationConstant> specialization{};
  ProgramUse use{};  // its program is `words`
  std::vector<ProgramImage> images{};
  std::vector<ProgramSampler> samplers{};
  // A triangle that covers all pixels: its first vertex at the upper left corner of the picture, the others as far
  // again beyond the upper right and the lower left one; numbers are linear, and flat ones those of
  // the first vertex. Else a point in each pixel, row by row.
  bool is_triangle = false;
  std::map<std::uint32_t, CaseInput> inputs{};  // by location

  Specialization constants() const {
    Specialization all;
    for (const SpecializationConstant& each : specialization) all[each.id].push_back(each.bits);
    return all;
  }
};

// What the shader writes at a location. Channels that it does not write may have any bits.
struct CaseOutput {
  bool is_integer = false;
  std::vector<FourBits> pixels{};
};

struct CaseOutputs {
  std::map<std::uint32_t, CaseOutput> locations;
  std::vector<bool> is_kept;  // of each pixel: not discarded
};

}  // namespace beampipe
