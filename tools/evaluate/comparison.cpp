#include "tools/evaluate/comparison.h"

#include <algorithm>
#include <cmath>

#include "tools/evaluate/render.h"
#include "tools/files/image_io.h"

namespace beampipe {
namespace {

Json made_by(const CompareOptions& options, const RunPlan& plan) {
  return maker_form().write({.command = "compare",
                             .plan = plan,
                             .ladder = std::vector<std::uint64_t>(options.ladder.begin(), options.ladder.end()),
                             .causes = options.causes,
                             .orders = options.orders,
                             .metric = options.metric,
                             .pixels_per_degree = options.pixels_per_degree});
}

// Pooled over the frames that follow another. None if there is only one frame.
std::optional<double> pooled_flicker(const TechniqueReport& result) {
  double squares = 0, frames = 0;
  for (const FrameReport& frame : result.frames) {
    if (!frame.flicker) continue;
    squares += *frame.flicker * *frame.flicker;
    ++frames;
  }
  return frames > 0 ? std::optional(std::sqrt(squares / frames)) : std::nullopt;
}

// Two independent references differ by the errors of both.
std::optional<double> reference_error_of(const std::vector<TechniqueReport>& results) {
  const auto second = std::ranges::find(results, kSecondReferenceSpec, &TechniqueReport::technique);
  return second == results.end() ? std::nullopt : std::optional(second->error->rmse / std::sqrt(2.0));
}

bool has_all_measures(const ErrorStats& stats) {
  return std::ranges::all_of(measures(),
                             [&](const Measure& measure) { return !measure.stored || stats.*measure.stored; });
}

}  // namespace

Comparison::Comparison(const CompareOptions& options, RunPlan plan, OutputFolder& output)
    : options_(options),
      output_(output),
      plan_(std::move(plan)),
      maker_(made_by(options, plan_)),
      records_(output, maker_),
      metric_{find_metric(options.metric), options.pixels_per_degree},
      ladder_(options.ladder, SurfaceColors::by_place, metric_) {
  std::erase_if(plan_.techniques, [](const Technique& technique) { return technique.spec == kReferenceSpec; });
  std::vector<Technique> written = plan_.techniques;
  written.push_back(reference_);
  require_writable_folders(output_, written);
  for (const Technique& technique : plan_.techniques) {
    results_.push_back(new_technique_report(technique, plan_.options.memory, kFramesInMemory));
    errors_.push_back(new_errors());
  }
  reference_result_ = new_technique_report(reference_, {}, kFramesInMemory);
  blocks_.resize(plan_.techniques.size());
  histories_.resize(plan_.techniques.size());
  last_errors_.resize(plan_.techniques.size());
  causes_.resize(plan_.techniques.size());
  if (has_varying_surfaces(plan_)) split_.emplace(plan_.techniques.size(), options.ladder);
  if (options.orders) orders_.emplace(std::move(written));
}

std::size_t Comparison::resume() {
  std::vector<std::string> specs = specs_of(plan_.techniques);
  specs.push_back(reference_.spec);
  const auto fits = [&](const FrameReport& report) {
    return report.parts.has_value() == split_.has_value() && report.error && has_all_measures(*report.error);
  };
  return records_.read(plan_.frames, specs, sums(), [&](const FrameRecord& record) {
    if (!std::all_of(record.reports.begin(), record.reports.end(), fits)) return false;
    recall_frame(record);
    return true;
  });
}

Report Comparison::run() {
  Progress progress;
  const std::size_t finished = reference_result_.frames.size();
  if (finished < plan_.frames.size()) {
    histories_ = rebuild_histories(plan_, finished, progress);
    if (split_) split_->go_on_after(finished, plan_, progress);
  }
  for (std::size_t at = finished; at < plan_.frames.size(); ++at) compare_frame(plan_.frames[at], progress);
  return report(progress);
}

ErrorAccumulator Comparison::new_errors() const {
  std::uint64_t pixels = 0;
  for (const std::size_t frame : plan_.frames)
    pixels += std::uint64_t{plan_.trace.frames[frame].width} * plan_.trace.frames[frame].height;
  return ErrorAccumulator(pixels);
}

void Comparison::compare_frame(std::size_t frame, Progress& progress) {
  WallTime reference_time;
  const FrameResult truth = render_kept(reference_, plan_, frame, progress, &reference_time);
  FrameReport reference = write_frame(output_, plan_, maker_, {reference_.spec, frame, truth});
  reference.wall_ms = reference_time;
  reference.error = no_error();
  if (split_) {
    reference.parts = ErrorParts{};
    split_->start_frame(plan_, frame, progress);
  }

  FrameRecord record;
  const std::vector<WallTime> times =
      render_frame(plan_, frame, progress, histories_, [&](std::size_t i, FrameResult&& result) {
        const std::optional<ErrorParts> parts = explain(i, result, truth.image, frame, progress);
        FrameReport& report = record.reports.emplace_back(
            write_frame(output_, plan_, maker_,
                        {plan_.techniques[i].spec, frame, result, &truth.image, metric_.pixels_per_degree}));
        report.parts = parts;
        errors_[i].add(result.image, truth.image);
        add_block_squares(result.image, truth.image, blocks_[i]);
        std::vector<float> errors = signed_errors(result.image, truth.image);
        if (errors.size() == last_errors_[i].size()) report.flicker = flicker(last_errors_[i], errors);
        last_errors_[i] = std::move(errors);
      });
  for (std::size_t i = 0; i < times.size(); ++i) {
    record.reports[i].wall_ms = times[i];
    results_[i].frames.push_back(record.reports[i]);
  }
  record.reports.push_back(reference);
  reference_result_.frames.push_back(std::move(reference));

  ladder_.add(plan_, frame, truth.image, progress);
  if (split_) split_->add_rungs(plan_, progress);
  if (orders_) orders_->add(reference_, plan_, frame, progress);
  record.sums = sums();
  records_.write(record, reference_result_.frames.size(), plan_.frames.size());
  output_.keep();
}

// Adds the layers of the error's parts and causes to the result of technique i, and returns the parts. Where surfaces
// vary, the causes are those of the error in visibility.
std::optional<ErrorParts> Comparison::explain(std::size_t i, FrameResult& result, const Image& truth, std::size_t frame,
                                              Progress& progress) {
  const Technique& technique = plan_.techniques[i];
  std::optional<ErrorParts> parts;
  if (split_) parts = split_->split(plan_, i, result, truth, progress);
  if (!options_.causes) return parts;
  if (split_) {
    causes_[i].add(technique, plan_, frame, SurfaceColors::by_pixel, split_->pictures(), result.pixel_counters);
  } else {
    causes_[i].add(technique, plan_, frame, SurfaceColors::by_place, {result.image, truth}, result.pixel_counters);
  }
  return parts;
}

// The EXR files hold the pictures to the last bit, so that the errors come out the same.
void Comparison::recall_frame(const FrameRecord& record) {
  reference_result_.frames.push_back(record.reports.back());
  const Image truth = read_image(record.reports.back());
  for (std::size_t i = 0; i < results_.size(); ++i) {
    results_[i].frames.push_back(record.reports[i]);
    const Image image = read_image(record.reports[i]);
    errors_[i].add(image, truth);
    add_block_squares(image, truth, blocks_[i]);
    last_errors_[i] = signed_errors(image, truth);
  }
  ladder_.set_sums(record.sums.at("ladder"));
  if (split_) split_->set_sums(record.sums.at("visibility_ladder"));
  for (std::size_t i = 0; i < causes_.size(); ++i) causes_[i].set_sums(record.sums.at("causes").at(i));
  if (orders_) orders_->set_sums(record.sums.at("orders"));
}

Json Comparison::sums() const {
  Json sums = {{"ladder", ladder_.sums()}, {"causes", Json::array()}};
  for (const CauseShares& causes : causes_) sums["causes"].push_back(causes.sums());
  if (split_) sums["visibility_ladder"] = split_->sums();
  if (orders_) sums["orders"] = orders_->sums();
  return sums;
}

Image Comparison::read_image(const FrameReport& frame) const { return read_exr(output_.path() / frame.image); }

// The equivalent rate of technique i of the plan. That of the ladder's own techniques, msaa:N without options, is N.
EquivalentMsaa Comparison::equivalent_of(std::size_t i, double error, const std::vector<LadderRung>& rungs,
                                         std::vector<EmrRange> ranges) const {
  const Technique& technique = plan_.techniques[i];
  if (!is_rung(technique)) return limited_equivalent_msaa(error, rungs, std::move(ranges));
  return {static_cast<double>(technique.samples), false, false};
}

// Adds the parts of the errors. The reference comes last in the report.
void Comparison::report_parts(Report& report, Progress& progress) {
  std::vector<double> rmses;
  for (TechniqueReport& result : report.results) {
    result.parts = pooled_parts(result.frames);
    rmses.push_back(result.parts->visibility);
  }
  rmses.pop_back();
  report.visibility_ladder = split_->rungs(plan_, rmses, progress);
  for (std::size_t i = 0; i < rmses.size(); ++i)
    report.results[i].visibility_msaa = equivalent_of(i, rmses[i], report.visibility_ladder);
  report.results.back().visibility_msaa = limited_equivalent_msaa(0.0, report.visibility_ladder);
}

// The errors of each technique over all frames. The means over pixels come from the frames' reports.
void Comparison::pool_errors() {
  for (std::size_t i = 0; i < results_.size(); ++i) {
    MeasurePool pool;
    for (const FrameReport& frame : results_[i].frames) pool.add(*frame.error, frame.pixels);
    pool.finish(results_[i].error.emplace(errors_[i].stats()));
  }
}

// What blocks and the reference's error say about the rate of a technique by RMSE; of other metrics they say nothing.
std::vector<EmrRange> Comparison::ranges_of(const MetricErrors& errors, const MsaaLadder::Rungs& rungs,
                                            const std::optional<double>& reference_error) const {
  if (options_.metric != "rmse") return {};
  std::vector<std::uint32_t> samples;
  for (const LadderRung& rung : rungs.rmse) samples.push_back(rung.samples);
  std::vector<EmrRange> ranges = {resampled_range(errors.blocks, samples, rungs.blocks)};
  if (reference_error) ranges.push_back(range_by_reference(errors.rmse, rungs.rmse, *reference_error));
  return ranges;
}

Report Comparison::report(Progress& progress) {
  pool_errors();
  std::vector<MetricErrors> errors;
  for (std::size_t i = 0; i < results_.size(); ++i)
    errors.push_back({results_[i].error->rmse, metric_.measure.error(*results_[i].error), blocks_[i]});
  const auto read_reference = [&](std::size_t frame) {  // frames of a plan follow each other
    return read_image(reference_result_.frames[frame - plan_.frames.front()]);
  };
  const MsaaLadder::Rungs rungs = ladder_.rungs(plan_, errors, read_reference, progress);
  const std::optional<double> reference_error = reference_error_of(results_);
  for (std::size_t i = 0; i < results_.size(); ++i) {
    TechniqueReport& result = results_[i];
    result.equivalent_msaa =
        equivalent_of(i, errors[i].error, rungs.error, ranges_of(errors[i], rungs, reference_error));
    result.causes = causes_[i].shares();
    result.flicker = pooled_flicker(result);
    if (orders_) orders_->report(i, result);
  }
  if (orders_) orders_->report(results_.size(), reference_result_);
  reference_result_.flicker = pooled_flicker(reference_result_);
  reference_result_.error = no_error();
  reference_result_.equivalent_msaa = limited_equivalent_msaa(0.0, rungs.error);

  Report report = new_report(plan_, maker_);
  report.metric = options_.metric;
  report.reference_error = reference_error;
  report.msaa_ladder = rungs.rmse;
  if (options_.metric != "rmse") report.metric_ladder = rungs.error;
  report.results = results_;
  report.results.push_back(reference_result_);
  if (split_) report_parts(report, progress);
  return report;
}

}  // namespace beampipe
