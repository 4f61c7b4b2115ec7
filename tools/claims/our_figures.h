// Our numbers for what publications state: one formula for each kind of number, named by an id that the published
// figures refer to.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/claims/published_figures.h"
#include "tools/evaluate/results.h"

namespace beampipe {

// What formulas get their numbers from.
struct Findings {
  const Report& report;                  // numbers are those of its last frame
  const Implementation& implementation;  // the way of building the pipeline whose times are modelled
};

struct Formula {
  std::string id;
  std::function<std::optional<double>(const Findings&)> ours;  // nothing if the report does not have what it takes
};

std::vector<Formula> our_formulas();

// Throws std::logic_error, one line, if a figure names a formula that is not there or a claim that does not come before
// it, if no figure names a formula, or if two formulas have the same id.
void expect_formulas_match(const std::vector<PublishedFigure>& figures, const std::vector<Formula>& formulas);

}  // namespace beampipe
