#include "tools/cli/viewpoint.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "tools/cli/sight.h"

namespace beampipe {
namespace {

constexpr double kGlance = 48;        // the longer side, in pixels, of the pictures by which views are judged
constexpr double kMostWalls = 0.25;   // of what a camera outside sees of the model
constexpr double kWallDepth = 0.02;   // how far from the sides of the bounds a wall may be, of the distance of two
constexpr double kWideAngle = 75;     // across the longer side of the picture, inside
constexpr double kFromMiddle = 0.35;  // how far from the middle the eye is inside, of the size of the bounds
constexpr double kLookDown = 0.1;     // how far below the middle a camera inside looks, of the height

struct Glance {
  const Trace& trace;
  double width, height;

  Sight from(const Camera& camera) const {
    const double scale = kGlance / std::max(width, height);
    const auto pixels = [scale](double side) { return static_cast<std::uint32_t>(std::max(1.0, side * scale)); };
    return sight_from(trace, trace.frames.at(0), camera, pixels(width), pixels(height));
  }
};

bool is_near_a_side(const glm::dvec3& point, const Bounds& bounds) {
  const glm::dvec3 most = kWallDepth * (bounds.high - bounds.low);
  const glm::dvec3 away = glm::min(point - bounds.low, bounds.high - point);
  return away.x <= most.x || away.y <= most.y || away.z <= most.z;
}

// How much of what is seen of the model is the back of a wall; 1 if nothing is seen.
double walls_in(const Sight& sight, const Bounds& bounds) {
  int seen = 0, walls = 0;
  for (const FirstSurface& surface : sight.pixels) {
    if (!std::isfinite(surface.depth)) continue;
    ++seen;
    walls += surface.is_back && is_near_a_side(surface.point, bounds);
  }
  return seen == 0 ? 1.0 : static_cast<double>(walls) / seen;
}

// The vertical angle at which the longer side of the picture has the wide angle.
double wide_fovy(const Glance& glance) {
  const double slope = std::tan(glm::radians(kWideAngle) / 2) * glance.height / std::max(glance.width, glance.height);
  return 2 * glm::degrees(std::atan(slope));
}

// Of eight places around the middle, the one with most triangles in sight; none if there are none.
std::optional<Camera> inside(const Glance& glance, const Bounds& bounds, CameraWishes wishes) {
  const Basis basis = upright_basis(wishes.up.value_or(glm::dvec3(0, 1, 0)));
  const glm::dvec3 size = bounds.high - bounds.low;
  const auto along = [&size](const glm::dvec3& axis) { return glm::dot(glm::abs(axis), size) * axis; };
  if (!wishes.target) wishes.target = bounds.middle() - kLookDown * along(basis.up);
  if (!wishes.fovy_deg) wishes.fovy_deg = wide_fovy(glance);
  std::optional<Camera> best;
  std::uint64_t most = 0;
  for (const glm::dvec2 place : {glm::dvec2(1, 1), {-1, 1}, {1, -1}, {-1, -1}, {0, 1}, {1, 0}, {0, -1}, {-1, 0}}) {
    wishes.eye = bounds.middle() + kFromMiddle * (place.x * along(basis.right) + place.y * along(basis.back));
    const Camera camera = frame_model(glance.trace, static_cast<std::uint32_t>(glance.width),
                                      static_cast<std::uint32_t>(glance.height), wishes);
    const std::uint64_t triangles = glance.from(camera).triangles;
    if (triangles <= most) continue;
    most = triangles;
    best = camera;
  }
  return best;
}

}  // namespace

Viewpoint choose_viewpoint(const Trace& trace, std::uint32_t width, std::uint32_t height, const CameraWishes& wishes,
                           std::optional<Standpoint> asked) {
  const Bounds bounds = shown_bounds(trace);
  const Glance glance{trace, static_cast<double>(width), static_cast<double>(height)};
  const Viewpoint outside{Standpoint::outside, frame_model(trace, width, height, wishes)};
  if (asked == Standpoint::outside) return outside;
  if (asked != Standpoint::inside) {
    double fewest = walls_in(glance.from(outside.camera), bounds);
    if (fewest <= kMostWalls) return outside;
    Viewpoint open_side{Standpoint::open_side, {}};
    for (const glm::dvec3& side : {glm::dvec3(0, 0, 1), {1, 0, 0}, {0, 0, -1}, {-1, 0, 0}}) {
      CameraWishes straight = wishes;
      straight.from = side;
      const Camera camera = frame_model(trace, width, height, straight);
      const double walls = walls_in(glance.from(camera), bounds);
      if (walls >= fewest) continue;
      fewest = walls;
      open_side.camera = camera;
    }
    if (fewest <= kMostWalls) return open_side;
  }
  if (const std::optional<Camera> camera = inside(glance, bounds, wishes)) return {Standpoint::inside, *camera};
  if (asked) throw std::invalid_argument("nothing is in sight inside; give --eye and --target");
  return outside;
}

}  // namespace beampipe
