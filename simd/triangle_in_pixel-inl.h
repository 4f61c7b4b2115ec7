// Formulas of simd/triangle_in_pixel.h. No include guard: see simd/scalar.h.

// Edge k of the triangle. `inline` is for g++, which would otherwise call it once for each edge of a vector.
template <class Int>
inline EdgeInPixel<Int> edge_in_pixel(const TriangleInPixelOf<Int>& triangle, int k) {
  const int next = (k + 1) % 3;
  const Int a = triangle.y[k] - triangle.y[next], b = triangle.x[next] - triangle.x[k];
  return {a, b, Int(0) - (a * triangle.x[k] + b * triangle.y[k])};
}
