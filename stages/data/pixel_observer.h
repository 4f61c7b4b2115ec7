// Sees what the stages decide in one pixel and writes its history. Stages get a nullable pointer to the observers of
// their tile. They tell what they do anyway: what is composed and charged does not depend on it, and the modelled
// machine has no such thing.
#pragma once

#include <cstddef>
#include <memory>
#include <unordered_map>
#include <vector>

#include "simd/merge.h"
#include "stages/data/fragment.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/pixel_history.h"

namespace beampipe {

class PixelObserver {
 public:
  // The positions that the pixel has from here on, after those that it has already. Returns the number of the first.
  std::size_t add_positions(const std::vector<glm::vec2>& positions);

  // The triangle's fragment, an index into the history. If it is new, it comes last and has this fate.
  std::uint32_t fragment_of(std::uint32_t triangle, Fate fate = Fate::closed_off);

  // ---- Fragments come, and take positions ----

  // Of 32 positions from `first` on, a triangle covers `covered` and takes `won`. The others stay with their owners.
  void contends(std::uint32_t triangle, std::size_t first, std::uint32_t covered, std::uint32_t won);

  // The same for all positions of a fragment, whose area becomes known.
  void arrives(const Fragment& fragment, const WideMask& won);

  // A fragment that covers no position is seen.
  void shows_speck(std::uint32_t triangle) { history.fragments[fragment_of(triangle)].fate = Fate::speck; }

  // Takes positions before the fragment arrives, if several come at once, or without a fragment.
  void takes(std::uint32_t triangle, const WideMask& won);

  // A triangle has not come; it would have covered these of 32 positions.
  void would_cover(std::uint32_t triangle, std::size_t first, std::uint32_t covered);

  // No fragment comes any more.
  void arrivals_end() { current_ = kNobody; }

  // ---- Surfaces that own positions. Each is named by positions that it owns ----

  struct Owned {
    WideMask positions;
    glm::vec3 color;  // linear RGB
    double part;      // of the mean, 0..1
  };
  // Two surfaces become one, whose colour is the mean.
  void merges(const Owned& one, const Owned& other);

  // A surface is final. It adds these parts of the pixel, 0..1, to the analytic and to the counted estimate.
  void settles(const WideMask& positions, const glm::vec3& color, double area, double counted);

  // A fragment without positions is visible, and adds this to the analytic estimate.
  void adds_speck(std::uint32_t triangle, double area, const glm::vec3& color);

  // All of these so far are hidden or lost after all. No surface is final yet.
  void forgets_specks();

  // All surfaces are final. The weights are their areas.
  void finishes();

  // The same if limits have made a result of two estimates. The weights add up to its area. They are a mixture of both
  // estimates: the one whose colour is closest to that of the result. It is the same if the channels are limited by the
  // same factor.
  void finishes(const PixelColor& analytic, const PixelColor& counted, const PixelColor& result);

  // ---- Aggregates without owners. Each is named by its place from near to far ----

  // A shaded fragment comes and becomes an aggregate. It takes those of its positions that nobody has.
  void enters(std::size_t place, const Fragment& fragment);

  // What is at `place`, if anything, will be overwritten: it has no positions, so it counts as empty.
  void overwrites(std::size_t place);

  // The aggregates at `place` and behind it become `together`: the sum of both colours, each times its factor.
  struct Joined {
    const Aggregate &nearer, &farther, &together;
    float factor_of_nearer, factor_of_farther;
  };
  void joins(std::size_t place, const Joined& joined);

  // One aggregate, or none, is left.
  void finishes_aggregate();

  // ---- Terms of the pixel ----

  // kNobody: the background. `color`: linear RGB.
  void adds(std::uint32_t triangle, double weight, const glm::dvec3& color);

  // All terms so far change by this factor.
  void scales(double factor);

  // A translucent triangle, which passed the depth test at this position, goes over all that the terms are so far.
  void goes_over(std::uint32_t triangle, std::size_t position, double alpha, const glm::dvec3& color);

  // The pixel's only aggregate has changed. `color`: linear RGB times area.
  void composes(std::uint32_t positions, double area, const glm::vec3& color);

  // ---- Samples with translucent layers ----

  // A translucent triangle goes over the layers of a position.
  void blends(std::uint32_t triangle, std::size_t position, double alpha, const glm::dvec3& color) {
    blends(triangle, position, alpha, 1 - alpha, color);
  }
  // The same with any factor of the colour, and any of what is there.
  void blends(std::uint32_t triangle, std::size_t position, double added, double kept, const glm::dvec3& color);

  // Adds positions [begin, end) with their layers, over a triangle or the background. `share`: weight of each.
  void adds_samples(std::uint32_t triangle, std::size_t begin, std::size_t end, double share, const glm::dvec3& color);

  // The mean of all layers goes over what the terms are so far. `alpha`: of the mean.
  void puts_layers_over(double alpha);

  // The part of a position that layers leave to what lies behind them.
  double seen_behind_layers(std::size_t position) const;

  PixelHistory history;

 private:
  using Surface = std::vector<HistoryTerm>;  // its fragments: parts of its colour or, of an aggregate, of the pixel
  struct Final {
    Surface surface;
    double area, counted;
  };

  std::uint32_t drawn_fragment(std::uint32_t triangle, std::size_t position,
                               Fate fate);  // notes that it was drawn there
  void take(std::size_t position, std::uint32_t fragment);
  void misses(std::size_t position, std::uint32_t fragment);
  std::size_t surface_at(const WideMask& positions, const glm::vec3& color);
  HeldSurface held(const Surface& surface, const WideMask& positions, const glm::vec3& color) const;
  void join(std::size_t one, std::size_t other, double factor_of_one, double factor_of_other);
  void add_term(std::uint32_t fragment, double weight, const glm::dvec3& color);

  std::unordered_map<std::uint32_t, std::uint32_t> fragments_;  // by triangle
  std::uint32_t current_ = kNobody;                             // the fragment that came last
  std::vector<Surface> surfaces_;                               // of aggregates: from near to far
  std::vector<Final> finals_;
  HeldSurface aggregate_;                         // as it was composed last
  std::vector<std::vector<HistoryTerm>> layers_;  // by position; empty if nothing is translucent
  std::vector<double> behind_layers_;             // what layers leave of what lies behind them, by position
};

// Of the pixels of a tile, row by row; null where nobody looks.
using PixelObservers = std::vector<std::unique_ptr<PixelObserver>>;

// `observers` may be null.
inline PixelObserver* observer_at(const PixelObservers* observers, std::size_t pixel) {
  return observers ? (*observers)[pixel].get() : nullptr;
}

}  // namespace beampipe
