// The table of a sweep as an SQLite database.
#pragma once

#include <string>

#include "tools/sweep/sweep_table.h"

namespace beampipe {

// The bytes of a database with two tables: `cells` has the rows, and `columns` says what each column means (name, unit,
// meaning). Throws std::runtime_error, one line.
std::string sqlite_bytes(const SweepTable& table);

}  // namespace beampipe
