// Claims: the numbers that publications state, each with the number that this program finds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/results.h"
#include "traces/files/json_form.h"

namespace beampipe {

inline constexpr double kHoldsWithin = 10;  // per cent

struct Claim {
  std::string name, unit;
  double published_low = 0, published_high = 0;  // the same if one number is published; high is infinity for "or more"
  std::optional<double> ours;                    // empty if the report does not have what our number is computed from
  std::string source, command;  // the place in the publication; the command whose report has our number
  std::string beside;  // how our number differs from the published quantity, or why there is none; empty: it does not
  bool by_definition = false;  // our number is a format or a constant of the program, and not what rendering gave
  std::string reason = {};     // why our number differs; empty: it does not, or nobody knows
  std::string numerator = {},
              denominator = {};  // our number is the quotient of these claims' numbers; empty: it is not

  // How far our number lies from the nearer end of the published range, as a percentage of that end: 0 within the
  // range, infinite if the end is 0, empty without a number of ours.
  std::optional<double> per_cent() const;

  // Whether that is at most kHoldsWithin per cent either way; empty without a number of ours.
  std::optional<bool> holds() const;
};

// All claims, with the numbers that the last frames of the report give. A claim that needs rendering has a number only
// if the report is about the trace that the claim's command makes: what counts is the digest of the trace's content in
// Report::made_by, and not the name of a file. A report without results gives only the numbers that need no rendering.
std::vector<Claim> all_claims(const Report& report);

// Divides where both numbers are known by now: a quotient may be that of claims from two reports.
void find_quotients(std::vector<Claim>& claims);

// The claims for which the report gives a number.
std::vector<Claim> answered_claims(const Report& report);

// As in report.json and in `beampipe claims --json`.
Form<Claim> claim_form();

}  // namespace beampipe
