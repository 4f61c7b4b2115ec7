#include "tools/evaluate/msaa_ladder.h"

#include <algorithm>
#include <cmath>

#include "tools/evaluate/render.h"

namespace beampipe {
namespace {

const std::vector<std::uint32_t> kDefaultSamples = {1, 2, 4, 8, 16, 32, 64, 128, 256};
const std::vector<std::uint32_t> kMoreSamples = {512, 1024};

const TechniqueReport* result_of(const std::string& spec, const std::vector<TechniqueReport>& results) {
  const auto found = std::find_if(results.begin(), results.end(),
                                  [&](const TechniqueReport& result) { return result.technique == spec; });
  return found == results.end() ? nullptr : &*found;
}

bool has_technique(const RunPlan& plan, const std::string& spec) {
  return std::any_of(plan.techniques.begin(), plan.techniques.end(),
                     [&](const Technique& technique) { return technique.spec == spec; });
}

}  // namespace

MsaaLadder::Rung::Rung(std::uint32_t samples) : technique(parse_technique("msaa:" + std::to_string(samples))) {}

void MsaaLadder::Rung::add(const RunPlan& plan, std::size_t frame, const Image& reference, Progress& progress) {
  if (has_technique(plan, technique.spec)) return;
  const Image image = render_picture(technique, plan, frame, progress);
  const double rmse = measure_named_error(technique.spec, frame, image, reference).rmse;
  const double frame_pixels = static_cast<double>(reference.width) * reference.height;
  squares += rmse * rmse * frame_pixels;
  pixels += frame_pixels;
}

LadderRung MsaaLadder::Rung::measured(const std::vector<TechniqueReport>& results) const {
  const TechniqueReport* result = result_of(technique.spec, results);
  return {technique.samples, result ? result->error->rmse : std::sqrt(squares / pixels)};
}

MsaaLadder::MsaaLadder(std::vector<std::uint32_t> samples) : may_grow_(samples.empty()) {
  if (samples.empty()) samples = kDefaultSamples;
  std::sort(samples.begin(), samples.end());
  samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
  for (const std::uint32_t count : samples) rungs_.emplace_back(count);
}

void MsaaLadder::add(const RunPlan& plan, std::size_t frame, const Image& reference, Progress& progress) {
  for (Rung& rung : rungs_) rung.add(plan, frame, reference, progress);
}

std::vector<LadderRung> MsaaLadder::rungs(const RunPlan& plan, const std::vector<TechniqueReport>& results,
                                          const std::function<Image(std::size_t frame)>& read_reference,
                                          Progress& progress) {
  std::vector<LadderRung> measured;
  for (const Rung& rung : rungs_) measured.push_back(rung.measured(results));
  if (!may_grow_) return measured;
  const auto beats_the_ladder = [&](const TechniqueReport& result) {
    return parse_technique(result.technique).samples == 0 && result.error->rmse < best_rmse(measured);
  };
  for (const std::uint32_t samples : kMoreSamples) {
    if (std::none_of(results.begin(), results.end(), beats_the_ladder)) break;
    Rung rung(samples);
    for (const std::size_t frame : plan.frames) rung.add(plan, frame, read_reference(frame), progress);
    measured.push_back(rung.measured(results));
  }
  return measured;
}

Json MsaaLadder::sums() const {
  Json sums = Json::array();
  for (const Rung& rung : rungs_) sums.push_back(Json::array({rung.squares, rung.pixels}));
  return sums;
}

void MsaaLadder::set_sums(const Json& sums) {
  for (std::size_t i = 0; i < rungs_.size(); ++i) {
    rungs_[i].squares = sums.at(i).at(0).get<double>();
    rungs_[i].pixels = sums.at(i).at(1).get<double>();
  }
}

}  // namespace beampipe
