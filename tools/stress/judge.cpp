#include "tools/stress/judge.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "pipeline/msaa.h"
#include "simd/sample_pattern.h"
#include "tools/stress/exact.h"

namespace beampipe {
namespace {

SamplePlaces places_of(const Sampling& sampling) {
  SamplePlaces places;
  const CellGrid& grid = sampling.grid;
  for (int cell = 0; cell < grid.cells_per_pixel(); ++cell)
    for (std::size_t s = 0; s < static_cast<std::size_t>(sampling.pattern.count); ++s)
      places.emplace_back(cell % grid.columns * grid.cell_width() + sampling.pattern.x[s],
                          cell / grid.columns * grid.cell_height() + sampling.pattern.y[s]);
  return places;
}

SamplePlaces places_of(const std::vector<SamplePattern>& patterns) {
  SamplePlaces places;
  for (const SamplePattern& pattern : patterns)
    for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s)
      places.emplace_back(pattern.x[s], pattern.y[s]);
  return places;
}

std::string name_of(const std::string& spec) { return spec.substr(0, spec.find(':')); }

// Where a technique samples in its first frame; nothing when it works with areas.
SamplePlaces places_of(const std::string& spec) {
  const std::string name = name_of(spec);
  if (name == "msaa" || name == "acaa") return places_of(msaa_sampling(std::atoi(spec.c_str() + name.size() + 1)));
  if (name == "deferred" || name == "visibility") return places_of(msaa_sampling(1));
  if (name == "dvm") return places_of(msaa_sampling(8));
  if (name == "z3") return places_of(cell_patterns(spec.find("128x3") == spec.npos ? 32 : 128));
  if (name == "taa") return {places_of(msaa_sampling(std::atoi(spec.c_str() + name.size() + 1))).front()};
  return {};
}

}  // namespace

const std::vector<glm::dvec4>& Judge::areas() {
  if (!areas_) {
    areas_ = case_.closed_form.empty() ? exact_areas(case_.trace, case_.trace.frames[0]) : case_.closed_form;
  }
  return *areas_;
}

Verdict Judge::judge(const Technique& technique, const RunOptions& options) {
  const SamplePlaces places = places_of(technique.spec);
  const bool sampled = !places.empty() && case_.closed_form.empty();
  const std::vector<glm::dvec4> samples =
      sampled ? exact_samples(case_.trace, case_.trace.frames[0], places) : std::vector<glm::dvec4>{};
  const std::vector<glm::dvec4>& truth = sampled ? samples : areas();
  const FrameResult result = technique.render(case_.trace, 0, options);

  Verdict verdict;
  for (std::size_t i = 0; i < result.image.rgba.size(); ++i) {
    const double error = std::abs(static_cast<double>(result.image.rgba[i]) - truth[i / 4][static_cast<int>(i % 4)]);
    if (!(error <= verdict.error)) verdict.error = error;  // and NaN stays
    if (std::isnan(error)) break;
  }
  const std::string name = name_of(technique.spec);
  verdict.limit = name == "reference" ? kReferenceError : kFormatError;
  auto stated = case_.limits.find(technique.spec);
  if (stated == case_.limits.end()) stated = case_.limits.find(name);
  if (stated != case_.limits.end()) {
    verdict.limit = stated->second.error;
    verdict.reason = stated->second.reason;
  }
  return verdict;
}

}  // namespace beampipe
