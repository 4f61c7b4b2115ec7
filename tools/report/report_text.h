// The results of run and compare as tables for the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/evaluate/results.h"

namespace beampipe {

// A row of titles and one row per technique. `folder` is put in front of the pictures' paths.
std::string table_text(const Report& report, const std::string& folder);

// After an empty line, how far EMR is open, and the measures that the first table has no room for; "" if nothing was
// compared.
std::string measures_text(const Report& report);

// The results of --causes and --orders, each after an empty line, or "" if they were not asked for.
std::string causes_text(const Report& report);
std::string orders_text(const Report& report);

// Aligns the cells of each column. Columns are separated by two blanks. Those whose index is in `left` are aligned on
// the left, the others on the right.
// Of rows that differ only in this column, one, with their cells there after commas.
std::vector<std::vector<std::string>> joined_rows(const std::vector<std::vector<std::string>>& rows,
                                                  std::size_t column);

std::string align_columns(const std::vector<std::vector<std::string>>& rows, const std::vector<std::size_t>& left);

// "36.2", "≥ 256" (lower bound), "< 1" (upper bound), "does not converge".
std::string emr_text(const EquivalentMsaa& emr);

}  // namespace beampipe
