#include "tools/saved_work.h"

#include <algorithm>

namespace beampipe {

std::vector<SavedWork> saved_work(const std::vector<StageCounters>& stages) {
  const auto find = [&](const char* name) {
    return std::find_if(stages.begin(), stages.end(), [&](const StageCounters& stage) { return stage.stage == name; });
  };
  const auto raster = find("conservative_raster"), buffer = find("a_buffer"), fragment = find("beam_fragment"),
             composition = find("compose");
  std::vector<SavedWork> saved;
  if (raster == stages.end()) return saved;
  saved.push_back({"hidden_pairs", "hidden pairs", "pairs",
                   "touched pixels that raster left out behind triangles which cover the pixel: conservative_raster's "
                   "lanes_used less its items_out. Triangles hidden in their whole tile are in neither",
                   raster->lanes_used - raster->items_out});
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
