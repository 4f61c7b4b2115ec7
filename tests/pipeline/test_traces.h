// Small traces for the pipeline tests, in pixel coordinates.
#pragma once

#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

// The corners of a triangle are in pixels (y down), with depths from 0 (nearest) to 1.
struct PixelSpaceTriangle {
  glm::dvec3 corners[3];
  glm::vec3 color;
};

// One orthographic frame that shows the triangles at the given pixel coordinates, up to the precision of float.
inline Trace pixel_trace(std::uint32_t width, std::uint32_t height, const std::vector<PixelSpaceTriangle>& triangles,
                         const glm::vec3& background = glm::vec3(0.0f)) {
  Trace trace;
  Mesh mesh;
  mesh.name = "triangles";
  for (const PixelSpaceTriangle& triangle : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::dvec3& corner : triangle.corners) mesh.positions.emplace_back(corner);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.colors.push_back(triangle.color);
  }
  Frame frame;
  frame.width = width, frame.height = height, frame.background = background;
  frame.projection = glm::dmat4(1.0);
  frame.projection[0][0] = 2.0 / width;
  frame.projection[1][1] = -2.0 / height;
  frame.projection[2][2] = 2.0;
  frame.projection[3] = glm::dvec4(-1.0, 1.0, -1.0, 1.0);
  frame.draws.push_back(Draw{});
  trace.meshes.push_back(mesh);
  trace.frames.push_back(frame);
  return trace;
}

// The lower left half of the square [1, 5] x [1, 5], made a little smaller so that it does not merely touch pixels
// outside the square.
inline Trace half_square() {
  return pixel_trace(8, 8, {{{{1.25, 1.25, 0.5}, {4.75, 4.75, 0.5}, {1.25, 4.75, 0.5}}, glm::vec3(1)}});
}

// A triangle over a frame of up to 64 x 64 pixels.
inline PixelSpaceTriangle covering(double z, const glm::vec3& color = glm::vec3(0.5f)) {
  return {{{-10, -10, z}, {200, -10, z}, {-10, 200, z}}, color};
}

// Two triangles that fill [x0, x1] x [y0, y1].
inline std::vector<PixelSpaceTriangle> quad(double x0, double y0, double x1, double y1, double z,
                                            const glm::vec3& color) {
  return {{{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}}, color}, {{{x0, y0, z}, {x1, y1, z}, {x0, y1, z}}, color}};
}

inline void append(std::vector<PixelSpaceTriangle>& to, const std::vector<PixelSpaceTriangle>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// Random numbers that are the same on every machine. A vector's last coordinate is drawn first. (The arguments of a
// call are evaluated in an order that each compiler chooses.)
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint32_t seed) : bits_(seed) {}

  double number(double low, double high) { return low + (high - low) * (bits_() / 4294967296.0); }
  glm::dvec2 vector(const glm::dvec2& low, const glm::dvec2& high) {
    const double y = number(low.y, high.y);
    return {number(low.x, high.x), y};
  }
  glm::dvec3 vector(const glm::dvec3& low, const glm::dvec3& high) {
    const double z = number(low.z, high.z);
    return {vector(glm::dvec2(low), glm::dvec2(high)), z};
  }

 private:
  std::mt19937 bits_;
};

// Whose corners are as far from `center` as this at most in x, y and z.
inline PixelSpaceTriangle random_triangle(RandomNumbers& random, const glm::dvec3& center, const glm::dvec3& reach) {
  PixelSpaceTriangle triangle;
  for (glm::dvec3& corner : triangle.corners) corner = center + random.vector(-reach, reach);
  triangle.color = random.vector(glm::dvec3(0), glm::dvec3(1));
  return triangle;
}

// Random triangles of mixed sizes that interpenetrate. The same seed gives the same triangles on every machine.
inline Trace random_trace(std::uint32_t width, std::uint32_t height, int count, std::uint32_t seed) {
  RandomNumbers random(seed);
  std::vector<PixelSpaceTriangle> triangles;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 center = random.vector({0, 0, 0.2}, {width, height, 0.8});
    const double size = i % 3 == 0 ? 0.4 * width : i % 3 == 1 ? 4.0 : 0.7;
    triangles.push_back(random_triangle(random, center, {size, size, 0.1}));
  }
  return pixel_trace(width, height, triangles, glm::vec3(0.25f, 0.5f, 0.75f));
}

// Every pixel is full of so many parts on each side, each of which is two triangles.
inline Trace parts_of_pixels(int side, int parts, std::uint32_t seed) {
  RandomNumbers random(seed);
  std::vector<PixelSpaceTriangle> triangles;
  const auto at = [&](int i) { return static_cast<double>(i) / parts; };
  for (int y = 0; y < side * parts; ++y)
    for (int x = 0; x < side * parts; ++x)
      append(triangles, quad(at(x), at(y), at(x + 1), at(y + 1), 0.5, random.vector(glm::dvec3(0), glm::dvec3(1))));
  return pixel_trace(static_cast<std::uint32_t>(side), static_cast<std::uint32_t>(side), triangles);
}

}  // namespace beampipe
