// What the composers of a bin's surfaces take and give, whatever they keep of a pixel.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/data/fragment.h"
#include "stages/data/pixel_observer.h"
#include "stages/data/position_set.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/shaded_triangle.h"
#include "stages/data/tile.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

// Where an owner is shaded that is not flat: at the centroid of what its triangle covers, at the mean of its positions,
// or in each quarter or sixteenth of the pixel at the mean of its positions there. adaptive: once, or in some quarters
// and sixteenths, with textures filtered over the positions.
enum class OwnerPlace { covered, visible, quarters, sixteenths, adaptive };

struct OwnerShading {
  OwnerPlace at = OwnerPlace::adaptive;
  // adaptive: a part of a pixel is shaded in quarters if its light may vary by more than this
  // (SurfaceShader::light_range), times its share of the pixel.
  float tolerance = 0.1f;
};

// What a bin has in common for all its fragments.
struct OwnersBin {
  const SetupTriangles& triangles;
  const TriangleList& list;              // at most OwnerSlot::kMostTriangles, in the order in which they are taken
  const std::vector<float>* watermarks;  // as in OrderedList; null: nothing is final before the end
  const Tile& tile;
  const PositionSet& positions;
  TileShader shader;
  bool lists_fetches;  // fill OwnersResult::fetched
  OwnerShading shading = {};
  const PixelObservers* observers = nullptr;  // who looks at the pixels; null: nobody
};

// An owner's depth plane was computed again and, with the depths of its vertices, the bounds of its depth.
struct DepthFetch {
  std::uint32_t triangle;
  bool has_vertices = false;
};

// What was done, beside what is charged.
struct OwnersResult {
  std::vector<ShadedTriangle> shaded;  // once for each time that one was shaded
  OperationCounts decisions{};         // of the shader: the sides of footprints, and how far light may vary there
  std::vector<DepthFetch> fetched;
  std::vector<float>* shadings = nullptr;  // by pixel, how often surfaces that are not flat were shaded; or null
  TexelRequests* texels = nullptr;         // where shading adds a request of each invocation; null: nowhere
};

// Counts per pixel of the tile.
struct OwnersMaps {
  std::vector<float>& fragments;  // those that no closed pixel hid
  std::vector<float>& merges;     // how often two owners became one
};

// Fragments in the order of the list. The triangle of the first one is at or after list[first].
struct OwnersBatch {
  const std::vector<Fragment>& fragments;
  std::size_t first;
};

}  // namespace beampipe
