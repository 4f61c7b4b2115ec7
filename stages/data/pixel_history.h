// What happened in one pixel: every triangle that reached it, in the order in which the technique takes them, what
// became of each, and what each is worth in the end. Stages tell it to a PixelObserver while they work.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stages/data/tile.h"

namespace beampipe {

inline constexpr std::uint32_t kNobody = ~0u;  // no fragment: the background, or an empty position

// What became of a triangle that touches the pixel.
enum class Fate {
  no_area,       // it touches the pixel with an area of 0
  cut_out,       // alpha left nothing of it
  no_sample,     // it covers no sample
  closed_off,    // it lies behind a closed pixel
  hidden,        // nearer surfaces have all of its positions
  speck,         // it covers no mask position; its area was added
  speck_hidden,  // it covers no mask position and was not added
  owner,         // it took positions
  composed,      // it was merged into the pixel's aggregate, which has no owners
  stored,        // its colour took the place of what was there, in the API's order
  blended,       // it was blended with what lay behind it, or was there before
};

// Positions that went from one fragment to another. kNobody: they were empty.
struct PositionMove {
  std::uint32_t fragment, positions;
};

// A triangle in the pixel. Positions are mask positions, or the samples of a technique that has them.
struct HistoryFragment {
  std::uint32_t triangle;           // index into SetupTriangles
  std::uint32_t draw = 0;           // index into Frame::draws
  glm::dvec2 corners[3] = {};       // pixels, frame coordinates
  double area = 0;                  // exact, of the triangle in the pixel, 0..1; after alpha
  float nearest = 0, farthest = 0;  // bounds of its depth in the pixel, -1 near to 0 far
  bool is_front = false;            // as in SetupTriangle
  bool is_tiny = false;             // it covers no position of the technique's, whatever it was given
  std::vector<bool> mask = {};      // positions that it covers; empty if it has no mask
  Fate fate = Fate::closed_off;
  std::vector<PositionMove> taken = {};  // positions that it took, and from whom
  std::vector<PositionMove> lost = {};   // positions that it covers and does not own, and who had or took them
};

// What a pixel keeps of one or more fragments.
struct HeldSurface {
  std::vector<std::uint32_t> fragments;  // indices into PixelHistory::fragments
  std::uint32_t positions = 0;
  double area = 0;     // part of the pixel, 0..1, where it is known
  glm::vec3 color{0};  // as the frame's target stores it: linear RGB, unless that is `unorm`; so are the following
};

struct HistoryStep {
  enum class Kind {
    merged,    // two surfaces became one: before[0] and before[1] became after
    settled,   // a surface is final and was added to the pixel: before[0], with its area
    composed,  // the pixel's aggregate before and after a window of fragments
  };
  Kind kind;
  std::uint32_t after_fragment = kNobody;  // it happened when this fragment came; kNobody: after the last one
  std::vector<HeldSurface> before = {};
  std::optional<HeldSurface> after = {};
};

// A part of the sum that makes the pixel: weight times colour.
struct HistoryTerm {
  std::uint32_t fragment;  // kNobody: the background
  double weight;
  glm::dvec3 color;
};

// Of a pixel whose area and colour are known in two ways: what each says, and the result.
struct PixelEstimates {
  glm::dvec4 analytic, counted, result;  // colour times area, and area
};

// The weight of one triangle in one pixel. The pixel is the sum of weight times colour over its triangles; the
// background has what is left to 1.
struct SurfaceWeight {
  std::uint32_t triangle;  // index into SetupTriangles
  float weight;
  std::uint32_t order;  // when it came, where that decides about depth: where surfaces became one; else 0
  bool tiny;            // covers no position of the technique's mask
};
using PixelWeights = std::vector<SurfaceWeight>;

struct PixelHistory {
  PixelAddress at{};
  std::string order = {};                 // in which fragments come, as words
  bool has_samples = false;               // `positions` are samples
  std::vector<glm::vec2> positions = {};  // in the pixel, from its upper left corner, 0..1
  std::vector<HistoryFragment> fragments = {};
  std::vector<HistoryStep> steps = {};
  std::vector<std::uint32_t> owners = {};  // of each position at the end: a fragment or kNobody
  std::vector<HistoryTerm> terms = {};
  std::optional<PixelEstimates> estimates = {};
  glm::vec4 pixel{0};

  // The terms' sum and, to the bit, what it lacks of `pixel`: 0 where the sum rounds to it. That is what formats of
  // colours and limits have changed.
  glm::dvec3 sum() const;
  glm::dvec3 rest() const;

  // The terms' sums by triangle, without the background's.
  PixelWeights weights() const;
};

}  // namespace beampipe
