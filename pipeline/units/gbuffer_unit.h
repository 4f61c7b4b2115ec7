// Shading after visibility in a bin: materials into a G-buffer, light from the G-buffer into colour, colour into the
// picture.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/units/depth_test_unit.h"
#include "stages/data/pixel_formats.h"
#include "stages/picture/shade.h"
#include "stages/samples/materials.h"

namespace beampipe {

// Stage `material_sort` of a bin: material_sort(), whose list is written to memory and read again by stage `shade`.
// The caller charges what `triangles` are read from.
std::vector<std::uint32_t> sort_materials(Bin& bin, const std::vector<std::uint32_t>& triangles,
                                          const Materials& materials);

class GBufferUnit {
 public:
  // `sampling`: one cell per pixel. It must outlive the unit.
  GBufferUnit(Bin& bin, const Sampling& sampling);

  // Materials of fragments that have just passed the equal-depth test, in 2x2 quads and in primitive order.
  void write_fragments(const std::vector<SampleFragment>& fragments, const DepthTestUnit& depth_test);

  // Materials of the samples at which a visibility buffer shows a triangle, one by one, sorted by material. Reads the
  // visibility buffer twice: to sort, and to shade.
  void write_visible(DepthTestUnit& visibility, const Materials& materials);

  // Light and resolve, for the samples that show a triangle. Returns the picture.
  std::vector<glm::vec4> light_and_resolve(DepthTestUnit& surface);

 private:
  CellPlace place_of(std::size_t sample) const;
  void write_samples(const std::vector<std::uint32_t>& samples, TileSurface& to, StageCounters& counters) const;

  Bin& bin_;
  const SamplePattern& pattern_;
  std::uint32_t samples_;  // per pixel
  BinStage shading_, lighting_;
  AttributesInOrder attributes_;
  TileSurface gbuffer_;
};

}  // namespace beampipe
