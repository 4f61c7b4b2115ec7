#include "tools/evaluate/saved_work.h"

#include <algorithm>

namespace beampipe {

std::vector<SavedWork> saved_work(const std::vector<StageCounters>& stages) {
  const auto find = [&](const char* name) {
    return std::find_if(stages.begin(), stages.end(), [&](const StageCounters& stage) { return stage.stage == name; });
  };
  const auto pairs = find("conservative_raster"), cells = find("sample_raster"), buffer = find("a_buffer"),
             fragment = find("beam_fragment"), composition = find("compose");
  std::vector<SavedWork> saved;
  if (pairs == stages.end() && cells == stages.end()) return saved;
  StageCounters raster = pairs != stages.end() ? *pairs : *cells;
  if (const auto prepass = find("prepass_sample_raster"); prepass != stages.end()) raster += *prepass;
  saved.push_back({"empty_tiles", "empty tiles", "tiles", "tiles that no triangle touches, counted in each pass",
                   raster.empty_tiles});
  saved.push_back({"hidden_triangles", "hidden triangles", "triangles",
                   "triangles that the rasterizer skipped in a tile because nearer triangles cover every pixel (cell) "
                   "of it; counted "
                   "once per tile and pass",
                   raster.hidden_triangles});
  if (pairs == stages.end()) {
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
  // Only in sorted order does beam_fragment run after a_buffer.
  if (buffer == stages.end() || fragment == stages.end() || composition == stages.end() || fragment < buffer)
    return saved;
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
