#include "pipeline/error_causes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/bins/render_bins.h"
#include "pipeline/stored_colors.h"
#include "stages/beam/beam_fragment.h"
#include "stages/raster/conservative_raster.h"
#include "stages/raster/reference_raster.h"

namespace beampipe {
namespace {

constexpr int kTileSize = 4;     // px, as in the reference
constexpr int kPositions = 256;  // where surfaces are compared

enum Cause : std::size_t { leak, mask, order, interpenetration, tiny, mixed, rounding };

// A triangle in one pixel, or the background.
struct PixelSurface {
  std::uint32_t triangle = kNoTriangle;
  glm::dvec3 color;
  double weight = 0, truth = 0;        // parts of the pixel
  const Fragment* fragment = nullptr;  // with masks of those positions; null for the background
  std::uint32_t order = 0;
  bool tiny = false;
  std::uint32_t latest_hider = 0;  // the highest order of the surfaces that are nearer somewhere
};

// How two surfaces compare where they overlap.
struct Nearer {
  bool first = false, second = false;  // nearer at some position
};

class Comparer {
 public:
  Nearer compare(const PixelSurface& i, const PixelSurface& j) const {
    if (!i.fragment || !j.fragment) return {i.fragment != nullptr, j.fragment != nullptr};
    Nearer nearer;
    const bool earlier = i.fragment->triangle < j.fragment->triangle;
    for (std::size_t word = 0; word < patterns_.size(); ++word) {
      for (std::uint32_t bits = i.fragment->mask.words[word] & j.fragment->mask.words[word]; bits; bits &= bits - 1) {
        const auto s = static_cast<std::size_t>(std::countr_zero(bits));
        const float u = static_cast<float>(patterns_[word].x[s]) / kSubpixelUnits - 0.5f;
        const float v = static_cast<float>(patterns_[word].y[s]) / kSubpixelUnits - 0.5f;
        const float zi = depth_at(i.fragment->plane, u, v), zj = depth_at(j.fragment->plane, u, v);
        (zi < zj || (zi == zj && earlier) ? nearer.first : nearer.second) = true;
      }
    }
    return nearer;
  }

  const std::vector<SamplePattern>& patterns() const { return patterns_; }

 private:
  std::vector<SamplePattern> patterns_ = cell_patterns(kPositions);
};

Cause cause_of(const PixelSurface& loser, const PixelSurface& gainer, const Comparer& comparer) {
  if (loser.tiny || gainer.tiny) return tiny;
  const Nearer nearer = comparer.compare(loser, gainer);
  if (nearer.first && nearer.second) return interpenetration;
  if (nearer.first && gainer.order < loser.order) return order;
  if (gainer.truth == 0) return leak;
  if (gainer.latest_hider > std::max(loser.order, gainer.order)) return mixed;
  return mask;
}

// Adds the pixel's transfers of area.
void find_transfers(std::vector<PixelSurface>& surfaces, const Comparer& comparer,
                    std::vector<AreaTransfer>& transfers) {
  for (PixelSurface& hidden : surfaces)
    for (const PixelSurface& hider : surfaces)
      if (hider.order > std::max(hidden.order, hidden.latest_hider) && comparer.compare(hider, hidden).first)
        hidden.latest_hider = hider.order;
  double gained = 0;
  for (const PixelSurface& surface : surfaces) gained += std::max(surface.weight - surface.truth, 0.0);
  for (std::size_t from = 0; from < surfaces.size(); ++from) {
    const PixelSurface& loser = surfaces[from];
    if (loser.weight >= loser.truth) continue;
    for (std::size_t to = 0; to < surfaces.size(); ++to) {
      const PixelSurface& gainer = surfaces[to];
      if (gainer.weight <= gainer.truth) continue;
      const double area = (loser.truth - loser.weight) * (gainer.weight - gainer.truth) / gained;
      transfers.push_back({from, to, area, cause_of(loser, gainer, comparer)});
    }
  }
}

// Every triangle that the technique or the reference sees in a pixel, and last the background.
class PixelSurfaces {
 public:
  PixelSurfaces(const std::vector<Fragment>& fragments, std::size_t pixels) : by_pixel_(pixels) {
    for (const Fragment& fragment : fragments) by_pixel_[fragment.pixel].push_back(&fragment);
  }

