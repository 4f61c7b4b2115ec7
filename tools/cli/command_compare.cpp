// beampipe compare: what run does, and how wrong each picture is.

#include <algorithm>
#include <iostream>
#include <memory>
#include <utility>

#include "pipeline/spec.h"
#include "tools/cli/commands.h"
#include "tools/cli/metric_options.h"
#include "tools/cli/record_inspections.h"
#include "tools/cli/run_arguments.h"
#include "tools/cli/run_report.h"
#include "tools/cli/trace_events.h"
#include "tools/evaluate/comparison.h"
#include "tools/evaluate/draw_notes.h"
#include "tools/evaluate/known_specs.h"

namespace beampipe {
namespace {

constexpr const char* kCompareFooter =
    R"(The reference is the technique `reference`, with 4096 samples per pixel; its pictures are written too. Errors are
differences of linear RGB values from it: RMSE (root mean square), bias (mean), p99 (99th percentile of the absolute
values) and max. `beampipe diff --help` explains the other measures. EMR, the equivalent MSAA rate, is the N at which
msaa:N has the same RMSE on the same frames, or the same error by --metric.
With materials, errors have two parts: visibility (how much of a pixel each surface covers; it has its own EMR) and
shading (the colour of each surface there). All pictures are then rendered twice.

Example:
  beampipe compare fence.json -t beam alpha msaa:1,8,32 -o out

Techniques:
)";

// Their errors are in no table of causes.
void tell_unexplained(const std::vector<std::string>& specs) {
  if (!specs.empty())
    std::cout << "\nThese record no weights of triangles, so --causes cannot split their errors: "
              << list_of(specs, "and") << "\n";
}

void compare(const RunArguments& arguments, const CompareOptions& options, const RecordedPixels& pixels,
             const std::string& cache_folder, InterruptGate& gate) {
  check_pixels_per_degree(options.pixels_per_degree);
  RunPlan plan = make_plan(arguments);
  if (const std::filesystem::path folder = picture_cache_folder(cache_folder); !folder.empty())
    plan.pictures = std::make_shared<PictureCache>(folder, plan.trace);
  tell_notes(plan.notes);
  std::vector<std::string> unexplained;
  for (const Technique& technique : plan.techniques)
    if (!technique.has_weights) unexplained.push_back(technique.spec);
  for (const std::size_t frame : plan.frames)
    for (const std::string& text : pixels.chosen) parse_pixel("--inspect", text, plan.trace.frames[frame]);
  const TraceEvents events(arguments, plan);
  OutputFolder output(arguments.output, gate);
  output.lock();
  Comparison comparison(options, std::move(plan), output);
  if (!arguments.force && !arguments.resume) comparison.require_own_folder();
  if (arguments.resume) {
    if (comparison.is_finished()) return tell_finished(output);
    tell_resumption(comparison.plan(), comparison.resume());
  }
  Report report = comparison.run();
  record_inspections(comparison.plan(), pixels, report, output);
  finish_report(output, comparison.plan().trace, std::move(report));
  if (options.causes) tell_unexplained(unexplained);
  events.write(gate);
}

}  // namespace

void add_compare_command(CommandLine& line, const std::string& command_line, InterruptGate& gate) {
  const auto arguments = std::make_shared<RunArguments>();
  arguments->command_line = command_line;
  const auto options = std::make_shared<CompareOptions>();
  const auto pixels = std::make_shared<RecordedPixels>();
  Command command =
      line.add_command("compare", "Render a trace and the reference: pictures, errors, equivalent MSAA rates");
  add_run_arguments(command, *arguments);
  command
      .add(
          "--ladder", options->ladder,
          "MSAA rates to measure, between which equivalent rates are interpolated (default: 1,2,4,...,256, and 512 and "
          "1024 if these are not enough)")
      .list("N,N,...");
  command
      .add("--metric", options->metric,
           "the measure by which equivalent rates are found (that of visibility is always found by RMSE)")
      .one_of(metric_names())
      .shows_default();
  add_pixels_per_degree(command, options->pixels_per_degree);
  const auto measures_reference = std::make_shared<bool>(false);
  command.add_flag("--reference-error", *measures_reference,
                   std::string("render ") + kSecondReferenceSpec +
                       " too, report the reference's own error, and widen the ranges of equivalent rates by it");
  command.add_flag(
      "--causes", options->causes,
      "split each pixel's visibility error by cause, as layers of the counters and as a table (beam in every "
      "order, casav in sorted order, and alpha)");
  command.add_flag(
      "--orders", options->orders,
      "also render the triangles shuffled, near to far and far to near; print the error of each order and how "
      "far the pictures differ");
  command
      .add("--inspect-worst", pixels->worst,
           "record the histories of the N worst pixels of each technique for the report page (default: 3; techniques "
           "that `beampipe inspect` can explain)")
      .between(0, 1000);
  command.add("--inspect", pixels->chosen, "X,Y of other pixels to record, in every frame");
  const auto cache_folder = std::make_shared<std::string>();
  add_reference_cache(command, *cache_folder);
  command.footer(kCompareFooter + technique_help());
  command.set_work([arguments, options, pixels, cache_folder, measures_reference, &gate] {
    if (*measures_reference && std::ranges::count(arguments->specs, kSecondReferenceSpec) == 0)
      arguments->specs.emplace_back(kSecondReferenceSpec);
    compare(*arguments, *options, *pixels, *cache_folder, gate);
  });
}

}  // namespace beampipe
