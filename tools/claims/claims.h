// What the publications state in numbers, beside what this program finds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/results.h"
#include "traces/json.h"

namespace beampipe {

struct Claim {
  std::string name, unit;
  double published_low = 0, published_high = 0;  // the same when one number is published; infinity: "or more"
  std::optional<double> ours;                    // empty: the report does not have what it takes
  std::string source, command;                   // the command whose report has it
  std::string beside;  // what ours is where it is not the same quantity, or why there is none; empty: it is the same

  // From the nearer end of what is published; 0 within it.
  std::optional<double> difference() const;
};

// All of them, whatever the report is of; numbers from first frames. Of a report without results only what needs no
// rendering has `ours`. Where a claim is about a scene, ours is of a trace of that name.
std::vector<Claim> all_claims(const Report& report);

// Those that the report answers.
std::vector<Claim> answered_claims(const Report& report);

Json to_json(const Claim& claim);

// As a Markdown table.
std::string claims_text(const std::vector<Claim>& claims);

}  // namespace beampipe
