// The formulas of tests and blending, for numbers and for numbers that count (stages/cost/counting.h).
//
// Sources: as in stages/rop/rop_rules.h.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "simd/scalar.h"
#include "traces/draw_state.h"

namespace beampipe {

// Does what arrives pass, compared with what is stored?
template <class Value>
bool passes(Compare function, const Value& arriving, const Value& stored) {
  switch (function) {
    case Compare::never:
      return false;
    case Compare::less:
      return arriving < stored;
    case Compare::equal:
      return arriving == stored;
    case Compare::less_equal:
      return arriving <= stored;
    case Compare::greater:
      return arriving > stored;
    case Compare::not_equal:
      return arriving != stored;
    case Compare::greater_equal:
      return arriving >= stored;
    case Compare::always:
      break;
  }
  return true;
}

// Values of stencils are 0..255.
template <class Bits>
bool stencil_passes(const Stencil& stencil, const Bits& stored) {
  const Bits mask(stencil.mask);
  return passes(stencil.function, Bits(stencil.reference) & mask, stored & mask);
}

// What is stored after one of the stencil's operations.
template <class Bits>
Bits stencil_after(StencilOperation operation, const Stencil& stencil, const Bits& stored) {
  const Bits most(255u), one(1u);
  Bits value = stored;
  switch (operation) {
    case StencilOperation::keep:
      return stored;
    case StencilOperation::zero:
      value = Bits(0u);
      break;
    case StencilOperation::replace:
      value = Bits(stencil.reference);
      break;
    case StencilOperation::increment:
      value = lesser(stored + one, most);
      break;
    case StencilOperation::decrement:
      value = greater(stored, one) - one;
      break;
    case StencilOperation::invert:
      value = stored ^ most;
      break;
    case StencilOperation::increment_wrap:
      value = (stored + one) & most;
      break;
    case StencilOperation::decrement_wrap:
      value = (stored + most) & most;
      break;
  }
  const Bits written(stencil.write_mask);
  return (stored & (written ^ most)) | (value & written);
}

// What a channel c is multiplied by. Colours are RGBA.
template <class Real>
Real blend_factor(BlendFactor factor, int c, const Real source[4], const Real stored[4], const glm::vec4& constant) {
  const Real one(1.0f);
  switch (factor) {
    case BlendFactor::zero:
      return Real(0.0f);
    case BlendFactor::one:
      return one;
    case BlendFactor::source_color:
      return source[c];
    case BlendFactor::one_minus_source_color:
      return one - source[c];
    case BlendFactor::source_alpha:
      return source[3];
    case BlendFactor::one_minus_source_alpha:
      return one - source[3];
    case BlendFactor::destination_color:
      return stored[c];
    case BlendFactor::one_minus_destination_color:
      return one - stored[c];
    case BlendFactor::destination_alpha:
      return stored[3];
    case BlendFactor::one_minus_destination_alpha:
      return one - stored[3];
    case BlendFactor::source_alpha_saturate:
      return c == 3 ? one : lesser(source[3], one - stored[3]);
    case BlendFactor::constant:
      return Real(constant[c]);
    case BlendFactor::one_minus_constant:
      return one - Real(constant[c]);
    case BlendFactor::constant_alpha:
      return Real(constant[3]);
    case BlendFactor::one_minus_constant_alpha:
      return one - Real(constant[3]);
  }
  return one;
}

// Factors 0 and 1 multiply nothing.
template <class Real>
Real times_factor(BlendFactor factor, int c, const Real& value, const Real source[4], const Real stored[4],
                  const glm::vec4& constant) {
  if (factor == BlendFactor::zero) return Real(0.0f);
  if (factor == BlendFactor::one) return value;
  return value * blend_factor(factor, c, source, stored, constant);
}

template <class Real>
Real blended_channel(const Blend& blend, int c, const Real source[4], const Real stored[4]) {
  const BlendEquation& equation = c == 3 && blend.alpha ? *blend.alpha : blend.color;
  if (equation.operation == BlendOperation::min) return lesser(source[c], stored[c]);
  if (equation.operation == BlendOperation::max) return greater(source[c], stored[c]);
  const Real new_part = times_factor(equation.source, c, source[c], source, stored, blend.constant);
  const Real old_part = times_factor(equation.destination, c, stored[c], source, stored, blend.constant);
  if (equation.operation == BlendOperation::subtract) return new_part - old_part;
  if (equation.operation == BlendOperation::reverse_subtract) return old_part - new_part;
  if (equation.destination == BlendFactor::zero) return new_part;
  if (equation.source == BlendFactor::zero) return old_part;
  return new_part + old_part;
}

// How much of what arrives and of what is stored is in the result: the means of the factors of RGB. Of the least or the
// greatest, all of one of them.
struct BlendParts {
  float added = 1, kept = 0;
};
inline BlendParts blend_parts(const Blend& blend, const glm::vec4& source, const glm::vec4& stored) {
  constexpr float kThird = 1.0f / 3.0f;
  const BlendEquation& equation = blend.color;
  const auto mean_factor = [&](BlendFactor factor) {
    float sum = 0;
    for (int c = 0; c < 3; ++c) sum += blend_factor(factor, c, &source[0], &stored[0], blend.constant);
    return sum * kThird;
  };
  const float added = mean_factor(equation.source), kept = mean_factor(equation.destination);
  const float brighter = source.r + source.g + source.b - (stored.r + stored.g + stored.b);
  switch (equation.operation) {
    case BlendOperation::add:
      return {added, kept};
    case BlendOperation::subtract:
      return {added, -kept};
    case BlendOperation::reverse_subtract:
      return {-added, kept};
    case BlendOperation::min:
      return brighter < 0 ? BlendParts{1, 0} : BlendParts{0, 1};
    case BlendOperation::max:
      return brighter > 0 ? BlendParts{1, 0} : BlendParts{0, 1};
  }
  return {};
}

}  // namespace beampipe
