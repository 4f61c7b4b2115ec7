#include "tools/evaluate/saved_work.h"

namespace beampipe {

std::vector<SavedWork> saved_work(const std::vector<StageCounters> &stages) {
  const auto find = [&](Stage stage) { return find_counters(stages, stage); };
  const StageCounters *const pairs = find(StageId::conservative_raster), *const cells = find(StageId::sample_raster);
  std::vector<SavedWork> saved;
  if (!pairs && !cells) return saved;
  StageCounters raster = pairs ? *pairs : *cells;
  if (const StageCounters *const prepass = find({StageId::sample_raster, Pass::prepass})) raster += *prepass;
  saved.push_back({"empty_tiles", "empty tiles", "tiles", "tiles that no triangle touches, counted in each pass",
                   raster.empty_tiles});
  saved.push_back({"hidden_triangles", "hidden triangles", "triangles",
                   "triangles that the rasterizer skipped in a tile because nearer triangles cover every pixel (cell) "
                   "of it; counted "
                   "once per tile and pass",
                   raster.hidden_triangles});
  if (!pairs) {
    saved.push_back({"hidden_cells", "hidden cells", "cells",
                     "touched cells (pixels, or parts of pixels at high sampling rates) whose samples were not tested "
                     "because a nearer "
                     "triangle covers the whole cell; hidden triangles are not counted here",
                     raster.hidden_items});
    return saved;
  }
  saved.push_back(
      {"hidden_pairs", "hidden pairs", "pairs",
       "pairs that the rasterizer skipped because a nearer triangle covers the whole pixel; hidden triangles are "
       "not counted here",
       raster.hidden_items});
  if (!find(StageId::windows)) return saved;  // only sorted order knows the pairs of a pixel before their fragments
  const StageCounters *const buffer = find(StageId::a_buffer), *const fragment = find(StageId::beam_fragment),
                             *const composition = find(StageId::compose);
  const std::uint64_t whole = composition->items_in - fragment->items_out;
  saved.push_back(
      {"whole_pixels", "whole pixels", "pixels",
       "pixels that take the colour of one triangle, which covers them and hides all others, without a fragment: "
       "compose's items_in minus beam_fragment's items_out",
       whole});
  saved.push_back({"pairs_behind_closed", "pairs behind closed pixels", "pairs",
                   "pairs in the A-buffer that were never processed because nearer triangles had closed their pixel: "
                   "a_buffer's items_out minus beam_fragment's items_in and minus whole pixels",
                   buffer->items_out - fragment->items_in - whole});
  return saved;
}

}  // namespace beampipe
