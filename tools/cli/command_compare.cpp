// beampipe compare: what run does, and how wrong each picture is against the reference.

#include <algorithm>
#include <cmath>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/cli/run_arguments.h"
#include "tools/cli/run_report.h"
#include "tools/cli/trace_events.h"
#include "tools/evaluate/diagnosis.h"
#include "tools/evaluate/render.h"
#include "tools/evaluate/resume.h"
#include "tools/files/image_io.h"

namespace beampipe {
namespace {

const std::vector<std::uint32_t> kDefaultLadder = {1, 2, 4, 8, 16, 32, 64, 128, 256};
const std::vector<std::uint32_t> kLadderExtension = {512, 1024};

constexpr const char* kFooter =
    R"(Errors are of linear RGB against technique `reference`, whose pictures are written too: RMSE, mean (bias), 99th
percentile and maximum of the absolute error. EMR, the equivalent MSAA rate, is the N at which msaa:N has the same
RMSE on the same frames.

Example:
  beampipe compare fence.json -t beam alpha msaa:1,8,32 -o out

Techniques:
)";

struct CompareArguments : RunArguments {
  std::vector<std::uint32_t> ladder;  // empty: the default, extended as far as need be
  bool causes = false, orders = false;
};

Technique msaa(std::uint32_t samples) { return parse_technique("msaa:" + std::to_string(samples)); }

// Says which technique and frame an error is about.
template <typename Body>
void naming(const std::string& spec, std::size_t frame, Body body) {
  try {
    body();
  } catch (const std::exception& error) {
    throw std::runtime_error(spec + ", frame " + std::to_string(frame) + ": " + error.what());
  }
}

Json own_options(const CompareArguments& arguments) {
  return {{"ladder", arguments.ladder}, {"causes", arguments.causes}, {"orders", arguments.orders}};
}

// Over the frames that follow another.
std::optional<double> pooled_flicker(const TechniqueReport& result) {
  double squares = 0, frames = 0;
  for (const FrameReport& frame : result.frames) {
    if (!frame.flicker) continue;
    squares += *frame.flicker * *frame.flicker;
    ++frames;
  }
  return frames > 0 ? std::optional(std::sqrt(squares / frames)) : std::nullopt;
}

class Comparison {
 public:
  Comparison(const CompareArguments& arguments, RunPlan plan, OutputFolder& output)
      : arguments_(arguments),
        output_(output),
        plan_(std::move(plan)),
        maker_(made_by("compare", plan_, own_options(arguments))),
        records_(output, maker_) {
    std::erase_if(plan_.techniques, [](const Technique& technique) { return technique.spec == "reference"; });
    std::vector<std::uint32_t> rungs = arguments.ladder.empty() ? kDefaultLadder : arguments.ladder;
    std::sort(rungs.begin(), rungs.end());
    rungs.erase(std::unique(rungs.begin(), rungs.end()), rungs.end());
    for (const std::uint32_t samples : rungs) ladder_.push_back({msaa(samples)});
    std::vector<Technique> written = plan_.techniques;
    written.push_back(reference_);
    require_writable_folders(output_, written);
    for (const Technique& technique : plan_.techniques) {
      results_.push_back(new_technique_report(technique));
      errors_.push_back(new_errors());
    }
    reference_result_ = new_technique_report(reference_);
    causes_.resize(plan_.techniques.size());
    if (arguments.orders) orders_.emplace(std::move(written));
  }

