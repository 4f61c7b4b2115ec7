#include "tools/evaluate/mean_time.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
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

// On each of several machines. A frame is read once for all, as it may lie in a file.
std::vector<ModelledTime> mean_times(std::span<const Hardware> machines, std::size_t implementation,
                                     const TechniqueReport& result) {
  const auto frames = static_cast<double>(result.frames.size());
  std::vector<ModelledTime> means(machines.size());
  for (const FrameReport& frame : result.frames) {
    const auto work = frame.work();
    for (std::size_t i = 0; i < machines.size(); ++i) {
      ModelledTime& mean = means[i];
      const ModelledTime time = modelled_time(machines[i], machines[i].implementations[implementation], work);
      for (const TimeKind& kind : kTimes) mean.*kind.ms += time.*kind.ms / frames;
      if (mean.busiest.empty()) mean.busiest = time.busiest, mean.busiest_rate = time.busiest_rate;
      for (const StageTime& stage : time.stages) add_stage(stage, frames, mean.stages);
    }
  }
  return means;
}

}  // namespace

ModelledTime mean_time(const Hardware& hardware, std::size_t implementation, const TechniqueReport& result) {
  return mean_times({&hardware, 1}, implementation, result)[0];
}

DrawnTime drawn_time(const Hardware& hardware, const std::vector<Hardware>& draws, std::size_t implementation,
                     const TechniqueReport& result) {
  std::vector<Hardware> machines{hardware};
  std::mt19937_64 random(seed_of(result.technique));
  for (const Hardware& draw : draws) {
    const double part = uniform(random) - 0.5;
    double& efficiency = machines.emplace_back(draw).rates.at(kDramEfficiency);
    efficiency = std::min(efficiency * std::pow(kRequestSpread, part), 1.0);
  }
  std::vector<ModelledTime> times = mean_times(machines, implementation, result);
  const ModelledTime described = times.front();
  times.erase(times.begin());
  return {described, std::move(times)};
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