  // `truth`: the share of each triangle in the reference's samples.
  std::vector<PixelSurface> at(std::size_t pixel, const PixelWeights& weights,
                               const std::map<std::uint64_t, double>& truth, const TileShader& shader,
                               const glm::vec3& background) const {
    std::map<std::uint32_t, PixelSurface> surfaces;
    for (const Fragment* fragment : by_pixel_[pixel]) {
      PixelSurface& surface = surfaces[fragment->triangle];
      surface.fragment = fragment;
      surface.tiny = fragment->tiny;  // for triangles that the technique dropped
    }
    double rest_of_weights = 1, rest_of_truth = 1;
    for (const SurfaceWeight& weight : weights) {
      PixelSurface& surface = surfaces[weight.triangle];
      surface.weight = weight.weight;
      surface.order = weight.order;
      surface.tiny = weight.tiny;
      rest_of_weights -= surface.weight;
    }
    for (const auto& [triangle, share] : truth) {
      if (triangle == kNoOwner) continue;
      PixelSurface& surface = surfaces[static_cast<std::uint32_t>(triangle)];
      surface.truth = share;
      if (!surface.fragment) surface.tiny = true;  // too little area for a fragment
      rest_of_truth -= surface.truth;
    }
    std::vector<PixelSurface> all;
    for (auto& [triangle, surface] : surfaces) {
      surface.triangle = triangle;
      surface.color = shader.color(triangle, static_cast<std::uint32_t>(pixel), 0.5f, 0.5f);
      all.push_back(surface);
    }
    all.push_back({.triangle = kNoTriangle,
                   .color = background,
                   .weight = rest_of_weights,
                   .truth = rest_of_truth,
                   .order = ~0u});
    return all;
  }

 private:
  std::vector<std::vector<const Fragment*>> by_pixel_;
};

// The share of each triangle in the samples of pixel (x, y) of the tile. Translucent `layers` (layers_of_pixels) take
// their part of what the layers in front of them let through.
std::map<std::uint64_t, double> shares_of_samples(const ReferenceTile& surface, std::size_t x, std::size_t y,
                                                  std::size_t pixel, const std::vector<ReferenceTile::Layer>& layers,
                                                  const TileShader& shader) {
  std::map<std::uint64_t, double> shares;
  auto layer = layers.begin();
  const auto rows = static_cast<std::size_t>(surface.pattern.rows());
  const auto columns = static_cast<std::size_t>(surface.pattern.columns);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t s = 0; s < columns; ++s) {
      const std::size_t sample = (y * rows + row) * surface.row_samples + x * columns + s;
      double light = 1.0 / surface.pattern.samples();
      for (; layer != layers.end() && layer->sample == sample; ++layer) {
        const double alpha = shader.color_and_alpha(layer->triangle, static_cast<std::uint32_t>(pixel), 0.5f, 0.5f).a;
        shares[layer->triangle] += light * alpha;
        light *= 1 - alpha;
      }
      shares[surface.owner[sample]] += light;
    }
  }
  return shares;
}

// The surfaces in the pixels of a tile, as the reference sees them.
class TileExplainer {
 public:
  // Both, and the bin, must outlive it.
  TileExplainer(const FrameContext& context, const Bin& bin, const Comparer& comparer)
      : is_by_depth_(!context.rop),
        target_(context.frame.target),
        comparer_(comparer),
        background_(context.background),
        tile_(bin.tile),
        shader_(bin.shader()),
        truth_(bin.tile) {
    if (!is_by_depth_) return;
    StageCounters unused;
    reference_raster({context.triangles, bin.list, tile_}, unused, truth_, &shader_);
    layers_ = layers_of_pixels(truth_, tile_);
    std::vector<Pair> pairs;
    conservative_raster(context.triangles, bin.list, tile_, unused, pairs);
    beam_fragment(context.triangles, pairs, tile_, {MaskSource::exact, comparer_.patterns()}, unused, fragments_);
    surfaces_.emplace(fragments_, tile_.pixels());
  }

