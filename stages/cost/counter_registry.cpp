#include "stages/cost/counter_registry.h"

namespace beampipe {

const std::vector<PixelCounterInfo>& pixel_counters() {
  constexpr const char* kAll = "all but the reference";
  static const std::vector<PixelCounterInfo> counters = {
      {"fragments", "fragments",
       "triangles that have a fragment in the pixel; passes with further samples count them again", kAll},
      {"bytes", "bytes",
       "logical bytes of the framebuffer and of the A-buffer, if memory is modelled; passes that read every pixel of a "
       "surface once are not included, nor is accumulation over time",
       kAll},
      {"centroids", "fragments",
       "fragments that are shaded at the centroid, because their triangle does not cover the centre", "at=centroid"},
      {"memory_chunks", "chunks",
       "chunks of records that composition read or wrote in memory, because the bin's pool was full"},
      {"merges", "fragments",
       "where an A-buffer sorts: fragments that were composed before the pixel was closed; elsewhere: how often two "
       "surfaces, aggregates or layers were merged"},
      {"tiny_triangles", "fragments", "small fragments, which cover no mask position"},
      {"largest_window", "fragments", "fragments of the largest window"},
      {"collections", "collections", "how often the pixel's bin has looked for what is final in all of its pixels"},
      {"pool_bytes", "bytes", "the most that the records of the pixel's bin have had, wherever they lie, per pixel"},
      {"record_bytes", "bytes", "the most that the pixel's record has had, wherever it lies"},
      {"refusals", "fragments",
       "fragments for which the frame's pool had no room: surfaces of the pixel were merged, or "
       "the fragment was lost"},
      {"lost_specks", "losses",
       "how often small fragments were lost because the frame's pool was full: a new one, or those of the pixel so "
       "far"},
      {"shadings", "shadings", "how often surfaces with a material were shaded"},
      {"visible_fragments", "fragments", "triangles that have a visible sample in the pixel"},
      {"quads_of_1", "0 or 1", "the pixel's 2x2 quad shows one material, the background included"},
      {"quads_of_2", "0 or 1", "the pixel's quad shows two materials"},
      {"quads_of_3", "0 or 1", "the pixel's quad shows three materials"},
      {"quads_of_4", "0 or 1", "the pixel's quad shows four materials"},
      {"quads_of_5_or_more", "0 or 1",
       "the pixel's quad shows five materials or more, so one or more of them have no shading sample"},
      {"partial_quads", "0 or 1", "the pixel's quad lies partly outside the frame"},
      {"motion", "pixels", "how far the nearest surface has moved since the last frame; 0 if it was behind the eye",
       "motion"},
      {"unknown", "part of the pixel", "visibility samples that were not assigned to any shading sample"},
  };
  return counters;
}

const std::vector<PixelCounterInfo>& error_counters() {
  constexpr const char *kUnit = "linear light, 0..1", *kCauses = "compare --causes: techniques that record weights";
  static const std::vector<PixelCounterInfo> counters = {
      {"error", kUnit, "root of the mean square error over R, G and B against the reference", "compare"},
      {"visibility_error", kUnit,
       "the same for visibility alone, where surfaces vary: each triangle has one colour in a pixel in both pictures",
       "compare: traces with surfaces that vary"},
      {"shading_error", kUnit,
       "the same for what the error has beyond that in visibility, where surfaces vary: other colours than those of "
       "the "
       "reference",
       "compare: traces with surfaces that vary"},
      {"cause_leak", kUnit, "part of the pixel's error: a triangle shows that is completely hidden", kCauses},
      {"cause_mask", kUnit, "part of the pixel's error: an outline between mask positions is in the wrong place",
       kCauses},
      {"cause_order", kUnit, "part of the pixel's error: the farther of two triangles was taken for the nearer one",
       kCauses},
      {"cause_interpenetration", kUnit,
       "part of the pixel's error: of two triangles, each is the nearer one in some places", kCauses},
      {"cause_tiny", kUnit, "part of the pixel's error: a triangle covers no mask position", kCauses},
      {"cause_mixed", kUnit,
       "part of the pixel's error: a triangle lost area to a later one that hides a different triangle", kCauses},
      {"cause_rounding", kUnit,
       "part of the pixel's error: the rest, which comes from rounding and limits and not from the triangles' weights",
       kCauses},
  };
  return counters;
}

const std::vector<FrameCounterInfo>& frame_counters() {
  static const std::vector<FrameCounterInfo> counters = {
      {"logical_bytes, sector_bytes, l2_bytes, dram_bytes", "bytes", "sums over the stages"},
      {"a_buffer_peak_bytes", "bytes",
       "size of the whole frame's A-buffer, which stays in memory until it is composed"},
      {"buffers", "bytes",
       "peak size of every buffer; for a buffer that each bin has, its size in the bin that needs the most"},
      {"peak_bytes_per_pixel", "bytes per pixel",
       "size of a technique's framebuffer, plus its A-buffer, translucent layer and spilled records in the frame where "
       "these are largest"},
      {"on_chip_bytes_per_pixel", "bytes per pixel",
       "size of all buffers that a bin has on chip (open pixels, closed depths, queues, windows, batches), each at its "
       "peak in the bin that needs the most, over the pixels of the largest bin"},
      {"off_chip_bytes_per_pixel", "bytes per pixel",
       "peak_bytes_per_pixel: what depends on pixels or fragments and is in memory; geometry and bin lists are apart"},
      {"bin_pixels", "pixels", "pixels of the largest bin"},
      {"pixel_counters", "as the counter's",
       "mean and maximum of each pixel counter over the pixels, and the share of pixels where it is not 0"},
      {"saved", "pairs, cells, triangles, tiles or pixels",
       "work that was not done, derived from the counters of the stages: hidden_pairs or hidden_cells, which the "
       "raster stage left out because a triangle in front covers the whole pixel or cell; hidden_triangles, which were "
       "left out of a whole tile; empty_tiles; whole_pixels, for which no fragment was made because one triangle "
       "covers and hides everything; pairs_behind_closed, pairs of the A-buffer that were never read"},
      {"wall_ms", "milliseconds",
       "time that the simulator took on this machine; with_memory_model says whether it includes the memory model; "
       "modelling_run is, with --repeat, the time of the extra run that includes it"},
      {"modelled_ms", "milliseconds",
       "time on the described hardware: in_turn is that of the stages one after another, on_cores that with the bins "
       "on cores, at_once that of the busiest unit"},
  };
  return counters;
}

}  // namespace beampipe
