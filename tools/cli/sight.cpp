#include "tools/cli/sight.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

namespace beampipe {
namespace {

// In front of the eye: x to the right and y up, each -1 to 1 across the picture at depth 1; z is the depth.
using Point = glm::dvec3;

// A triangle as rays from the eye see it: a ray meets it if it is on the same side of the three planes through the eye
// and an edge.
struct Seen {
  Point planes[3];
  double volume;  // of the eye and the corners, times 6; positive if they are counter-clockwise in the picture
};

Seen seen(const Point (&corners)[3]) {
  const Point& a = corners[0];
  const Point& b = corners[1];
  const Point& c = corners[2];
  return {{glm::cross(a, b), glm::cross(b, c), glm::cross(c, a)}, glm::dot(a, glm::cross(b, c))};
}

// The depth at which the ray meets the triangle; infinite if it does not.
double depth_along(const Point& ray, const Seen& triangle) {
  double sum = 0, least = 0, most = 0;
  for (const Point& plane : triangle.planes) {
    const double side = glm::dot(ray, plane);
    sum += side;
    least = std::min(least, side);
    most = std::max(most, side);
  }
  const double depth = triangle.volume / sum;
  return (least < 0 && most > 0) || !(depth > 0) ? std::numeric_limits<double>::infinity() : depth;
}

// The numbers i, first to last, of pixels whose centres, 2 (i + 0.5) / count - 1, are from `low` to `high`.
std::pair<std::uint32_t, std::uint32_t> centres_between(double low, double high, std::uint32_t count) {
  const auto number = [count](double at) { return std::clamp((at + 1) * 0.5 * count - 0.5, -1.0, count + 0.0); };
  const double first = std::max(0.0, std::ceil(number(low))), last = std::min(count - 1.0, std::floor(number(high)));
  if (!(first <= last)) return {1, 0};
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)};
}

class Picture {
 public:
  Picture(std::uint32_t width, std::uint32_t height)
      : width_(width), height_(height), pixels_(std::size_t{width} * height) {}

  void draw(const Point (&corners)[3], const Draw& draw, bool hides_back) {
    double nearest = corners[0].z, farthest = nearest;
    for (const Point& corner : corners) {
      nearest = std::min(nearest, corner.z);
      farthest = std::max(farthest, corner.z);
    }
    if (!(farthest > 0)) return;
    glm::dvec2 low(-1.0), high(1.0);  // a triangle that reaches the eye's plane may be anywhere
    if (nearest > 0) {
      low = high = glm::dvec2(corners[0]) / corners[0].z;
      for (const Point& corner : corners) {
        low = glm::min(low, glm::dvec2(corner) / corner.z);
        high = glm::max(high, glm::dvec2(corner) / corner.z);
      }
    }
    const auto [first_x, last_x] = centres_between(low.x, high.x, width_);
    const auto [first_y, last_y] = centres_between(-high.y, -low.y, height_);
    if (first_x > last_x || first_y > last_y) return;
    const Seen triangle = seen(corners);
    const bool is_back = (triangle.volume < 0) != draw.state.front_is_clockwise;
    if (draw.cull == (is_back ? Cull::back : Cull::front) || (is_back && hides_back)) return;
    for (std::uint32_t y = first_y; y <= last_y; ++y) {
      for (std::uint32_t x = first_x; x <= last_x; ++x) {
        const double depth = depth_along(ray(x, y), triangle);
        FirstSurface& pixel = pixels_[std::size_t{y} * width_ + x];
        if (depth < pixel.depth) pixel = {depth, ray(x, y) * depth, is_back};
      }
    }
  }

  // In pixels of this size, surfaces that are less than this much behind another one may be parts of the same.
  static constexpr double kSameSurface = 1.05;

  bool shows(const Point& point) const {
    if (!(point.z > 0)) return false;
    const double x = (point.x / point.z + 1) * 0.5 * width_, y = (1 - point.y / point.z) * 0.5 * height_;
    if (!(x >= 0 && x < width_ && y >= 0 && y < height_)) return false;
    const std::size_t row = static_cast<std::size_t>(y), column = static_cast<std::size_t>(x);
    const double depth = pixels_[row * width_ + column].depth;
    return std::isfinite(depth) && point.z <= kSameSurface * depth;
  }

  std::vector<FirstSurface> take() { return std::move(pixels_); }

 private:
  Point ray(std::uint32_t x, std::uint32_t y) const {
    return {2 * (x + 0.5) / width_ - 1, 1 - 2 * (y + 0.5) / height_, 1.0};
  }

  std::uint32_t width_, height_;
  std::vector<FirstSurface> pixels_;  // their points are in front of the eye
};

// Whether the triangle's material has one side only.
bool hides_back(const Trace& trace, const Draw& draw, std::size_t triangle) {
  const std::vector<std::uint32_t>& of_mesh = trace.meshes[draw.mesh].materials;
  if (draw.kd || (!draw.material && of_mesh.empty())) return false;
  const std::uint32_t material = draw.material.value_or(of_mesh.empty() ? kNoMaterial : of_mesh[triangle]);
  return material != kNoMaterial && !trace.materials[material].double_sided;
}

// Calls use(corners, draw, triangle) for each triangle, with corners in front of the eye.
template <class Use>
void for_each_triangle(const Trace& trace, const Frame& frame, const glm::dmat4& to_eye, const Use& use) {
  std::vector<Point> points;
  for (const Draw& draw : frame.draws) {
    const Mesh& mesh = trace.meshes[draw.mesh];
    const glm::dmat4 transform = to_eye * draw.transform;
    points.clear();
    for (const glm::vec3& position : mesh.positions) points.emplace_back(transform * glm::dvec4(position, 1.0));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const glm::uvec3& t = mesh.triangles[i];
      const Point corners[3] = {points[t.x], points[t.y], points[t.z]};
      use(corners, draw, i);
    }
  }
}

}  // namespace

Sight sight_from(const Trace& trace, const Frame& frame, const Camera& camera, std::uint32_t width,
                 std::uint32_t height) {
  const double slope_y = std::tan(glm::radians(camera.fovy_deg) / 2), slope_x = slope_y * width / height;
  const glm::dmat4 to_eye = glm::scale(glm::dmat4(1.0), glm::dvec3(1 / slope_x, 1 / slope_y, -1.0)) *
                            glm::lookAtRH(camera.eye, camera.target, camera.up);
  Picture picture(width, height);
  for_each_triangle(trace, frame, to_eye, [&](const Point(&corners)[3], const Draw& draw, std::size_t triangle) {
    picture.draw(corners, draw, hides_back(trace, draw, triangle));
  });
  Sight sight;
  for_each_triangle(trace, frame, to_eye, [&](const Point(&corners)[3], const Draw&, std::size_t) {
    sight.triangles += picture.shows((corners[0] + corners[1] + corners[2]) / 3.0);
  });
  sight.pixels = picture.take();
  const glm::dmat4 to_world = glm::inverse(to_eye);
  for (FirstSurface& pixel : sight.pixels) pixel.point = to_world * glm::dvec4(pixel.point, 1.0);
  return sight;
}

}  // namespace beampipe
