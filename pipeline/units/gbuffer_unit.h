// Shading after visibility in a bin: materials into a G-buffer, light from the G-buffer into colour, colour into the
// picture.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/units/depth_test_unit.h"
#include "stages/data/pixel_formats.h"
#include "stages/picture/shade.h"

namespace beampipe {

class GBufferUnit {
 public:
  explicit GBufferUnit(Bin& bin);

  // Materials of fragments that have just passed the equal-depth test, in 2x2 quads and in primitive order.
  void write_fragments(const std::vector<SampleFragment>& fragments, const DepthTestUnit& depth_test);
  void end_pass() { gbuffer_.flush(shading_.counters); }

  // Materials of the pixels that a visibility buffer shows, one by one. Reads the visibility buffer.
  void write_visible(DepthTestUnit& visibility);

  // Light and resolve, for the pixels of a surface of one sample per pixel that show a triangle. Returns the picture.
  std::vector<glm::vec4> light_and_resolve(DepthTestUnit& surface);

 private:
  Bin& bin_;
  BinStage shading_, lighting_;
  AttributesInOrder attributes_;
  TileSurface gbuffer_;
};

}  // namespace beampipe
