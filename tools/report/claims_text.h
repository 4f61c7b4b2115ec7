// Published figures and ours, as text for the terminal.
#pragma once

#include <string>
#include <vector>

#include "tools/claims/claims.h"
#include "tools/claims/published_figures.h"

namespace beampipe {

// A table for each command, with notes below it that say what our numbers are and why they differ; then what is true by
// definition, and how many of them hold.
std::string claims_text(const std::vector<Claim>& claims);

// By publication: each statement with its source and answer, in lines of at most 100 characters.
std::string statements_text(const std::vector<Statement>& statements);

}  // namespace beampipe
