// Places the labels of a plot so that they cover no other label, point or line.
#pragma once

#include <utility>
#include <vector>

namespace beampipe {

struct PixelPoint {
  double x = 0, y = 0;
};

// All lengths and places are in pixels of the plot's area, (0, 0) .. (width, height).
struct LabelTask {
  double width = 0, height = 0;
  double label_height = 0;
  double point_radius = 0;
  std::vector<std::pair<PixelPoint, PixelPoint>> lines = {};
  std::vector<PixelPoint> points = {};    // all points, with a label or without
  std::vector<double> label_widths = {};  // one per point; 0 for a point without a label
};

// The centres of the labels, one per point. Labels are placed one after the other. Each goes next to its point if there
// is room, otherwise farther away, and if there is no room at all, to the place where it covers the least.
std::vector<PixelPoint> place_labels(const LabelTask& task);

}  // namespace beampipe