  // Once. Nothing: an earlier comparison that was to be resumed is finished.
  std::optional<Report> run() {
    std::vector<FrameRecord> finished;
    if (arguments_.resume) {
      if (records_.is_finished()) return std::nullopt;
      std::vector<std::string> specs = specs_of(plan_.techniques);
      specs.push_back(reference_.spec);
      finished = records_.read(plan_.frames, specs, sums());
      tell_resumption(plan_, finished.size());
    }
    for (const FrameRecord& record : finished) recall_frame(record);
    if (finished.size() < plan_.frames.size()) histories_ = rebuild_histories(plan_, finished.size(), progress_);
    for (std::size_t at = finished.size(); at < plan_.frames.size(); ++at) compare_frame(plan_.frames[at]);
    for (std::size_t i = 0; i < results_.size(); ++i) results_[i].error = errors_[i].stats();
    measure_ladder();
    for (std::size_t i = 0; i < results_.size(); ++i) {
      const std::uint32_t samples = plan_.techniques[i].samples;
      results_[i].equivalent_msaa = samples > 0 ? EquivalentMsaa{static_cast<double>(samples), false, false}
                                                : equivalent_msaa(results_[i].error->rmse, rungs_);
    }
    for (std::size_t i = 0; i < results_.size(); ++i) {
      results_[i].causes = causes_[i].shares();
      results_[i].flicker = pooled_flicker(results_[i]);
      if (orders_) orders_->report(i, results_[i]);
    }
    if (orders_) orders_->report(results_.size(), reference_result_);
    reference_result_.flicker = pooled_flicker(reference_result_);
    reference_result_.error = ErrorStats{};
    reference_result_.equivalent_msaa = equivalent_msaa(0.0, rungs_);

    Report report = new_report(plan_, maker_);
    report.msaa_ladder = rungs_;
    report.results = results_;
    report.results.push_back(reference_result_);
    return report;
  }

 private:
  // Pools its errors over the frames.
  struct Rung {
    Technique technique;
    double squares = 0, pixels = 0;

    double rmse() const { return std::sqrt(squares / pixels); }
  };

  ErrorAccumulator new_errors() const {
    std::uint64_t pixels = 0;
    for (const std::size_t frame : plan_.frames) {
      pixels += std::uint64_t{plan_.trace.frames[frame].width} * plan_.trace.frames[frame].height;
    }
    return ErrorAccumulator(pixels);
  }

  // The result of the technique with this spec, when it was among those asked for.
  const TechniqueReport* asked_result(const std::string& spec) const {
    const auto found = std::find_if(results_.begin(), results_.end(),
                                    [&](const TechniqueReport& result) { return result.technique == spec; });
    return found == results_.end() ? nullptr : &*found;
  }

  void compare_frame(std::size_t frame) {
    WallTime reference_time;
    const FrameResult truth = render_once(reference_, plan_, frame, progress_, &reference_time);
    FrameReport& report =
        reference_result_.frames.emplace_back(write_frame(output_, reference_.spec, frame, truth, nullptr));
    report.wall_ms = reference_time;
    report.error = ErrorStats{};

    const std::vector<WallTime> times =
        render_frame(plan_, frame, progress_, histories_, [&](std::size_t i, FrameResult&& result) {
          const std::string& spec = plan_.techniques[i].spec;
          naming(spec, frame, [&] {
            if (arguments_.causes) causes_[i].add(plan_.techniques[i], plan_, frame, truth.image, result);
            results_[i].frames.push_back(write_frame(output_, spec, frame, result, &truth.image));
            errors_[i].add(result.image, truth.image);
            std::vector<float> errors = signed_errors(result.image, truth.image);
            if (errors.size() == last_errors_[i].size())
              results_[i].frames.back().flicker = flicker(last_errors_[i], errors);
            last_errors_[i] = std::move(errors);
          });
        });
    for (std::size_t i = 0; i < times.size(); ++i) results_[i].frames.back().wall_ms = times[i];

    for (Rung& rung : ladder_) measure_rung(rung, frame, truth.image);
    if (orders_) orders_->add(reference_, plan_, frame, progress_);
    write_record();
    output_.keep();
  }

  // Of the last frame.
  void write_record() {
    FrameRecord record;
    for (const TechniqueReport& result : results_) record.reports.push_back(result.frames.back());
    record.reports.push_back(reference_result_.frames.back());
    record.sums = sums();
    records_.write(record);
  }

  // Of what was added so far.
  Json sums() const {
    Json sums;
    for (const Rung& rung : ladder_) sums["ladder"].push_back(Json::array({rung.squares, rung.pixels}));
    for (const CauseShares& causes : causes_) sums["causes"].push_back(causes.sums());
    if (orders_) sums["orders"] = orders_->sums();
    return sums;
  }

