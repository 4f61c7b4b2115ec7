#include "tools/files/saved_work.h"

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
  const StageCounters& raster = pairs != stages.end() ? *pairs : *cells;
  saved.push_back(
      {"empty_tiles", "empty tiles", "tiles", "tiles that no triangle touches, in each pass", raster.empty_tiles});
  saved.push_back(
      {"hidden_triangles", "hidden triangles", "triangles",
       "triangles that raster left out of a tile, every pixel (cell) of which is covered by nearer ones: once "
       "for each tile and pass",
       raster.hidden_triangles});
  if (pairs == stages.end()) {
    saved.push_back(
        {"hidden_cells", "hidden cells", "cells",
         "touched cells (pixels, or parts of super-resolved ones) that raster left out behind triangles "
         "which cover the cell, and whose samples were not tested. Triangles hidden in their whole tile are "
         "not in it",
         raster.hidden_items});
    return saved;
  }
  saved.push_back({"hidden_pairs", "hidden pairs", "pairs",
                   "touched pixels that raster left out behind triangles which cover the pixel. Triangles hidden in "
                   "their whole tile are not in it",
                   raster.hidden_items});
  // Fragments are made behind the A-buffer in sorted order only.
  if (buffer == stages.end() || fragment == stages.end() || composition == stages.end() || fragment < buffer)
    return saved;
  const std::uint64_t whole = composition->items_in - fragment->items_out;
  saved.push_back({"whole_pixels", "whole pixels", "pixels",
                   "pixels that one triangle covers and hides, of which no fragment was made: compose's items_in less "
                   "beam_fragment's items_out",
                   whole});
  saved.push_back({"pairs_behind_closed", "pairs behind closed pixels", "pairs",
                   "pairs in the A-buffer that were never looked at, as their pixel was closed: a_buffer's items_out "
                   "less beam_fragment's items_in and whole pixels",
                   buffer->items_out - fragment->items_in - whole});
  return saved;
}

}  // namespace beampipe
