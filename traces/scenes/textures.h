// Textures that the scenes paint. Texels come from additions, multiplications, divisions and square roots alone, which
// round in the same way everywhere, so that an image has the same bits on every machine.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <string>

#include "traces/material.h"

namespace beampipe {

// A size in texels.
struct ImageSize {
  std::uint32_t width, height;
};

// A value at a point of an image: x to the right and y down, both from 0 to 1.
using Pattern = std::function<double(double x, double y)>;
using ColorPattern = std::function<glm::dvec4(double x, double y)>;

double smooth_step(double low, double high, double x);  // 0 up to `low`, 1 from `high` on, smooth between
double triangle_wave(double x);                         // 0 at integers, 1 half way between them

// Random values at the points of a lattice with `columns` x `rows` cells, joined smoothly; 0..1. Copies of the image
// join without a seam.
double lattice_noise(double x, double y, int columns, int rows, std::uint64_t seed);

// The sum of `octaves` of it, each with twice the cells and half the weight of the last; 0..1.
double fractal_noise(double x, double y, int columns, int rows, int octaves, std::uint64_t seed);

// RGBA as stored, 0..1 (sRGB where the texture's slot says so).
TextureImage paint_image(std::string name, ImageSize size, const ColorPattern& color);

// The normals of a surface with this height, which is in units of the image's width. Copies of the image join without a
// seam.
TextureImage paint_normals(std::string name, ImageSize size, const Pattern& height);

// Roughness in G; metallic is 0.
TextureImage paint_roughness(std::string name, ImageSize size, const Pattern& roughness);

// Grain along x, 0 where the wood is light and 1 where it is dark.
double wood_grain(double x, double y);

// The colour by which a wooden surface's own colour is multiplied.
glm::dvec4 wood_tint(double grain);

}  // namespace beampipe
