#include "stages/geometry/clip.h"

namespace beampipe {

ClipPlanes clip_planes(double width, double height, const ScreenLimits& limits) {
  // (x / w + 1) W / 2 >= left, (1 - y / w) H / 2 <= bottom, and so on.
  const double left = 1 - 2 * limits.left / width, right = 2 * limits.right / width - 1;
  const double top = 1 - 2 * limits.top / height, bottom = 2 * limits.bottom / height - 1;
  return {{{0, 0, 1, 1}, {0, 0, -1, 1}, {1, 0, 0, left}, {-1, 0, 0, right}, {0, 1, 0, bottom}, {0, -1, 0, top}}};
}

Polygon clip_to_plane(const Polygon& polygon, const std::array<double, 4>& plane, std::uint64_t& crossings,
                      Polygon* outside) {
  std::vector<double> distances;
  for (const ClippedVertex& vertex : polygon) distances.push_back(plane_distance(plane, vertex));
  Polygon clipped;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::size_t next = (i + 1) % polygon.size();
    const ClippedVertex &from = polygon[i], &to = polygon[next];
    const double from_distance = distances[i], to_distance = distances[next];
    if (from_distance >= 0) {
      clipped.push_back(from);
    } else if (outside) {
      outside->push_back(from);
    }
    if ((from_distance >= 0) == (to_distance >= 0)) continue;
    const bool leaving = from_distance >= 0;
    const ClippedVertex &in = leaving ? from : to, &out = leaving ? to : from;
    const double t = crossing_place(leaving ? from_distance : to_distance, leaving ? to_distance : from_distance);
    clipped.push_back({crossing<double>(in, out, t), in.second + t * (out.second - in.second),
                       in.third + t * (out.third - in.third)});
    if (outside) outside->push_back(clipped.back());
    ++crossings;
  }
  return clipped;
}

}  // namespace beampipe
