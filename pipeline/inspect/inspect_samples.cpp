#include "pipeline/inspect/inspect_samples.h"

#include <algorithm>
#include <bit>
#include <map>

#include "pipeline/units/accumulate_unit.h"
#include "pipeline/units/depth_test_unit.h"
#include "pipeline/units/raster_units.h"
#include "pipeline/units/sample_places.h"
#include "pipeline/units/translucent_layer.h"
#include "stages/cost/counter_registry.h"
#include "stages/picture/picture_formulas.h"

namespace beampipe {
namespace {

// All stages that units of samples may ask for.
std::vector<Stage> sample_stages() {
  return {StageId::sample_raster,
          StageId::alpha_test,
          StageId::shade,
          StageId::depth_test,
          StageId::blend,
          StageId::resolve,
          StageId::accumulate,
          StageId::stencil_test,
          {StageId::sample_raster, Pass::prepass},
          {StageId::alpha_test, Pass::prepass},
          {StageId::depth_test, Pass::prepass}};
}

// The part of a sample that blended triangles have.
struct Layer {
  std::uint32_t fragment;
  double weight;
  glm::dvec3 color;
};

class SampleHistory {
 public:
  SampleHistory(const InspectedPixel& pixel, const std::vector<Sampling>& rounds)
      : pixel_(pixel),
        history_{.at = pixel.at, .order = "order of the trace", .has_samples = true},
        own_pixel_(pixel.quad.index(pixel.tile.x0, pixel.tile.y0)),
        bin_(pixel.context, pixel.quad, pixel.list, stages_, framebuffer_) {
    for (const Sampling& sampling : rounds) add_positions(sampling);
    history_.owners.assign(history_.positions.size(), kNobody);
    layers_.resize(history_.positions.size());
    for (const Pair& pair : pixel.pairs(pixel.list)) {
      HistoryFragment& fragment = history_.fragments.emplace_back(history_fragment(pixel.context, pair));
      fragment.area = pixel.area_of(pair);
      fragment.mask.resize(history_.positions.size());
      fragment.fate = Fate::no_sample;
      fragment.is_tiny = true;
      fragments_.push_back(pair.triangle);
    }
  }

  Bin& bin() { return bin_; }
  PixelHistory& history() { return history_; }
  std::size_t fragments() const { return fragments_.size(); }
  std::size_t own_pixel() const { return own_pixel_; }
  TileShader shader() const { return bin_.shader(); }
  bool is_translucent(std::size_t fragment) const { return pixel_.context.shader.is_translucent(fragments_[fragment]); }

  // The sample fragments of one triangle in the pixel, after the alpha test.
  std::vector<SampleFragment> rasterized(std::size_t fragment, const Sampling& sampling, ShadeAt at,
                                         AlphaCoverage coverage) {
    const TriangleList alone = {fragments_[fragment]};
    Bin bin(pixel_.context, pixel_.quad, alone, stages_, framebuffer_);
    SampleRasterUnit raster(bin, SampleRasterUnit::Translucent::drawn, coverage);
    std::vector<SampleFragment> found;
    raster.pass(sampling, at, [&](const std::vector<SampleFragment>& fragments) {
      for (const SampleFragment& each : fragments)
        if (sampling.grid.pixel_x(each.x) == pixel_.tile.x0 && sampling.grid.pixel_y(each.y) == pixel_.tile.y0)
          found.push_back(each);
    });
    return found;
  }

  // Notes what the triangle covers, before and after the alpha test. `first`: the round's first position.
  void note_coverage(std::size_t fragment, const Sampling& sampling, const std::vector<SampleFragment>& found,
                     std::size_t first) {
    HistoryFragment& noted = history_.fragments[fragment];
    std::vector<SampleFragment> covered;
    StageCounters unused;
    sample_raster({pixel_.context.triangles, pixel_.quad, sampling}, {fragments_[fragment]}, unused, covered);
    const bool covers = std::any_of(covered.begin(), covered.end(), [&](const SampleFragment& each) {
      return sampling.grid.pixel_x(each.x) == pixel_.tile.x0 && sampling.grid.pixel_y(each.y) == pixel_.tile.y0;
    });
    if (noted.area == 0 && !covers) noted.fate = Fate::no_area;
    if (covers && found.empty() && noted.fate == Fate::no_sample) noted.fate = Fate::cut_out;
    for (const SampleFragment& each : found) {
      if (noted.fate == Fate::no_sample || noted.fate == Fate::cut_out) noted.fate = Fate::hidden;
      noted.is_tiny = false;
      for (std::uint32_t left = each.mask; left != 0; left &= left - 1)
        noted.mask[first + sample_of(each, sampling) + static_cast<std::size_t>(std::countr_zero(left))] = true;
    }
  }