  // Takes over what an earlier comparison found. The EXRs hold the pictures to the last bit.
  void recall_frame(const FrameRecord& record) {
    reference_result_.frames.push_back(record.reports.back());
    const Image truth = read_exr(output_.path() / record.reports.back().image);
    for (std::size_t i = 0; i < results_.size(); ++i) {
      results_[i].frames.push_back(record.reports[i]);
      const Image image = read_exr(output_.path() / record.reports[i].image);
      errors_[i].add(image, truth);
      last_errors_[i] = signed_errors(image, truth);
    }
    for (std::size_t i = 0; i < ladder_.size(); ++i) {
      const Json& sums = record.sums.at("ladder").at(i);
      ladder_[i].squares = sums.at(0).get<double>();
      ladder_[i].pixels = sums.at(1).get<double>();
    }
    for (std::size_t i = 0; i < causes_.size(); ++i) causes_[i].set_sums(record.sums.at("causes").at(i));
    if (orders_) orders_->set_sums(record.sums.at("orders"));
  }

  void measure_rung(Rung& rung, std::size_t frame, const Image& reference) {
    if (asked_result(rung.technique.spec)) return;
    const Image image = render_picture(rung.technique, plan_, frame, progress_);
    naming(rung.technique.spec, frame, [&] {
      const double rmse = measure_error(image, reference).rmse;
      const double pixels = static_cast<double>(reference.width) * reference.height;
      rung.squares += rmse * rmse * pixels;
      rung.pixels += pixels;
    });
  }

  double rmse_of(const Rung& rung) const {
    const TechniqueReport* asked = asked_result(rung.technique.spec);
    return asked ? asked->error->rmse : rung.rmse();
  }

  bool some_technique_beats_the_ladder() const {
    for (std::size_t i = 0; i < results_.size(); ++i) {
      if (plan_.techniques[i].samples == 0 && results_[i].error->rmse < best_rmse(rungs_)) return true;
    }
    return false;
  }

  void measure_ladder() {
    for (const Rung& rung : ladder_) rungs_.push_back({rung.technique.samples, rmse_of(rung)});
    if (!arguments_.ladder.empty()) return;
    for (const std::uint32_t samples : kLadderExtension) {
      if (!some_technique_beats_the_ladder()) return;
      Rung rung{msaa(samples)};
      for (const FrameReport& frame : reference_result_.frames) {  // the EXR holds the reference to the last bit
        measure_rung(rung, frame.index, read_exr(output_.path() / frame.image));
      }
      rungs_.push_back({samples, rmse_of(rung)});
    }
  }

  const CompareArguments& arguments_;
  OutputFolder& output_;
  RunPlan plan_;
  Json maker_;
  FrameRecords records_;
  Technique reference_ = parse_technique("reference");
  std::vector<Rung> ladder_;
  std::vector<TechniqueReport> results_;  // beside plan_.techniques
  std::vector<ErrorAccumulator> errors_;  // likewise
  TechniqueReport reference_result_;
  std::vector<LadderRung> rungs_;                                                   // what the ladder came to
  std::vector<History> histories_ = std::vector<History>(plan_.techniques.size());  // likewise
  std::vector<std::vector<float>> last_errors_ = std::vector<std::vector<float>>(plan_.techniques.size());  // likewise
  std::vector<CauseShares> causes_;                                                                         // likewise
  std::optional<OrderComparison> orders_;  // where they were asked for
  Progress progress_;
};

}  // namespace

void add_compare_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<CompareArguments>();
  Command command =
      line.add_command("compare", "Render a trace and the reference: pictures, errors, equivalent MSAA rates");
  add_run_arguments(command, *arguments);
  command
      .add("--ladder", arguments->ladder,
           "MSAA rates to find equivalent rates between (default: 1,2,4,...,256; 512 and 1024 if need be)")
      .list("N,N,...");
  command.add_flag("--causes", arguments->causes,
                   "split each pixel's error by cause: layers of the counters, and a table (beam and alpha only)");
  command.add_flag("--orders", arguments->orders,
                   "also with the triangles shuffled, near to far and far to near: errors, and how far they differ");
  command.footer(kFooter + technique_help());
  command.set_work([arguments, &gate] {
    RunPlan plan = make_plan(*arguments);
    const TraceEvents events(*arguments, plan);
    OutputFolder output(arguments->output, gate);
    output.lock();
    // Its progress line is gone by the time that the report is finished.
    const std::optional<Report> report = Comparison(*arguments, std::move(plan), output).run();
    if (!report) return tell_finished(output);
    finish_report(output, *report);
    events.write(gate);
  });
}

}  // namespace beampipe
