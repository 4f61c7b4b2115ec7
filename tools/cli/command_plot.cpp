// beampipe plot: draws the results of comparisons into a picture file.

#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/files/output.h"
#include "tools/report/gnuplot.h"
#include "tools/report/plot.h"

namespace beampipe {
namespace {

struct PlotArguments {
  std::vector<std::string> folders;
  std::string output, kind = "frontier";
};

PlotFormat format_of(const std::filesystem::path& file) {
  if (file.extension() == ".svg") return PlotFormat::svg;
  if (file.extension() == ".png") return PlotFormat::png;
  throw UsageError("--output " + file.string() + ": expected a name that ends in .svg or .png");
}

void plot(const PlotArguments& arguments, InterruptGate& gate) {
  const std::filesystem::path file = arguments.output;
  const PlotFormat format = format_of(file);
  std::vector<ReportFile> reports;
  for (const std::string& folder : arguments.folders) reports.push_back(read_report(folder));
  const ScatterPlot plot = arguments.kind == "speed"     ? speed_plot(reports)
                           : arguments.kind == "storage" ? storage_plot(reports)
                                                         : frontier_plot(reports);
  for (const std::string& note : plot.notes) std::cerr << "beampipe: note: " << note << "\n";
  OutputFolder output(std::filesystem::absolute(file).parent_path(), gate);
  output.write(file.filename(), draw(plot, format));
  output.keep();
}

}  // namespace

void add_plot_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<PlotArguments>();
  Command command = line.add_command("plot", "Draw what compare found: memory or time against error");
  command.add("DIR", arguments->folders, "one or more folders that compare has written").required();
  command.add("-o,--output", arguments->output, "the picture: FILE.svg or FILE.png").required();
  command
      .add("--kind", arguments->kind,
           "frontier: framebuffer and A-buffer (bytes per pixel) and equivalent MSAA rate; storage: the same with what "
           "a bin has on chip; speed: time (ms) and error (RMSE)")
      .one_of({"frontier", "storage", "speed"})
      .shows_default();
  command.footer(
      "Given several folders, it draws the geometric means of the techniques that are in all of them. A triangle marks "
      "a\n"
      "bound: the equivalent MSAA rate is at least (triangle up) or at most (triangle down) the value drawn. Needs "
      "the\n"
      "program gnuplot.\n\n"
      "Example:\n  beampipe plot out/fence out/maple -o frontier.svg");
  command.set_work([arguments, &gate] { plot(*arguments, gate); });
}

}  // namespace beampipe