  // Who has the samples now? `changed`: what the depth test did.
  void note_owners(std::size_t fragment, const SampleTile& surface, std::size_t first) {
    const std::size_t samples = surface.samples_per_pixel;
    WideBits taken(history_.positions.size());
    for (std::size_t s = 0; s < samples; ++s)
      taken[first + s] = surface.triangle[own_pixel_ * samples + s] == fragments_[fragment];
    take(taken, static_cast<std::uint32_t>(fragment));
    note_missed(static_cast<std::uint32_t>(fragment), history_, first);
  }

  // Opaque triangles hide what was blended at these samples; others are blended there.
  void note_blend(std::size_t fragment, const std::vector<SampleFragment>& found,
                  const std::vector<SampleAccess>& accesses, const SamplePlaces& places, const Sampling& sampling,
                  std::size_t first) {
    const float width = 1.0f / static_cast<float>(std::min(sampling.grid.columns, sampling.grid.rows));
    for (std::size_t i = 0; i < accesses.size(); ++i) {
      const glm::vec2 place = places.of(found[i]);
      const glm::vec4 color = shader().color_and_alpha(fragments_[fragment], static_cast<std::uint32_t>(own_pixel_),
                                                       place.x, place.y, width);
      for (std::uint32_t left = accesses[i].passed; left != 0; left &= left - 1) {
        const std::size_t s = first + sample_of(found[i], sampling) + static_cast<std::size_t>(std::countr_zero(left));
        if (!is_translucent(fragment)) {
          layers_[s].clear();
          continue;
        }
        for (Layer& layer : layers_[s]) layer.weight *= 1.0 - double{color.a};
        layers_[s].push_back({static_cast<std::uint32_t>(fragment), color.a, glm::vec3(color)});
        history_.fragments[fragment].fate = Fate::blended;
      }
    }
    if (is_translucent(fragment) && history_.fragments[fragment].fate == Fate::hidden)
      note_missed(static_cast<std::uint32_t>(fragment), history_, first);
  }

  // What blended triangles leave of sample s.
  double seen_behind(std::size_t s) const {
    double seen = 1;
    for (const Layer& layer : layers_[s]) seen -= layer.weight;
    return seen;
  }
  const std::vector<Layer>& layers(std::size_t s) const { return layers_[s]; }

  std::uint32_t fragment_of(std::uint32_t triangle) const {
    const auto place = std::find(fragments_.begin(), fragments_.end(), triangle);
    return static_cast<std::uint32_t>(place - fragments_.begin());
  }

  // The first sample of the fragment's cell, in the pixel.
  static std::size_t sample_of(const SampleFragment& fragment, const Sampling& sampling) {
    return static_cast<std::size_t>(sampling.grid.in_pixel(fragment.x, fragment.y) * sampling.pattern.count);
  }

  // Adds a term, together with an earlier one of the same colour.
  void add_term(std::uint32_t fragment, double weight, const glm::dvec3& color) {
    for (HistoryTerm& term : history_.terms) {
      if (term.fragment != fragment || term.color != color) continue;
      term.weight += weight;
      return;
    }
    history_.terms.push_back({fragment, weight, color});
  }

 private:
  using WideBits = std::vector<bool>;

  void add_positions(const Sampling& sampling) {
    const glm::vec2 cell(sampling.grid.cell_width(), sampling.grid.cell_height());
    for (std::int32_t row = 0; row < sampling.grid.rows; ++row)
      for (std::int32_t column = 0; column < sampling.grid.columns; ++column)
        for (std::size_t s = 0; s < static_cast<std::size_t>(sampling.pattern.count); ++s)
          history_.positions.push_back(
              (glm::vec2(column, row) * cell + glm::vec2(sampling.pattern.x[s], sampling.pattern.y[s])) *
              (1.0f / kSubpixelUnits));
  }

