// What run and compare found, as tables on the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/evaluate/results.h"

namespace beampipe {

// One row per technique under one row of titles; `folder` is where the pictures' paths start.
std::string table_text(const Report& report, const std::string& folder);

// What --causes and --orders found, each with an empty line before it; "" where they were not asked for.
std::string causes_text(const Report& report);
std::string orders_text(const Report& report);

// Columns separated by two blanks; those named in `left` (by index) start at the left, the others end at the right.
std::string align_columns(const std::vector<std::vector<std::string>>& rows, const std::vector<std::size_t>& left);

// "36.2", "≥ 256" (lower bound), "< 1" (upper bound).
std::string emr_text(const EquivalentMsaa& emr);

}  // namespace beampipe
