#include "tools/stress/judge.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "pipeline/techniques/msaa.h"

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

std::string name_of(const std::string& spec) { return spec.substr(0, spec.find(':')); }

// The places of a technique's samples in its first frame; none if it works with areas.
SamplePlaces places_of(const std::string& spec) {
  const std::string name = name_of(spec);
  if (name == "msaa" || name == "acaa" || (name == "visibility" && spec != name))
    return places_of(msaa_sampling(std::atoi(spec.c_str() + name.size() + 1)));
  if (name == "deferred" || spec == "visibility") return places_of(msaa_sampling(1));
  if (name == "dvm") return places_of(msaa_sampling(8));
  if (name == "z3") return places_of(cell_patterns(spec.find("128x3") == spec.npos ? 32 : 128));
  if (name == "taa") return {places_of(msaa_sampling(std::atoi(spec.c_str() + name.size() + 1))).front()};
  return {};
}

double format_limit(const std::string& spec) {
  if (spec == "reference") return kReferenceError;
  // At most one share per sample, and the background.
  if (spec.find("color=unorm8") != spec.npos) return (std::atoi(spec.c_str() + spec.find(':') + 1) + 1) * kUnorm8Error;
  return kFormatError;
}

using NamedLimit = std::map<std::string, StatedLimit>::value_type;

// The limit for the spec. If there is none, the last option is dropped, then the one before it, and so on.
const NamedLimit* stated_limit(const HardCase& hard_case, std::string spec) {
  while (true) {
    const auto stated = hard_case.limits.find(spec);
    if (stated != hard_case.limits.end()) return &*stated;
    const std::size_t end = spec.find_last_of(":,");
    if (end == spec.npos) return nullptr;
    spec.resize(end);
  }
}

// The positions of the mask, if open pixels compose the spec; else 0.
int open_pixel_positions(const std::string& spec) {
  const auto has = [&](const char* text) { return spec.find(text) != spec.npos; };
  if (!spec.starts_with("beam") || has("order=sorted")) return 0;
  if (const std::size_t bits = spec.find("bits="); bits != spec.npos) return std::atoi(spec.c_str() + bits + 5);
  return has("order=stream") ? 128 : 256;
}

// With open pixels, a result is within three positions of what counting them gives, and counting is wrong by one more
// at an edge. Stated limits are those of the positions that their specs have.
StatedLimit open_pixel_limit(const NamedLimit* stated, int positions) {
  constexpr double kPositions = 4;
  StatedLimit limit{kPositions / positions, "areas and colours are limited to what mask positions say"};
  if (!stated) return limit;
  const double error = stated->second.error * open_pixel_positions(stated->first) / positions;
  if (limit.error < error) limit = {error, stated->second.reason};
  return limit;
}

// The largest error(x, y, channel, value) over the picture; NaN if one is NaN.
template <class Error>
double largest(const Image& image, Error&& error_of) {
  double largest = 0;
  const float* found = image.rgba.data();
  for (int y = 0; y < static_cast<int>(image.height); ++y) {
    for (int x = 0; x < static_cast<int>(image.width); ++x, found += 4) {
      for (int c = 0; c < 4; ++c) {
        const double error = error_of(x, y, c, static_cast<double>(found[c]));
        if (std::isnan(largest) || error <= largest) continue;
        largest = error;  // also if it is NaN
      }
    }
  }
  return largest;
}

// The part `covered` of a surface over the background. The surface may be infinite.
double mixed(double surface, double background, double covered) {
  return covered > 0 ? covered * surface + (1 - covered) * background : background;
}

// How far a number is from [low, high]; NaN if it is not finite.
double distance_from(double number, double low, double high) {
  if (!std::isfinite(number)) return std::numeric_limits<double>::quiet_NaN();
  return std::max({low - number, number - high, 0.0});
}

}  // namespace

SamplePlaces places_of(const std::vector<SamplePattern>& patterns) {
  SamplePlaces places;
  for (const SamplePattern& pattern : patterns)
    for (std::size_t s = 0; s < static_cast<std::size_t>(pattern.count); ++s)
      places.emplace_back(pattern.x[s], pattern.y[s]);
  return places;
}

const ExactPicture& Judge::areas() {
  if (case_.picture) return *case_.picture;
  if (!areas_) areas_ = exact_areas(case_.trace, case_.trace.frames[0]);
  return *areas_;
}

double Judge::largest_error(const Technique& technique, const FrameInput& options) {
  const Image image = technique.render(case_.trace, 0, options).image;
  if (case_.equals) {
    const std::vector<float> same = technique.render(*case_.equals, 0, options).image.rgba;
    return largest(image, [at = same.begin()](int, int, int, double found) mutable { return std::abs(found - *at++); });
  }
  const SamplePlaces places = places_of(technique.spec);
  const bool sampled = !places.empty() && !case_.picture;
  const ExactPicture samples = sampled ? exact_samples(case_.trace, case_.trace.frames[0], places) : ExactPicture{};
  const ExactPicture& truth = sampled ? samples : areas();
  if (case_.between) {
    const glm::dvec3 background(case_.trace.frames[0].background);
    return largest(image, [&](int x, int y, int c, double found) {
      const double covered = truth.at(x, y).a;
      if (c == 3) return std::abs(found - covered);
      return distance_from(found, mixed(case_.between->low[c], background[c], covered),
                           mixed(case_.between->high[c], background[c], covered));
    });
  }
  return largest(image, [&](int x, int y, int c, double found) { return std::abs(found - truth.at(x, y)[c]); });
}

Verdict Judge::judge(const Technique& technique, const FrameInput& options) {
  Verdict verdict;
  verdict.error = largest_error(technique, options);
  if (case_.equals) {
    const NamedLimit* stated = stated_limit(case_, technique.spec);
    if (stated) verdict.limit = stated->second.error, verdict.reason = stated->second.reason;
    return verdict;
  }
  verdict.limit = format_limit(technique.spec);
  if (const int positions = open_pixel_positions(technique.spec)) {
    const StatedLimit limit = open_pixel_limit(stated_limit(case_, technique.spec), positions);
    verdict.limit = limit.error, verdict.reason = limit.reason;
  } else if (const NamedLimit* stated = stated_limit(case_, technique.spec)) {
    verdict.limit = stated->second.error;
    verdict.reason = stated->second.reason;
  }
  return verdict;
}

}  // namespace beampipe