  void take(const WideBits& taken, std::uint32_t fragment) {
    std::map<std::uint32_t, std::uint32_t> from;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      if (!taken[i] || history_.owners[i] == fragment) continue;
      ++from[history_.owners[i]];
      history_.owners[i] = fragment;
    }
    for (const auto& [earlier, positions] : from) {
      history_.fragments[fragment].taken.push_back({earlier, positions});
      if (earlier != kNobody) history_.fragments[earlier].lost.push_back({fragment, positions});
    }
    if (!from.empty()) history_.fragments[fragment].fate = Fate::owner;
  }

  const InspectedPixel& pixel_;
  const std::vector<Stage> stages_ = sample_stages();
  const Framebuffer framebuffer_;
  PixelHistory history_;
  std::vector<std::uint32_t> fragments_;    // their triangles
  std::size_t own_pixel_;                   // in the quad
  std::vector<std::vector<Layer>> layers_;  // of each sample
  Bin bin_;
};

}  // namespace

PixelHistory inspect_msaa(const InspectedPixel& pixel, const MsaaInspection& how) {
  SampleHistory samples(pixel, {how.sampling});
  const auto first_pass =
      how.prepass ? DepthTestUnit::FirstPass::writes_depth_alone : DepthTestUnit::FirstPass::writes_color;
  DepthTestUnit depth_test(samples.bin(), how.sampling, kSampleColorBytes, first_pass, std::equal_to<std::uint32_t>());
  depth_test.shade_translucent_at(how.at);
  const SamplePlaces places(samples.bin(), how.sampling, how.at);
  const auto draw = [&](bool opaque, bool translucent) {
    for (std::size_t i = 0; i < samples.fragments(); ++i) {
      if (samples.is_translucent(i) ? !translucent : !opaque) continue;
      std::vector<SampleFragment> found = samples.rasterized(i, how.sampling, how.at, how.alpha);
      samples.note_coverage(i, how.sampling, found, 0);
      if (found.empty()) continue;
      depth_test.test(found);
      samples.note_blend(i, found, depth_test.accesses(), places, how.sampling, 0);
      if (!samples.is_translucent(i)) samples.note_owners(i, depth_test.surface(), 0);
    }
  };
  if (how.prepass) {
    draw(true, false);
    depth_test.end_pass();
    depth_test.add_color(kSampleColorBytes);
    draw(false, true);
  } else {
    draw(true, true);
  }
  PixelHistory& history = samples.history();

  const SampleTile& surface = depth_test.surface();
  const TileShader shader = samples.shader();
  const glm::dvec3 background = pixel.context.frame.background;
  const std::size_t count = surface.samples_per_pixel, first = samples.own_pixel() * count;
  const std::size_t cells = static_cast<std::size_t>(how.sampling.grid.cells_per_pixel());
  for (std::size_t s = 0; s < count; ++s) {
    const std::uint32_t triangle = surface.triangle[first + s];
    glm::dvec3 color = background;
    if (triangle != kNoTriangle) {
      CellPlace place{};
      if (!shader.is_flat(triangle)) place = places.of(triangle, samples.own_pixel() * cells + s / (count / cells));
      color = shader.color(triangle, static_cast<std::uint32_t>(samples.own_pixel()), place.u, place.v, place.width);
    }
    const std::uint32_t fragment = triangle == kNoTriangle ? kNobody : samples.fragment_of(triangle);
    double share = 1.0 / static_cast<double>(count);
    if (how.space == ResolveSpace::reinhard) {  // the operator makes a sample's weight depend on its colour
      glm::dvec3 sample = samples.seen_behind(s) * color;
      for (const Layer& layer : samples.layers(s)) sample += layer.weight * layer.color;
      share /= 1.0 + luminance(&sample.x);
    }
    samples.add_term(fragment, share * samples.seen_behind(s), color);
    for (const Layer& layer : samples.layers(s)) samples.add_term(layer.fragment, share * layer.weight, layer.color);
  }
  if (how.space == ResolveSpace::reinhard) {
    const glm::dvec3 mean = history.sum();
    for (HistoryTerm& term : history.terms) term.weight /= 1.0 - luminance(&mean.x);
  }
  history.pixel =
      depth_test.resolve_samples(how.at, samples.bin().stage(StageId::resolve), how.space)[samples.own_pixel()];
  return history;
}

