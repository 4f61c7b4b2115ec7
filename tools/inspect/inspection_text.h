// What a fragment, a step and a whole inspection say, as text for a terminal.
#pragma once

#include <string>

#include "tools/inspect/inspection.h"

namespace beampipe {

// What became of the fragment, in a few words: "owner", "behind a closed pixel".
std::string fate_text(Fate fate);

// One line about what happened: "when 7 came: 2 (34 positions) and 5 (12) became one: 46 positions".
std::string step_text(const HistoryStep& step, const PixelHistory& history);

// One line about what a fragment took and lost; "" if it took all that it covers where nothing was.
std::string moves_text(const HistoryFragment& fragment, const PixelHistory& history);

// Where the error comes from: "leak 62 %, mask 38 %"; "" without an error.
std::string cause_shares_text(const PixelInspection& inspection);

// The surfaces that gained most by each cause, by their effect on the error, a line each.
std::vector<std::string> transfer_lines(const PixelInspection& inspection, std::size_t most);

// At most 120 columns. `unicode`: blocks, where the terminal can show them; else ASCII.
std::string inspection_text(const PixelInspection& inspection, const std::string& trace, bool unicode);

}  // namespace beampipe
