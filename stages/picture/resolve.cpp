#include "stages/picture/resolve.h"

#include <algorithm>
#include <bit>

#include "simd/run_ends.h"
#include "stages/cost/charge_resolve.h"
#include "stages/picture/picture_formulas.h"
#include "stages/picture/resolve_cost.h"

namespace beampipe {

std::vector<PixelColor> pixel_colors(const std::vector<Aggregate>& aggregates) {
  std::vector<PixelColor> colors;
  colors.reserve(aggregates.size());
  for (const Aggregate& aggregate : aggregates)
    colors.push_back({aggregate.alpha, {aggregate.color[0], aggregate.color[1], aggregate.color[2]}});
  return colors;
}

std::vector<glm::vec4> resolve(const std::vector<PixelColor>& aggregates, const glm::vec3& background,
                               std::uint32_t stored_bytes, StageCounters& counters, const PixelObservers* observers) {
  std::vector<glm::vec4> image;
  image.reserve(aggregates.size());
  for (const PixelColor& aggregate : aggregates) {
    glm::vec4& pixel = image.emplace_back(0.0f, 0.0f, 0.0f, aggregate.alpha);
    over_background(&aggregate.color.x, aggregate.alpha, &background.x, &pixel.x);
    if (PixelObserver* const observer = observer_at(observers, image.size() - 1))
      observer->adds(kNobody, 1.0 - double{aggregate.alpha}, background);
  }
  charge_resolve(image.size(), stored_bytes, image.size(), over_background_cost(), counters);
  return image;
}

namespace {

// Samples of a pixel, one after the other, that show the same.
struct SampleRun {
  std::size_t begin, end;
  std::uint32_t triangle;  // kNoTriangle: the background
  bool varies;             // its colour depends on the cell that it lies in
};

// Runs of samples with the same triangle, in the order of the surface.
class OwnerRuns {
 public:
  explicit OwnerRuns(const SampleTile& surface, std::size_t samples) : words_((samples + kRunWord - 1) / kRunWord) {
    mark_run_ends(surface.triangle.data(), samples, words_.data());
  }

  // Does the run of sample s end there?
  bool ends_at(std::size_t s) const { return (words_[s / kRunWord] >> s % kRunWord & 1) != 0; }

  // The end of the run of sample s, or `last` if that comes first.
  std::size_t end_from(std::size_t s, std::size_t last) const {
    for (; s < last; s = (s / kRunWord + 1) * kRunWord)
      if (const std::uint64_t rest = words_[s / kRunWord] >> s % kRunWord)
        return std::min(last, s + static_cast<std::size_t>(std::countr_zero(rest)) + 1);
    return last;
  }

