#include "tools/cli/metric_options.h"

#include "tools/evaluate/measures.h"
#include "tools/files/format.h"

namespace beampipe {

std::string measures_help() {
  std::string text = "Measures of R, G and B in linear light, unless they say otherwise:\n";
  for (const Measure& measure : measures()) text += format("  %-9s  %s\n", measure.key, measure.meaning);
  return text;
}

void add_pixels_per_degree(Command& command, double& pixels_per_degree) {
  command.add("--pixels-per-degree", pixels_per_degree,
              "what FLIP takes a degree of the view to be (default: 67.02, a 4K screen of 0.7 m from 0.7 m)");
}

void check_pixels_per_degree(double pixels_per_degree) {
  if (!(pixels_per_degree >= 1 && pixels_per_degree <= 1000))
    throw UsageError(format("--pixels-per-degree: expected a number in 1..1000, found %g", pixels_per_degree));
}

void add_reference_cache(Command& command, std::string& folder) {
  command.add("--reference-cache", folder,
              "the folder where pictures of the reference are kept for other runs on the same trace, or none (default: "
              "$XDG_CACHE_HOME/beampipe/references); at most 4 GiB stay, and only this build reads them");
}

}  // namespace beampipe
