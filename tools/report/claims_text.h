// Published figures and ours, as text for the terminal.
#pragma once

#include <string>
#include <vector>

#include "tools/claims/claims.h"

namespace beampipe {

// A table for each command, with notes below it that say what our numbers are and why they differ; then what is true by
// definition, and how many of them hold.
std::string claims_text(const std::vector<Claim>& claims);

}  // namespace beampipe
