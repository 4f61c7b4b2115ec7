#include "tools/evaluate/msaa_ladder.h"

#include <algorithm>
#include <cmath>

#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/render.h"

namespace beampipe {
namespace {

const std::vector<std::uint32_t> kDefaultSamples = {1, 2, 4, 8, 16, 32, 64, 128, 256};
const std::vector<std::uint32_t> kMoreSamples = {512, 1024};

// The plan's number of techniques if it has no such technique.
std::size_t index_of(const std::string& spec, const RunPlan& plan) {
  const auto found = std::find_if(plan.techniques.begin(), plan.techniques.end(),
                                  [&](const Technique& technique) { return technique.spec == spec; });
  return static_cast<std::size_t>(found - plan.techniques.begin());
}

}  // namespace

bool is_rung(const Technique& technique) {
  return technique.samples > 0 && technique.spec == msaa_spec(technique.samples);
}

MsaaLadder::Rung::Rung(std::uint32_t samples) : technique(parse_technique(msaa_spec(samples))) {}

void MsaaLadder::Rung::add(const RunPlan& plan, std::size_t frame, const Image& reference, SurfaceColors colors,
                           Progress& progress) {
  if (index_of(technique.spec, plan) < plan.techniques.size()) return;
  const Image image = render_picture(technique, plan, frame, progress, colors);
  const double rmse = measure_named_error(technique.spec, frame, image, reference).rmse;
  const double frame_pixels = static_cast<double>(reference.width) * reference.height;
  squares += rmse * rmse * frame_pixels;
  pixels += frame_pixels;
}

LadderRung MsaaLadder::Rung::measured(const RunPlan& plan, const std::vector<double>& rmses) const {
  const std::size_t i = index_of(technique.spec, plan);
  return {technique.samples, i < rmses.size() ? rmses[i] : std::sqrt(squares / pixels)};
}

MsaaLadder::MsaaLadder(std::vector<std::uint32_t> samples, SurfaceColors colors)
    : may_grow_(samples.empty()), colors_(colors) {
  if (samples.empty()) samples = kDefaultSamples;
  std::sort(samples.begin(), samples.end());
  samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
  for (const std::uint32_t count : samples) rungs_.emplace_back(count);
}

void MsaaLadder::add(const RunPlan& plan, std::size_t frame, const Image& reference, Progress& progress) {
  for (Rung& rung : rungs_) rung.add(plan, frame, reference, colors_, progress);
}

std::vector<LadderRung> MsaaLadder::rungs(const RunPlan& plan, const std::vector<double>& rmses,
                                          const std::function<Image(std::size_t frame)>& read_reference,
                                          Progress& progress) {
  std::vector<LadderRung> measured;
  for (const Rung& rung : rungs_) measured.push_back(rung.measured(plan, rmses));
  if (!may_grow_) return measured;
  const auto is_beaten = [&] {
    for (std::size_t i = 0; i < rmses.size(); ++i)
      if (!is_rung(plan.techniques[i]) && rmses[i] < best_rmse(measured)) return true;
    return false;
  };
  for (const std::uint32_t samples : kMoreSamples) {
    if (!is_beaten()) break;
    Rung rung(samples);
    for (const std::size_t frame : plan.frames) rung.add(plan, frame, read_reference(frame), colors_, progress);
    measured.push_back(rung.measured(plan, rmses));
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
