// Textures of the two interiors, stairs and study.
#pragma once

#include "traces/scenes/textures.h"

namespace beampipe {

// Stripes with a sprig in each second one.
TextureImage paint_wallpaper(const glm::dvec4& ground, const glm::dvec4& figure);

// Knots in a pattern of lozenges, with a border along the sides that u leads to.
TextureImage paint_carpet(const glm::dvec4& ground, const glm::dvec4& figure);

// Four boards, along x.
TextureImage paint_boards();

}  // namespace beampipe
