#include "tools/evaluate/msaa_ladder.h"

#include <algorithm>
#include <cmath>

#include "pipeline/bins/threads.h"
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

const std::vector<std::uint32_t>& default_rungs() { return kDefaultSamples; }
const std::vector<std::uint32_t>& more_rungs() { return kMoreSamples; }

bool is_rung(const Technique& technique) {
  return technique.samples > 0 && technique.spec == msaa_spec(technique.samples);
}

MsaaLadder::Rung::Rung(std::uint32_t samples) : technique(parse_technique(msaa_spec(samples))) {}

MsaaLadder::MsaaLadder(std::vector<std::uint32_t> samples, SurfaceColors colors, const Metric& metric)
    : may_grow_(samples.empty()), colors_(colors), metric_(metric) {
  if (samples.empty()) samples = kDefaultSamples;
  std::sort(samples.begin(), samples.end());
  samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
  for (const std::uint32_t count : samples) rungs_.emplace_back(count);
}

void MsaaLadder::add(Rung& rung, const RunPlan& plan, std::size_t frame, const Image& reference,
                     Progress& progress) const {
  if (index_of(rung.technique.spec, plan) < plan.techniques.size()) return;
  const Image image = render_picture(rung.technique, plan, frame, progress, colors_);
  ErrorStats stats = measure_named_error(rung.technique.spec, frame, image, reference);
  const Measure& measure = metric_.measure;
  if (measure.measure)
    stats.*measure.stored =
        on_threads(plan.options.threads, [&] { return measure.measure(image, reference, metric_.pixels_per_degree); });
  const double frame_pixels = static_cast<double>(reference.width) * reference.height;
  rung.squares += stats.rmse * stats.rmse * frame_pixels;
  rung.errors += pooled_part(measure, measure.error(stats)) * frame_pixels;
  rung.pixels += frame_pixels;
  add_block_squares(image, reference, rung.blocks);
}

void MsaaLadder::measure(const Rung& rung, const RunPlan& plan, const std::vector<MetricErrors>& errors,
                         Rungs& measured) const {
  const std::size_t i = index_of(rung.technique.spec, plan);
  const MetricErrors of_rung = i < errors.size()
                                   ? errors[i]
                                   : MetricErrors{std::sqrt(rung.squares / rung.pixels),
                                                  pooled(metric_.measure, rung.errors / rung.pixels), rung.blocks};
  measured.rmse.push_back({rung.technique.samples, of_rung.rmse});
  measured.error.push_back({rung.technique.samples, of_rung.error});
  measured.blocks.push_back(of_rung.blocks);
}

void MsaaLadder::add(const RunPlan& plan, std::size_t frame, const Image& reference, Progress& progress) {
  for (Rung& rung : rungs_) add(rung, plan, frame, reference, progress);
}

MsaaLadder::Rungs MsaaLadder::rungs(const RunPlan& plan, const std::vector<MetricErrors>& errors,
                                    const std::function<Image(std::size_t frame)>& read_reference, Progress& progress) {
  Rungs measured;
  for (const Rung& rung : rungs_) measure(rung, plan, errors, measured);
  if (!may_grow_) return measured;
  const auto is_beaten = [&] {
    for (std::size_t i = 0; i < errors.size(); ++i)
      if (const Technique& technique = plan.techniques[i];
          !is_rung(technique) && !is_reference(technique.spec) && errors[i].error < best_error(measured.error))
        return true;
    return false;
  };
  for (const std::uint32_t samples : kMoreSamples) {
    if (!is_beaten()) break;
    Rung rung(samples);
    for (const std::size_t frame : plan.frames) add(rung, plan, frame, read_reference(frame), progress);
    measure(rung, plan, errors, measured);
  }
  return measured;
}

Json MsaaLadder::sums() const {
  Json sums = Json::array();
  for (const Rung& rung : rungs_) {
    Json blocks = Json::array();
    for (const double squares : rung.blocks) blocks.push_back(squares);
    sums.push_back(Json::array({rung.squares, rung.errors, rung.pixels, std::move(blocks)}));
  }
  return sums;
}

void MsaaLadder::set_sums(const Json& sums) {
  for (std::size_t i = 0; i < rungs_.size(); ++i) {
    rungs_[i].squares = sums.at(i).at(0).get<double>();
    rungs_[i].errors = sums.at(i).at(1).get<double>();
    rungs_[i].pixels = sums.at(i).at(2).get<double>();
    for (std::size_t k = 0; k < kBlocks; ++k) rungs_[i].blocks[k] = sums.at(i).at(3).at(k).get<double>();
  }
}

}  // namespace beampipe