 private:
  std::vector<std::uint64_t> words_;
};

// Do all samples of the pixel show the same, which is flat?
bool is_flat(const SampleTile& surface, const OwnerRuns& runs, std::size_t pixel, const TileShader& shader) {
  const std::size_t begin = pixel * surface.samples_per_pixel, end = begin + surface.samples_per_pixel;
  const std::uint32_t owner = surface.triangle[begin];
  return surface.over.empty() && runs.end_from(begin, end) == end && (owner == kNoTriangle || shader.is_flat(owner));
}

// Calls visit(run) for the runs of a pixel, in order.
template <class Visit>
void for_each_run(const SampleTile& surface, const OwnerRuns& runs, std::size_t pixel, std::size_t samples_per_cell,
                  const TileShader& shader, Visit&& visit) {
  const std::size_t samples = surface.samples_per_pixel, first = pixel * samples;
  const glm::vec4* const over = surface.over.empty() ? nullptr : &surface.over[first];
  for (std::size_t s = 0, end = 0; s < samples; s = end) {
    const std::uint32_t triangle = surface.triangle[first + s];
    const bool varies = triangle != kNoTriangle && !shader.is_flat(triangle);
    end = runs.end_from(first + s, first + (varies ? s - s % samples_per_cell + samples_per_cell : samples)) - first;
    for (std::size_t i = s + 1; over && i < end; ++i)
      if (over[i] != over[s]) end = i;
    visit(SampleRun{s, end, triangle, varies});
  }
}

}  // namespace

std::vector<glm::vec4> resolve(const SampleTile& surface, std::size_t pixels, const TileShader& shader,
                               const glm::vec3& background, StageCounters& counters, const ResolveOptions& options) {
  const std::size_t cells = options.cells, samples = surface.samples_per_pixel, samples_per_cell = samples / cells;
  const OwnerRuns runs(surface, pixels * samples);
  std::vector<glm::vec3> varying;  // colours, one for each run that varies
  if (!shader.is_flat()) {
    std::vector<Invocation> invocations;
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      for_each_run(surface, runs, pixel, samples_per_cell, shader, [&](const SampleRun& run) {
        if (!run.varies) return;
        const CellPlace place = options.place_of(run.triangle, pixel * cells + run.begin / samples_per_cell);
        invocations.push_back(
            {run.triangle, shader.place(static_cast<std::uint32_t>(pixel), place.u, place.v), place.width});
      });
    }
    varying = shader.colors(invocations);
  }
  auto next = varying.begin();
  const glm::dvec3 clear = background;
  const double share = 1.0 / static_cast<double>(samples);
  std::vector<glm::vec4> image;
  image.reserve(pixels);
  bool was_flat = false;  // the pixel before
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const glm::vec4* const over = surface.over.empty() ? nullptr : &surface.over[pixel * samples];
    PixelObserver* const observer = observer_at(surface.observers, pixel);
    const bool flat = is_flat(surface, runs, pixel, shader);
    if (flat && was_flat && !runs.ends_at(pixel * samples - 1) && !observer) {
      image.push_back(image.back());
      continue;
    }
    was_flat = flat;
    // Runs of equal samples are added at once. The sum is that of a box filter in double precision either way.
    glm::dvec3 sum(0.0);
    double covered = 0;
    for_each_run(surface, runs, pixel, samples_per_cell, shader, [&](const SampleRun& run) {
      const auto count = static_cast<double>(run.end - run.begin);
      double weight = share;                                             // of a sample
      const double seen = over ? 1.0 - double{over[run.begin].a} : 1.0;  // of the opaque surface
      const glm::dvec3 opaque = run.triangle == kNoTriangle ? clear
                                : run.varies                ? glm::dvec3(*next++)
                                                            : glm::dvec3(shader.color(run.triangle, 0, 0, 0));
      if (options.space == ResolveSpace::reinhard) {
        glm::dvec3 color = seen * opaque;
        if (over) color += glm::dvec3(over[run.begin]);
        weight /= 1.0 + luminance(&color.x);
        compress(&color.x);
        sum += count * color;
      } else {
        if (over) sum += count * glm::dvec3(over[run.begin]);
        sum += count * seen * opaque;
      }
      if (observer) observer->adds_samples(run.triangle, run.begin, run.end, weight, opaque);
      if (run.triangle != kNoTriangle) {
        covered += count;
      } else if (over) {
        covered += count * double{over[run.begin].a};
      }
    });
    glm::dvec3 mean = sum * share;
    if (observer && options.space == ResolveSpace::reinhard) observer->scales(1.0 / (1.0 - luminance(&mean.x)));
    if (options.space == ResolveSpace::reinhard) expand(&mean.x);
    image.emplace_back(glm::vec3(mean), static_cast<float>(covered * share));
  }
  OperationCounts cost = box_filter_cost(samples);
  if (options.space == ResolveSpace::reinhard) cost += reinhard_cost(samples);
  charge_resolve(pixels * samples, surface.color_bytes, pixels, cost, counters);
  return image;
}

std::vector<glm::vec4> resolve(const OrderedTile& surface, std::size_t pixels, const glm::vec3& background,
                               ResolveSpace space, StageCounters& counters) {
  const std::size_t samples = surface.samples_per_pixel;
  const double share = 1.0 / static_cast<double>(samples);
  std::vector<glm::vec4> image;
  image.reserve(pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    PixelObserver* const observer = observer_at(surface.observers, pixel);
    glm::dvec3 sum(0.0);
    double drawn = 0;
    for (std::size_t s = 0; s < samples; ++s) {
      glm::dvec3 color = surface.color[pixel * samples + s];
      double weight = share;
      if (space == ResolveSpace::reinhard) {
        weight /= 1.0 + luminance(&color.x);
        compress(&color.x);
      }
      sum += color;
      drawn += surface.is_drawn[pixel * samples + s];
      if (observer) observer->adds_samples(kNobody, s, s + 1, weight, background);
    }
    glm::dvec3 mean = sum * share;
    if (observer && space == ResolveSpace::reinhard) observer->scales(1.0 / (1.0 - luminance(&mean.x)));
    if (space == ResolveSpace::reinhard) expand(&mean.x);
    image.emplace_back(glm::vec3(mean), static_cast<float>(drawn * share));
  }
  OperationCounts cost = box_filter_cost(samples);
  if (space == ResolveSpace::reinhard) cost += reinhard_cost(samples);
  charge_resolve(pixels * samples, surface.color_bytes, pixels, cost, counters);
  return image;
}

}  // namespace beampipe