  // `pixel`: its number in the tile.
  ExplainedPixel explain(std::size_t pixel, const PixelWeights& weights, const glm::dvec3& color,
                         const glm::dvec3& reference) const {
    const double length = root_mean_square(color - reference);
    if (!is_by_depth_) {
      ExplainedPixel unknown;
      unknown.causes[rounding] = length;
      return unknown;
    }
    const auto columns = static_cast<std::size_t>(tile_.width());
    std::vector<PixelSurface> seen = surfaces_->at(
        pixel, weights, shares_of_samples(truth_, pixel % columns, pixel / columns, pixel, layers_[pixel], shader_),
        shader_, background_);
    ExplainedPixel explained;
    for (const PixelSurface& each : seen)
      explained.surfaces.push_back({each.triangle, each.weight, each.truth, each.color});
    find_transfers(seen, comparer_, explained.transfers);
    const glm::dvec3 error = stored(target_, color) - stored(target_, reference);
    const double squares = glm::dot(error, error);
    if (squares == 0) return explained;
    std::array<glm::dvec3, kErrorCauses.size()> errors{};
    for (const AreaTransfer& each : explained.transfers)
      errors[each.cause] += each.area * (seen[each.to].color - seen[each.from].color);
    errors[rounding] = error;
    for (std::size_t cause = 0; cause < rounding; ++cause) errors[rounding] -= errors[cause];
    for (std::size_t cause = 0; cause < errors.size(); ++cause)
      explained.causes[cause] = length * glm::dot(errors[cause], error) / squares;
    return explained;
  }

 private:
  const bool is_by_depth_;
  const ColorTarget target_;
  const Comparer& comparer_;
  const glm::vec3 background_;
  const Tile tile_;
  const TileShader shader_;
  ReferenceTile truth_;
  std::vector<std::vector<ReferenceTile::Layer>> layers_;
  std::vector<Fragment> fragments_;
  std::optional<PixelSurfaces> surfaces_;
};

BinPlan plan_of_bins() {
  return {.stages = {}, .framebuffer = {.bin_size = kTileSize}, .pair_bytes = kPairWorkingBytes};
}

glm::dvec3 rgb(const Image& image, std::size_t pixel) {
  const float* rgba = image.rgba.data() + 4 * pixel;
  return {rgba[0], rgba[1], rgba[2]};
}

}  // namespace

double root_mean_square(const glm::dvec3& error) { return std::sqrt(glm::dot(error, error) / 3); }

std::map<std::string, std::vector<float>> error_causes(const FrameJob& job, const std::vector<PixelWeights>& weights,
                                                       const Image& image, const Image& reference) {
  const FrameContext context(job, {}, DrawOrder::of_api);
  const Comparer comparer;
  FrameResult result = render_bins(context, plan_of_bins(), [&](Bin& bin) {
    const Tile& tile = bin.tile;
    const TileExplainer explainer(context, bin, comparer);
    std::array<std::vector<float>*, kErrorCauses.size()> found;
    for (std::size_t cause = 0; cause < found.size(); ++cause) found[cause] = &bin.pixel_counter(kErrorCauses[cause]);
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
      const auto columns = static_cast<std::size_t>(tile.width());
      const std::size_t pixel = (static_cast<std::size_t>(tile.y0) + i / columns) * job.frame.width +
                                static_cast<std::size_t>(tile.x0) + i % columns;
      const glm::dvec3 color = rgb(image, pixel), truth = rgb(reference, pixel);
      if (color == truth) continue;
      const ExplainedPixel explained = explainer.explain(i, weights[pixel], color, truth);
      for (std::size_t cause = 0; cause < found.size(); ++cause)
        (*found[cause])[i] = static_cast<float>(explained.causes[cause]);
    }
  });
  return std::move(result.pixel_counters);
}

std::vector<ExplainedPixel> explain_pixels(const Trace& trace, const Frame& frame,
                                           const std::vector<PixelColors>& pixels, const FrameInput& run) {
  std::vector<PixelAddress> addresses;
  for (const PixelColors& pixel : pixels) addresses.push_back(pixel.at);
  FrameInput options = run;
  options.pixels = &addresses;
  options.memory.modelled = false;
  const FrameContext context({trace, frame, options, {}}, {}, DrawOrder::of_api);
  const Comparer comparer;
  std::vector<ExplainedPixel> explained(pixels.size());
  BinPlan plan = plan_of_bins();
  plan.empty_bins_differ = true;
  render_bins(context, plan, [&](Bin& bin) {
    const TileExplainer explainer(context, bin, comparer);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const PixelColors& pixel = pixels[i];
      if (bin.tile.holds(pixel.at))
        explained[i] = explainer.explain(bin.tile.index(pixel.at), pixel.weights, pixel.color, pixel.reference);
    }
  });
  return explained;
}

}  // namespace beampipe
