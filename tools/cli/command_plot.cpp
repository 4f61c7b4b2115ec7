// beampipe plot: draws the results of comparisons into a picture file.

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>

#include "tools/cli/commands.h"
#include "tools/cli/plot_file.h"
#include "tools/report/gnuplot.h"
#include "tools/report/plot.h"

namespace beampipe {
namespace {

struct PlotArguments {
  std::vector<std::string> folders;
  std::string output, kind = "frontier";
};

// What needs no errors, and so can be drawn of the folders of `run` as well.
std::string traffic_picture(const std::vector<ReportFile>& reports, PlotFormat format) {
  if (reports.size() > 1)
    throw UsageError("--kind traffic: expected one folder, found " + std::to_string(reports.size()));
  const std::optional<BarPlot> dram = bytes_plot(reports.front(), "dram_bytes");
  const auto is_zero = [](const BarPlot::Part& part) {
    return std::all_of(part.values.begin(), part.values.end(), [](double value) { return value == 0; });
  };
  if (!dram || std::all_of(dram->parts.begin(), dram->parts.end(), is_zero))
    throw ReportError((reports.front().folder / "report.json").string() +
                      ": it has no DRAM bytes; expected a report made without --no-memory-model");
  return draw(*dram, format);
}

std::string error_picture(const std::string& kind, const std::vector<ReportFile>& reports, PlotFormat format) {
  const ScatterPlot plot = kind == "speed"     ? speed_plot(reports)
                           : kind == "storage" ? storage_plot(reports)
                                               : frontier_plot(reports);
  for (const std::string& note : plot.notes) std::cerr << "beampipe: note: " << note << "\n";
  return draw(plot, format);
}

void plot(const PlotArguments& arguments, InterruptGate& gate) {
  const std::filesystem::path file = arguments.output;
  const PlotFormat format = plot_format(file);
  std::vector<ReportFile> reports;
  for (const std::string& folder : arguments.folders) reports.push_back(read_report(folder));
  const std::string picture =
      arguments.kind == "traffic" ? traffic_picture(reports, format) : error_picture(arguments.kind, reports, format);
  write_plot(file, picture, gate);
}

}  // namespace

void add_plot_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<PlotArguments>();
  Command command = line.add_command(
      "plot", "Draw what compare found: memory or time against error; or the memory traffic of stages");
  command.add("DIR", arguments->folders, "one or more folders that compare has written").required();
  command.add("-o,--output", arguments->output, "the picture: FILE.svg or FILE.png").required();
  command
      .add("--kind", arguments->kind,
           "frontier: bytes per pixel of framebuffer and A-buffer against equivalent MSAA rate; storage: the same with "
           "memory on chip; speed: time (ms) against error (RMSE); traffic: DRAM bytes of each stage, of one folder of "
           "run or compare")
      .one_of({"frontier", "storage", "speed", "traffic"})
      .shows_default();
  command.footer(
      "With several folders, draws geometric means of the techniques that are in all of them. A triangle marks a "
      "bound:\n"
      "the equivalent MSAA rate is at least (triangle up) or at most (triangle down) the value drawn. Needs "
      "gnuplot.\n\n"
      "Example:\n  beampipe plot out/fence out/maple -o frontier.svg");
  command.set_work([arguments, &gate] { plot(*arguments, gate); });
}

}  // namespace beampipe
