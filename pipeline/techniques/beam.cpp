// The beam in near-first order: each bin's triangles are sorted near to far, roughly; then one pass over them composes
// each pixel in a state of fixed size. Nothing waits, and nothing is kept per fragment.
#include "pipeline/techniques/beam.h"

namespace beampipe {
namespace {

struct BeamOptions {
  int positions = 256;  // of the mask; together with `slots` one of BEAMPIPE_OPEN_PIXELS
  int slots = 5;        // owners of a pixel
  int bin = kBinSize;   // pixels on each side
  OwnerPlace shade_at = OwnerPlace::covered;
};

Framebuffer beam_framebuffer(const BeamOptions& beam) {
  return {.surfaces = open_pixel_surfaces(beam.positions, beam.slots), .place = Place::on_chip, .bin_size = beam.bin};
}

FrameResult render_beam(const FrameJob& job, const BeamOptions& beam) {
  return with_shape(beam.positions, beam.slots, [&]<std::size_t Words, std::size_t Slots>() {
    return render_near_first(
        job, beam.positions, beam_framebuffer(beam),
        [&](Bin& bin, const PositionSet& positions, const OrderedList& ordered, const std::vector<Surface>& surfaces) {
          return ComposeOwnersUnit<Words, Slots>(bin, positions, ordered.triangles, &ordered.watermarks, surfaces,
                                                 beam.shade_at);
        });
  });
}

}  // namespace

SpecOption shading_place_option(OwnerPlace& place) {
  return choice("at", place,
                {{"covered", OwnerPlace::covered},
                 {"visible", OwnerPlace::visible},
                 {"quarters", OwnerPlace::quarters},
                 {"sixteenths", OwnerPlace::sixteenths}},
                "shading point of a surface with a material: the centroid of what its triangle covers, of its own "
                "positions, or of its positions in each quarter or sixteenth of the pixel");
}

SpecOption bin_size_option(int& pixels) {
  return choice("bin", pixels, {{"8", 8}, {"16", 16}, {"32", 32}}, "pixels on each side of a bin");
}

Technique near_first_technique(const Framebuffer& framebuffer, int positions, decltype(Technique::renderer) renderer) {
  return {.framebuffer = framebuffer,
          .positions = positions,
          .counted_positions = positions,
          .renderer = std::move(renderer),
          .is_observable = true,
          .has_weights = true};
}

TechniqueKind beam_kind() {
  return {.name = "beam",
          .variant = {"order", "near-first"},
          .description =
              "fragments with analytic coverage and a mask, taken near to far in each bin; a pixel keeps up to five "
              "surfaces and retires those that nothing nearer can hide any more, so its state has a fixed size",
          .source = "ours, after Crassin et al. 2018",
          .examples = {"beam", "beam:bits=64,slots=4,at=visible", "beam:bits=32,slots=2,bin=8,at=quarters"},
          .stressed = {"beam", "beam:bits=64,slots=4", "beam:bits=32,slots=2"},
          .make = make_from(
              BeamOptions{},
              [](BeamOptions& o) -> SpecOptions {
                return {beside(
                            "slots=2, 4, 8, 16 or 32, unless it is 256",
                            [&o] { return o.positions == 256 || o.slots != 5; },
                            choice("bits", o.positions, {{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}},
                                   "positions of the mask; fewer than 256 need another number of slots than 5")),
                        choice("slots", o.slots, {{"2", 2}, {"4", 4}, {"5", 5}, {"8", 8}, {"16", 16}, {"32", 32}},
                               "surfaces that a pixel keeps at once; when slots run out, two surfaces are merged"),
                        shading_place_option(o.shade_at), bin_size_option(o.bin)};
              },
              [](const BeamOptions& o) {
                return near_first_technique(beam_framebuffer(o), o.positions, bind_options(render_beam, o));
              })};
}

}  // namespace beampipe
