#include "pipeline/units/translucent_layer.h"

#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"
#include "stages/picture/resolve_cost.h"

namespace beampipe {

namespace {

// The mean of a pixel's samples in the layer. `pixel`: its number in the tile.
glm::vec4 mean_of_layer(const SampleTile& surface, std::size_t pixel) {
  const std::size_t samples = surface.samples_per_pixel;
  glm::vec4 mean(0.0f);
  for (std::size_t s = 0; s < samples; ++s) mean += surface.over[pixel * samples + s] / static_cast<float>(samples);
  return mean;
}

}  // namespace

Surface translucent_layer(std::uint32_t samples) {
  return {kTranslucentLayer, samples == 1 ? "RGBA16F" : times("RGBA16F", samples), samples * kLayerBytes};
}

std::vector<glm::vec4> draw_translucent(Bin& bin, DepthTestUnit& depth_test, ShadeAt at) {
  if (!bin.context.has_blending()) return {};
  const Sampling& sampling = depth_test.sampling();
  const auto samples = static_cast<std::size_t>(sampling.pattern.count);
  SampleRasterUnit raster(bin, SampleRasterUnit::Translucent::alone, AlphaCoverage::test);
  SampleShadeUnit shade(bin, sampling, at);
  TileSurface layer(bin.memory(), kTranslucentLayer, bin.z_order(),
                    {.parts = static_cast<std::uint32_t>(samples), .part_bytes = kLayerBytes});
  depth_test.start_layer(at, kLayerBytes);
  raster.pass(depth_test, at, [&](std::vector<SampleFragment>& fragments) {
    depth_test.blend_into(layer, fragments);
    shade(fragments);
  });
  const BinStage blending = bin.stage(StageId::blend);
  layer.flush(blending.counters);
  layer.read_all(blending.counters);
  if (bin.models_memory()) layer.add_bytes(bin.pixel_counter("bytes"));

  std::vector<glm::vec4> means(bin.tile.pixels());
  for (std::size_t i = 0; i < means.size(); ++i) means[i] = mean_of_layer(depth_test.surface(), i);
  blending.counters.ops += box_filter_cost(samples) * means.size();
  blending.counters.ops += over_background_cost() * means.size();
  return means;
}

glm::vec4 put_over(const glm::vec4& layer, const glm::vec4& pixel) { return layer + pixel * (1.0f - layer.a); }

void put_over(const std::vector<glm::vec4>& layer, const PixelObservers* observers, std::vector<glm::vec4>& picture) {
  for (std::size_t i = 0; i < layer.size(); ++i) {
    picture[i] = put_over(layer[i], picture[i]);
    if (PixelObserver* const observer = observer_at(observers, i)) observer->puts_layers_over(layer[i].a);
  }
}

}  // namespace beampipe
