// The beam in streaming order: fragments come in primitive order, without an A-buffer or any memory per fragment. A
// pixel keeps only its state (stages/data/owner_pixel.h). A pixel that shows more surfaces than it has layers takes
// further passes over the geometry; each pass settles the nearest surfaces that are left.
#include <stdexcept>
#include <string>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/layer_units.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {
namespace {

struct StreamOptions {
  int positions = 128;  // 32, 64, 128 or 256
  int layers = 5;       // 1 or 5
  int passes = 0;       // the most passes; 0: until every pixel is settled
};

std::vector<Surface> stream_framebuffer(const StreamOptions& stream) {
  const auto words = static_cast<std::uint32_t>(stream.positions / 32),
             layers = static_cast<std::uint32_t>(stream.layers);
  const std::uint32_t state_bytes = 4 * words * (layers == 1 ? 2 : 3);
  return {{"owner_map", times("R32UI", state_bytes / 4), state_bytes},
          {"owners", times("R32UI", layers), 4 * layers},
          {"dropped_depth", "R32F", 4},
          {"color", "RGB16F + R16", 8}};
}

template <std::size_t Words, std::size_t Layers>
FrameResult render_shape(const Trace& trace, const Frame& frame, const StreamOptions& stream, const RunOptions& run) {
  const FrameContext context(trace, frame, run);
  const PositionSet& positions = cell_positions(stream.positions);
  const PositionGrid grid(stream.positions);
  const BeamFragmentOptions options = grid_options(grid, streaming_fragment_bytes(Words));
  const BinPlan plan{.stages = {"conservative_raster", "beam_fragment", "claim", "shade", "settle", "resolve"}};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "batch_pairs", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out);
    BeamFragmentUnit make_fragments(bin, options);
    OwnersUnit<Words, Layers> pixels(bin, positions, stream_framebuffer(stream));
    ShadeUnit shade(bin);
    std::vector<float>& counts = bin.pixel_counter("fragments");

    Tile box = bin.tile;
    for (int pass = 1; box.x0 < box.x1; ++pass) {
      if (pass > 1) raster.start_next_pass();
      pixels.start_pass();
      for_each_batch(bin.list, [&](const TriangleList& batch) {
        const std::vector<Fragment>& fragments = make_fragments(raster(batch, box), "batch_fragments");
        if (pass == 1) count_by_pixel(fragments, counts);
        pixels.claim_positions(fragments);
      });
      std::vector<Fragment>& owned = make_fragments.fetched(pixels.finish_claims(), "owner_fragments");
      shade.visible(owned);
      shade.finish_fetches();
      pixels.settle_positions(owned, pass == stream.passes, raster.closed());
      box = pixels.unfinished();
      if (box.x0 < box.x1) pixels.store_closed(raster.closed());
    }
    bin.finish(pixels.resolve_settled());
  });
}

FrameResult render_stream(const Trace& trace, const Frame& frame, const StreamOptions& stream, const RunOptions& run) {
#define BEAMPIPE_RENDER(words, shape_layers)                           \
  if (stream.positions == 32 * words && stream.layers == shape_layers) \
    return render_shape<words, shape_layers>(trace, frame, stream, run);
  BEAMPIPE_OWNER_PIXELS(BEAMPIPE_RENDER)
#undef BEAMPIPE_RENDER
  throw std::invalid_argument("no pixel of this shape: " + std::to_string(stream.positions) + " positions, " +
                              std::to_string(stream.layers) + " layers");
}

}  // namespace

TechniqueKind beam_stream_kind() {
  return {.name = "beam",
          .variant = {"order", "stream", "sorted"},
          .description =
              "fragments in primitive order, without an A-buffer; a pixel with more visible surfaces than "
              "layers takes further passes over the geometry",
          .source = "ours",
          .make = make_from(
              StreamOptions{},
              [](StreamOptions& o) -> SpecOptions {
                return {
                    choice("bits", o.positions, {{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}},
                           "positions of the mask"),
                    choice("layers", o.layers, {{"1", 1}, {"5", 5}},
                           "surfaces that a pixel keeps at once; fewer layers take more passes"),
                    number("passes", o.passes, 1, 1000, "most passes over the geometry; without it there is no limit")};
              },
              [](const StreamOptions& o) {
                return Technique{.framebuffer = stream_framebuffer(o), .render = bind_options(render_stream, o)};
              })};
}

}  // namespace beampipe
