#include "tools/stress/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace beampipe {
namespace {

// Sample or mask positions.
int places_in(const Technique& technique) {
  return technique.sampled_at.empty() ? technique.positions : static_cast<int>(technique.sampled_at.size());
}

std::vector<ErrorSource> sources_of(const Technique& technique) {
  std::vector<ErrorSource> sources = technique.errs_by;
  if (technique.counted_positions > 0) sources.push_back(ErrorSource::counted_positions);
  return sources;
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
  const bool sampled = !technique.sampled_at.empty() && !case_.picture;
  const ExactPicture samples =
      sampled ? exact_samples(case_.trace, case_.trace.frames[0], technique.sampled_at) : ExactPicture{};
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
  verdict.limit = case_.equals ? 0 : technique.rounding_error;
  const auto allow = [&](double error, const std::string& reason) {
    const bool explains = error == verdict.limit && verdict.reason.empty();
    if (error > verdict.limit || explains) verdict.limit = error, verdict.reason = reason;
  };
  // A result is within three positions of what counting them gives, and counting is wrong by one more at an edge.
  if (!case_.equals && technique.counted_positions > 0)
    allow(4.0 / technique.counted_positions, "areas and colours are limited to what mask positions say");
  for (const ErrorSource source : sources_of(technique))
    if (const auto stated = case_.limits.find(source); stated != case_.limits.end())
      allow(stated->second.error(places_in(technique)), stated->second.reason);
  return verdict;
}

}  // namespace beampipe
