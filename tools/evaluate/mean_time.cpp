#include "tools/evaluate/mean_time.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string_view>

namespace beampipe {
namespace {

// FNV-1a, which is the same on every machine.
std::uint64_t seed_of(std::string_view name) {
  std::uint64_t hash = 14695981039346656037u;
  for (const unsigned char c : name) hash = (hash ^ c) * 1099511628211u;
  return hash;
}

// Stages for alpha are not in all frames.
void add_stage(const StageTime& stage, double frames, std::vector<StageTime>& mean) {
  const auto is_it = [&](const StageTime& each) { return each.stage == stage.stage; };
  const auto found = std::find_if(mean.begin(), mean.end(), is_it);
  StageTime& of_mean =
      found == mean.end() ? mean.emplace_back(StageTime{stage.stage, 0, stage.busiest, stage.busiest_rate}) : *found;
  of_mean.ms += stage.ms / frames;
}

// With the value in it, which may be at the end of what its rates allow.
Interval around(double value, std::vector<double> drawn) {
  const Interval middle = middle_of(std::move(drawn));
  return {std::min(value, middle.low), std::max(value, middle.high)};
}

}  // namespace

ModelledTime mean_time(const Hardware& hardware, std::size_t implementation, const TechniqueReport& result) {
  const auto frames = static_cast<double>(result.frames.size());
  ModelledTime mean;
  for (const FrameReport& frame : result.frames) {
    const ModelledTime time = modelled_time(hardware, hardware.implementations[implementation], frame.work());
    for (const TimeKind& kind : kTimes) mean.*kind.ms += time.*kind.ms / frames;
    if (mean.busiest.empty()) mean.busiest = time.busiest, mean.busiest_rate = time.busiest_rate;
    for (const StageTime& stage : time.stages) add_stage(stage, frames, mean.stages);
  }
  return mean;
}

DrawnTime drawn_time(const Hardware& hardware, const std::vector<Hardware>& draws, std::size_t implementation,
                     const TechniqueReport& result) {
  DrawnTime times{mean_time(hardware, implementation, result), {}};
  std::mt19937_64 random(seed_of(result.technique));
  for (Hardware draw : draws) {
    const double part = uniform(random) - 0.5;
    double& efficiency = draw.rates.at(kDramEfficiency);
    efficiency = std::min(efficiency * std::pow(kRequestSpread, part), 1.0);
    times.drawn.push_back(mean_time(draw, implementation, result));
  }
  return times;
}

Interval DrawnTime::interval(double ModelledTime::*ms) const {
  std::vector<double> values;
  for (const ModelledTime& each : drawn) values.push_back(each.*ms);
  return around(described.*ms, std::move(values));
}

Interval DrawnTime::interval_over(const DrawnTime& other, double ModelledTime::*ms) const {
  std::vector<double> values;
  for (std::size_t i = 0; i < drawn.size(); ++i) values.push_back(drawn[i].*ms / other.drawn[i].*ms);
  return around(described.*ms / other.described.*ms, std::move(values));
}

}  // namespace beampipe
