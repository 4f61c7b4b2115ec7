// What the publications claim, beside what this program finds.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/report.h"

namespace beampipe {

struct Claim {
  std::string name, unit;
  double published_low = 0, published_high = 0;  // the same when one number is claimed
  std::optional<double> ours;                    // empty: the report does not have what it takes
  std::string source, command;

  // From the nearer end of what is published; 0 within it.
  std::optional<double> difference() const;
};

// Bytes per pixel by technique and format, which no rendering is needed for.
std::vector<Claim> memory_claims();

// Claims about traffic and time, from the techniques that the report has (first frames).
std::vector<Claim> measured_claims(const Report& report);

nlohmann::ordered_json to_json(const Claim& claim);

}  // namespace beampipe
