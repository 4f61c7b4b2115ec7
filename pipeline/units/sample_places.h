// Where sample fragments are shaded, in a bin. A triangle and a cell say that, so nothing is kept with the samples.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "pipeline/bins/bin.h"
#include "stages/data/sample_fragment.h"
#include "stages/picture/resolve.h"
#include "stages/samples/shading_point.h"

namespace beampipe {

class SamplePlaces {
 public:
  // The bin and the sampling must outlive it.
  SamplePlaces(const Bin& bin, const Sampling& sampling, ShadeAt at) : bin_(bin), sampling_(sampling), at_(at) {}

  // `cell`: in the tile, as in SampleAccess.
  CellPlace of(std::uint32_t triangle, std::size_t cell) const;

  // In the fragment's pixel.
  glm::vec2 of(const SampleFragment& fragment) const;

  // Of each fragment whose triangle is not flat; others may have any place.
  std::vector<glm::vec2> of(const std::vector<SampleFragment>& fragments) const;

  // Adds the texels that shading the fragments in 2x2 quads reads, a request for each quad. Helper invocations read at
  // the centres of their cells or, with ShadeAt::sample, at the samples there.
  void add_quad_texels(const std::vector<SampleFragment>& fragments, TexelRequests& texels) const;

  // The colours of the fragments, RGBA, which are shaded in 2x2 quads. `texels`: as above; null: they are not noted.
  std::vector<glm::vec4> shade_quads(const std::vector<SampleFragment>& fragments, TexelRequests* texels) const;

  // Adds the texels that one invocation reads, as a request of its own.
  void add_texels(std::uint32_t triangle, std::size_t cell, TexelRequests& texels) const;

 private:
  Invocation invocation(const SampleFragment& fragment) const;
  // Adds the texels of materials, and leaves those of programs, which are shaded together: fragments, in their order,
  // and helpers.
  struct OfPrograms {
    std::vector<Invocation> fragments, helpers;
  };
  OfPrograms add_quad_texels_of_materials(const std::vector<SampleFragment>& fragments, TexelRequests& texels) const;

  const Bin& bin_;
  const Sampling& sampling_;
  ShadeAt at_;
};

}  // namespace beampipe
