// Options about measures of errors, as `beampipe compare` and `diff` have them.
#pragma once

#include <string>

#include "tools/cli/command_line.h"

namespace beampipe {

// --reference-cache FOLDER, for picture_cache_folder().
void add_reference_cache(Command& command, std::string& folder);

// What --help says about all measures: a line for each.
std::string measures_help();

// --pixels-per-degree N
void add_pixels_per_degree(Command& command, double& pixels_per_degree);

// Throws UsageError unless it is in 1..1000.
void check_pixels_per_degree(double pixels_per_degree);

}  // namespace beampipe
