// Translucent triangles of techniques whose colours come from a G-buffer: they are drawn last, into a layer that then
// goes over the picture.
//
// The layer has a colour and an opacity for each sample of the depth test, so that triangles which meet in a pixel do
// not blend with each other.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/units/depth_test_unit.h"

namespace beampipe {

inline constexpr std::uint32_t kLayerBytes = 8;  // of a sample: fp16 RGBA

// The layer where each pixel has so many samples.
Surface translucent_layer(std::uint32_t samples);

// Draws the bin's translucent triangles in the order of draws. They are tested against the depth that opaque triangles
// left, do not write it, and are shaded in 2x2 quads. Call it when the opaque picture is finished: the depth test's
// surface has the layer from then on. Returns the layer's mean in each pixel of the tile: linear RGB, times alpha, and
// alpha. Empty if nothing in the frame is translucent. Stages: sample_raster, blend, shade.
std::vector<glm::vec4> draw_translucent(Bin& bin, DepthTestUnit& depth_test, ShadeAt at);

// Puts a layer over pixels: RGB, and A, the part that geometry covers. `layer` may be empty, and `observers`
// null.
void put_over(const std::vector<glm::vec4>& layer, const PixelObservers* observers, std::vector<glm::vec4>& picture);
glm::vec4 put_over(const glm::vec4& layer, const glm::vec4& pixel);

}  // namespace beampipe
