// The beam in near-first order with pooled state: a pixel pays for the edges that it has. It is meant to replace the
// state of fixed size (beam.cpp), and stands beside it until the two have been compared everywhere.
#include "pipeline/techniques/beam.h"
#include "pipeline/units/pooled_unit.h"

namespace beampipe {
namespace {

struct PooledOptions {
  int positions = 256;  // of the mask
  int pool = 60;        // bytes for each pixel of the bin
  int bin = kBinSize;   // pixels on each side
  OwnerPlace shade_at = OwnerPlace::covered;
};

Framebuffer pooled_framebuffer(const PooledOptions& beam) {
  return {.surfaces = pooled_pixel_surfaces(beam.pool), .place = Place::on_chip, .bin_size = beam.bin};
}

FrameResult render_pooled(const FrameJob& job, const PooledOptions& beam) {
  return with_words(beam.positions, [&]<std::size_t Words>() {
    return render_near_first(
        job, beam.positions, pooled_framebuffer(beam),
        [&](Bin& bin, const PositionSet& positions, const OrderedList& ordered, const std::vector<Surface>& surfaces) {
          return ComposePooledUnit<Words>(bin, positions, ordered, surfaces, beam.pool, beam.shade_at);
        });
  });
}

}  // namespace

TechniqueKind beam_pooled_kind() {
  return {
      .name = "beam",
      .variant = {"order", "pooled"},
      .description =
          "near-first order with a word for each pixel, and records of surfaces and masks only where surfaces share a "
          "pixel, in a pool of the bin; a record that finds no room there lies in memory",
      .source = "ours, after Crassin et al. 2018",
      .examples = {"beam:order=pooled", "beam:order=pooled,bits=128,pool=30,at=visible",
                   "beam:order=pooled,bits=32,pool=4,bin=8,at=quarters"},
      .stressed = {"beam:order=pooled", "beam:order=pooled,bits=128,pool=0"},
      .make = make_from(
          PooledOptions{},
          [](PooledOptions& o) -> SpecOptions {
            return {
                choice("bits", o.positions, {{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}},
                       "positions of the mask"),
                choice(
                    "pool", o.pool,
                    {{"0", 0},
                     {"4", 4},
                     {"16", 16},
                     {"24", 24},
                     {"30", 30},
                     {"40", 40},
                     {"50", 50},
                     {"60", 60},
                     {"64", 64},
                     {"80", 80},
                     {"96", 96},
                     {"128", 128}},
                    "bytes on chip for each pixel of the bin, which records share; beyond that, records lie in memory"),
                shading_place_option(o.shade_at), bin_size_option(o.bin)};
          },
          [](const PooledOptions& o) {
            return near_first_technique(pooled_framebuffer(o), o.positions, bind_options(render_pooled, o));
          })};
}

}  // namespace beampipe
