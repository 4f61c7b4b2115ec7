// What hard cases are built from: colours, a builder of traces, and the reasons of stated limits.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <initializer_list>
#include <string>
#include <vector>

#include "tools/stress/hard_cases.h"
#include "traces/trace.h"

namespace beampipe {

inline constexpr double kUnorm8Error = 0.5 / 255;  // of a sum that is rounded to 8 bits

// Colours whose sums are exact in fp16 if there are few terms, so that an error is not due to the format.
inline constexpr glm::vec3 kRed{0.75f, 0.25f, 0.125f}, kGreen{0.125f, 0.75f, 0.25f}, kBlue{0.25f, 0.125f, 0.75f};
inline constexpr glm::vec3 kBackground{0.5f, 0.5f, 1.0f};

// Builds a trace with one frame. x and y are in pixels, y down; z runs from 0 at the near plane to 1 at the far plane.
class Screen {
 public:
  Screen(std::uint32_t width, std::uint32_t height) {
    add_draw();
    frame_.width = width, frame_.height = height;
    frame_.background = kBackground;
    frame_.projection[0][0] = 2.0 / width;
    frame_.projection[1][1] = -2.0 / height;
    frame_.projection[2][2] = 2.0;
    frame_.projection[3] = glm::dvec4(-1.0, 1.0, -1.0, 1.0);
  }

  Screen& triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::vec3& color) {
    Mesh& mesh = meshes_.back();
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::dvec3& corner : {a, b, c}) mesh.positions.emplace_back(corner);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.colors.push_back(color);
    return *this;
  }
  Screen& triangle(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, double z, const glm::vec3& color) {
    return triangle({a, z}, {b, z}, {c, z}, color);
  }
  Screen& rectangle(const glm::dvec2& low, const glm::dvec2& high, double z, const glm::vec3& color) {
    triangle(low, {high.x, low.y}, high, z, color);
    return triangle(low, high, {low.x, high.y}, z, color);
  }
  // What is added from now on is in a draw of its own.
  Screen& draw(const DrawState& state, Cull cull = Cull::none) {
    if (!meshes_.back().triangles.empty()) add_draw();
    frame_.draws.back().state = state;
    frame_.draws.back().cull = cull;
    return *this;
  }
  Frame& frame() { return frame_; }

  Trace trace() {
    Trace trace;
    trace.meshes = std::move(meshes_);
    trace.frames.push_back(std::move(frame_));
    return trace;
  }

 private:
  void add_draw() {
    frame_.draws.emplace_back().mesh = static_cast<std::uint32_t>(meshes_.size());
    const std::string number = std::to_string(meshes_.size() + 1);
    meshes_.emplace_back().name = number == "1" ? "triangles" : "triangles " + number;
  }

  std::vector<Mesh> meshes_;
  Frame frame_;
};

inline constexpr const char* kOver = "OVER assumes that fragments cover a pixel independently of each other";
inline constexpr const char* kCasav = "masks have 32 positions, over which an area is spread evenly";
inline constexpr const char* kOneByOne =
    "fragments are merged one at a time, each by one depth, into one area and one mask";
inline constexpr const char* kText =
    "16-bit slopes turn equal planes into a slab, of which each later triangle takes half";
inline constexpr const char* kFull =
    "a mask without a gap counts as full coverage, so that corners between its positions are lost";
inline constexpr const char* kDepth =
    "surfaces that are closer to each other than the rounding of 32-bit depth change places";
inline constexpr const char* kTwice = "without a stencil, triangles at equal depth count twice";
inline constexpr const char* kStored =
    "a sum in fp16 stops growing when a share is less than half a unit in its last place";
inline constexpr const char* kMask = "areas of partly hidden triangles are estimated from mask positions";

inline constexpr const char* kSlopes = "layers store slopes in 8 bits, which moves intersections by a few positions";

// The limits of techniques that treat a mask without a gap as full coverage, if one edge cuts a pixel.
StatedLimits full_masks();

// The limits of techniques that estimate or count areas by mask positions; with fewer than 256 positions, counts are
// worse by as much.
StatedLimits mask_limits(double error, const char* reason = kMask);

// The limits of techniques that merge fragments, by the published rules and by OVER.
StatedLimits merge_limits(double published, double over);

// All of them; of two limits for one source, the later one.
StatedLimits together(std::initializer_list<StatedLimits> several);

// A perspective camera at the origin that looks along -z: x and y are in units of the distance. The triangles are red,
// green and blue in turn.
Trace perspective(double near, double far, const std::vector<std::array<glm::vec3, 3>>& triangles);

// The cases, by file.
std::vector<HardCase> coverage_cases();
std::vector<HardCase> depth_cases();
std::vector<HardCase> frame_cases();
std::vector<HardCase> surface_cases();
std::vector<HardCase> owner_cases();
std::vector<HardCase> state_cases();

// 131,072 triangles in one bin, so that a file of it would be large: not one of hard_cases().
HardCase crowded_bin();

}  // namespace beampipe
