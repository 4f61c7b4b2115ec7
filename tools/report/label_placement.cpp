#include "tools/report/label_placement.h"

#include <algorithm>
#include <cmath>

namespace beampipe {
namespace {

constexpr double kGap = 2;       // px between a point and its label
constexpr double kLineStep = 4;  // px between points that stand for a line; every label is larger

struct Box {
  double x0, y0, x1, y1;
};

Box box_around(PixelPoint center, double width, double height) {
  return {center.x - width / 2, center.y - height / 2, center.x + width / 2, center.y + height / 2};
}

double overlap(const Box& a, const Box& b) {
  const double width = std::min(a.x1, b.x1) - std::max(a.x0, b.x0);
  const double height = std::min(a.y1, b.y1) - std::max(a.y0, b.y0);
  return width > 0 && height > 0 ? width * height : 0;
}

double area(const Box& box) { return (box.x1 - box.x0) * (box.y1 - box.y0); }

// The places for a label, best first: right, left, above and below, then the corners, then the same farther away.
std::vector<PixelPoint> candidates(PixelPoint point, double width, double height, double radius) {
  constexpr int kSides[][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -1}, {-1, 1}, {1, 1}, {-1, -1}};
  constexpr int kRings = 5;
  std::vector<PixelPoint> centers;
  for (int ring = 0; ring < kRings; ++ring) {
    const double gap = radius + kGap + ring * height;
    for (const auto& [x, y] : kSides) {
      centers.push_back({point.x + x * (gap + width / 2), point.y + y * (gap + height / 2)});
    }
  }
  return centers;
}

}  // namespace

std::vector<PixelPoint> place_labels(const LabelTask& task) {
  const Box plot{0, 0, task.width, task.height};
  std::vector<Box> taken;
  for (const PixelPoint& point : task.points) {
    taken.push_back(box_around(point, 2 * task.point_radius, 2 * task.point_radius));
  }
  for (const auto& [from, to] : task.lines) {
    const int steps = static_cast<int>(std::hypot(to.x - from.x, to.y - from.y) / kLineStep);
    for (int i = 1; i < steps; ++i) {
      const double part = static_cast<double>(i) / steps;
      taken.push_back(box_around({std::lerp(from.x, to.x, part), std::lerp(from.y, to.y, part)}, 2, 2));
    }
  }
  std::vector<PixelPoint> centers = task.points;
  for (std::size_t i = 0; i < task.points.size(); ++i) {
    if (task.label_widths[i] == 0) continue;
    double least = -1;
    for (const PixelPoint& center :
         candidates(task.points[i], task.label_widths[i], task.label_height, task.point_radius)) {
      const Box box = box_around(center, task.label_widths[i], task.label_height);
      double covered = area(box) - overlap(box, plot);
      for (const Box& other : taken) covered += overlap(box, other);
      if (least >= 0 && covered >= least) continue;
      least = covered;
      centers[i] = center;
      if (covered == 0) break;
    }
    taken.push_back(box_around(centers[i], task.label_widths[i], task.label_height));
  }
  return centers;
}

}  // namespace beampipe