PixelHistory inspect_acaa(const InspectedPixel& pixel, const AcaaInspection& how) {
  constexpr ShadeAt kAt = ShadeAt::centroid;
  SampleHistory samples(pixel, how.rounds);
  Bin& bin = samples.bin();
  PixelHistory& history = samples.history();
  AccumulateUnit accumulate(bin, how.samples, how.format, how.double_counting);
  std::size_t first = 0;  // position of the round
  glm::vec4 translucent(0.0f);
  for (const Sampling& sampling : how.rounds) {
    DepthTestUnit depth_test(bin, sampling, 0);
    const SamplePlaces places(bin, sampling, kAt);
    std::vector<std::vector<SampleFragment>> found;
    for (std::size_t i = 0; i < samples.fragments(); ++i) {
      found.push_back(samples.rasterized(i, sampling, kAt, AlphaCoverage::test));
      samples.note_coverage(i, sampling, found.back(), first);
      if (found.back().empty() || samples.is_translucent(i)) continue;
      depth_test.test(found.back());
      samples.note_owners(i, depth_test.surface(), first);
    }
    depth_test.end_pass();
    const auto sum = [&] { return accumulate.accumulator().color[samples.own_pixel()]; };
    glm::vec4 before = sum();
    accumulate.start_round(sampling, depth_test.surface());
    if (sum() != before) samples.add_term(kNobody, double{sum().a} - before.a, pixel.context.frame.background);
    for (std::size_t i = 0; i < samples.fragments(); ++i) {
      if (samples.is_translucent(i)) continue;
      std::vector<SampleFragment> visible = found[i];
      if (visible.empty()) continue;
      depth_test.test_equal(visible);
      accumulate.test_stencil(visible);
      if (visible.empty()) continue;
      before = sum();
      accumulate(visible, sampling);
      double weight = how.double_counting == DoubleCounting::saturate ? double{sum().a} - before.a : 0.0;
      if (how.double_counting != DoubleCounting::saturate)
        for (const SampleFragment& each : visible)
          weight += std::popcount(each.mask) / static_cast<double>(how.samples);
      const glm::vec2 place = places.of(visible.front());
      samples.add_term(static_cast<std::uint32_t>(i), weight,
                       samples.shader().color(visible.front().triangle, static_cast<std::uint32_t>(samples.own_pixel()),
                                              place.x, place.y));
    }
    accumulate.finish_round();
    if (pixel.context.has_blending()) {
      TileSurface layer(bin.memory(), "translucent_layer", bin.z_order(),
                        static_cast<std::uint32_t>(sampling.pattern.count), kLayerBytes);
      depth_test.start_layer(kAt, kLayerBytes);
      for (std::size_t i = 0; i < samples.fragments(); ++i) {
        if (!samples.is_translucent(i) || found[i].empty()) continue;
        std::vector<SampleFragment> blended = found[i];
        depth_test.blend_into(layer, blended);
        samples.note_blend(i, found[i], depth_test.accesses(), places, sampling, first);
      }
      translucent += mean_of_layer(depth_test.surface(), samples.own_pixel()) / static_cast<float>(how.rounds.size());
    }
    first += static_cast<std::size_t>(sampling.pattern.count);
  }

  glm::vec4 picture = accumulate.resolve_accumulator()[samples.own_pixel()];
  const float left = 1.0f - accumulate.accumulator().color[samples.own_pixel()].a;
  if (left > 0) samples.add_term(kNobody, left, pixel.context.frame.background);
  if (pixel.context.has_blending()) {
    picture = put_over(translucent, picture);
    for (HistoryTerm& term : history.terms) term.weight *= 1.0 - double{translucent.a};
    for (std::size_t s = 0; s < history.positions.size(); ++s)
      for (const Layer& layer : samples.layers(s))
        samples.add_term(layer.fragment, layer.weight / static_cast<double>(history.positions.size()), layer.color);
  }
  history.pixel = picture;
  return history;
}

}  // namespace beampipe
