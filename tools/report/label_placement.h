// Where the labels of a plot go so that they lie on no other label, point or line.
#pragma once

#include <utility>
#include <vector>

namespace beampipe {

struct PixelPoint {
  double x = 0, y = 0;
};

// All in pixels of the plot's area, (0, 0) .. (width, height).
struct LabelTask {
  double width = 0, height = 0;
  double label_height = 0;
  double point_radius = 0;
  std::vector<std::pair<PixelPoint, PixelPoint>> lines;
  std::vector<PixelPoint> points;    // of every point, with a label or without
  std::vector<double> label_widths;  // beside points; 0: no label
};

// The centre of each point's label, beside points. Labels are placed one after the other: beside the point where that
// is free, else in a circle farther away, and where nothing is free where the least is covered.
std::vector<PixelPoint> place_labels(const LabelTask& task);

}  // namespace beampipe
