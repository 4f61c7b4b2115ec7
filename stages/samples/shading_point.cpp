#include "stages/samples/shading_point.h"

#include "stages/beam/fragment_geometry.h"
#include "stages/cost/counting.h"

namespace beampipe {
namespace {

// Is the point inside an edge? `not_owned`: 0 for an edge that owns what lies on it, else 1.
template <class Int>
bool is_inside(const EdgeAt<Int>& edge, Int x, Int y, Int not_owned) {
  return edge.at(x, y) >= not_owned;
}

// The mean position of the samples whose bit is set, in 1/256 px from the cell's corner.
template <class Bits, class Real>
void mean_position(Bits mask, const Bits bits[], const Real x[], const Real y[], int samples, Real& mean_x,
                   Real& mean_y) {
  const Real zero(0.0f);
  Real sum_x = zero, sum_y = zero;
  for (int s = 0; s < samples; ++s) {
    const bool covered = (mask & bits[s]) != Bits(0);
    sum_x = sum_x + select(covered, x[s], zero), sum_y = sum_y + select(covered, y[s], zero);
  }
  const Real share = Real(1.0f) / bit_count(mask);
  mean_x = sum_x * share, mean_y = sum_y * share;
}

OperationCounts centre_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<std::int64_t> one(1, counts);
    for (int k = 0; k < 3; ++k) is_inside(EdgeAt<Counted<std::int64_t>>{one, one, one}, one, one, one);
  });
}

OperationCounts centroid_cost(int samples) {
  return count_operations([&](OperationCounts& counts) {
    std::vector<Counted<std::uint32_t>> bits(static_cast<std::size_t>(samples));
    std::vector<Counted<float>> x(bits.size(), Counted<float>(1.0f, counts));
    Counted<float> mean_x, mean_y;
    mean_position(Counted<std::uint32_t>(1, counts), bits.data(), x.data(), x.data(), samples, mean_x, mean_y);
  });
}

}  // namespace

ShadingPoint shading_point(const SetupTriangle& triangle, const SampleFragment& fragment, const Sampling& sampling,
                           ShadeAt at) {
  const std::int64_t left = std::int64_t{fragment.x} * sampling.grid.cell_width(),
                     top = std::int64_t{fragment.y} * sampling.grid.cell_height();
  const std::int64_t x = left + sampling.grid.cell_width() / 2, y = top + sampling.grid.cell_height() / 2;
  bool covered = true;
  for (int k = 0; k < 3; ++k) {
    const Edge edge = edge_of(triangle, k);
    covered &= is_inside<std::int64_t>({edge.a, edge.b, edge.c}, x, y, edge.owns ? 0 : 1);
  }
  if (covered || at == ShadeAt::centre) return {glm::dvec2(x, y) / double{kSubpixelUnits}, true};

  std::uint32_t bits[kMaxMaskSamples];
  float xs[kMaxMaskSamples], ys[kMaxMaskSamples], mean_x, mean_y;
  for (std::size_t s = 0; s < kMaxMaskSamples; ++s) {
    bits[s] = 1u << s;
    xs[s] = static_cast<float>(sampling.pattern.x[s]), ys[s] = static_cast<float>(sampling.pattern.y[s]);
  }
  mean_position(fragment.mask, bits, xs, ys, sampling.pattern.count, mean_x, mean_y);
  return {(glm::dvec2(left, top) + glm::dvec2(mean_x, mean_y)) / double{kSubpixelUnits}, false};
}

void count_centroids(const SetupTriangles& triangles, const std::vector<SampleFragment>& fragments, const Tile& tile,
                     const Sampling& sampling, StageCounters& counters, std::vector<float>& centroids) {
  std::uint64_t moved = 0;
  for (const SampleFragment& fragment : fragments) {
    if (shading_point(triangles.triangles[fragment.triangle], fragment, sampling, ShadeAt::centroid).is_centre)
      continue;
    ++centroids[tile.index(sampling.grid.pixel_x(fragment.x), sampling.grid.pixel_y(fragment.y))];
    ++moved;
  }
  counters.ops += centre_cost() * fragments.size();
  counters.ops += centroid_cost(sampling.pattern.count) * moved;
}

}  // namespace beampipe
