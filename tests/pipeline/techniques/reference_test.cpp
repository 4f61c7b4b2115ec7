// The reference against a renderer that shares no code with it.

#include "tests/pipeline/test_pictures.h"

namespace beampipe::reference_test {

// Tests every sample of every pixel against every triangle with barycentric coordinates in double, without raster,
// spans or tiles. The sample positions are those of the reference (stages/raster/reference_raster.h): 256 rows of 16,
// each shifted by the bit-reversed number of the row.
Image brute_force(const Trace& trace) {
  const Frame& frame = trace.frames[0];
  const Mesh& mesh = trace.meshes[0];
  Image image{frame.width, frame.height, std::vector<float>(4 * std::size_t{frame.width} * frame.height)};
  const auto snapped = [&](std::uint32_t i) {
    const glm::dvec4 clip = frame.projection * glm::dvec4(mesh.positions[i], 1.0);
    return glm::dvec3(std::floor((clip.x + 1) / 2 * frame.width * 256 + 0.5) / 256,
                      std::floor((1 - clip.y) / 2 * frame.height * 256 + 0.5) / 256, clip.z);
  };
  const auto cross = [](const glm::dvec3& o, const glm::dvec3& p, double x, double y) {
    return (p.x - o.x) * (y - o.y) - (x - o.x) * (p.y - o.y);
  };
  std::size_t at = 0;
  for (std::uint32_t py = 0; py < frame.height; ++py) {
    for (std::uint32_t px = 0; px < frame.width; ++px, at += 4) {
      glm::dvec3 sum(0.0);
      for (int s = 0; s < 4096; ++s) {
        const int row = s / 16;
        double shift = 0.5 / 4096;
        for (int bit = 0; bit < 8; ++bit) shift += (row >> bit & 1) / 16.0 / (2 << bit);
        const double x = px + s % 16 / 16.0 + shift, y = py + (row + 0.5) / 256;
        double nearest = 1e9;
        glm::dvec3 color = frame.background;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
          const glm::dvec3 a = snapped(mesh.triangles[t].x), b = snapped(mesh.triangles[t].y),
                           c = snapped(mesh.triangles[t].z);
          const double area = cross(a, b, c.x, c.y);
          if (area == 0) continue;
          const double u = cross(b, c, x, y) / area, v = cross(c, a, x, y) / area, w = cross(a, b, x, y) / area;
          if (u < 0 || v < 0 || w < 0) continue;
          const double z = u * a.z + v * b.z + w * c.z;
          if (z < nearest) nearest = z, color = mesh.colors[t];
        }
        sum += color;
      }
      for (int c = 0; c < 3; ++c) image.rgba[at + static_cast<std::size_t>(c)] = static_cast<float>(sum[c] / 4096);
    }
  }
  return image;
}

TEST(Reference, AgreesWithBruteForce) {
  const Trace trace = random_trace(6, 5, 60, 7);
  const Image reference = picture("reference", trace), brute = brute_force(trace);
  // Only samples exactly on an edge may differ, because brute_force() has no top-left rule.
  double largest = 0;
  for (std::size_t i = 0; i < brute.rgba.size(); ++i)
    if (i % 4 != 3) largest = std::max(largest, std::abs(double(brute.rgba[i]) - reference.rgba[i]));
  EXPECT_LT(largest, 2.0 / 4096);
  EXPECT_LT(rmse(reference, brute), 1e-4);
}

}  // namespace beampipe::reference_test
