// beampipe correlate: modelled times of finished runs beside measured ones.

#include <iostream>
#include <memory>
#include <optional>

#include "tools/cli/commands.h"
#include "tools/cli/plot_file.h"
#include "tools/report/measured.h"
#include "tools/report/report_json.h"

namespace beampipe {
namespace {

struct CorrelateArguments {
  std::string measured, output;
  bool json = false;
};

void correlate(const CorrelateArguments& arguments, InterruptGate& gate) {
  std::optional<PlotFormat> format;
  if (!arguments.output.empty()) format = plot_format(arguments.output);
  const std::vector<MeasuredRow> rows = read_measured(arguments.measured);
  if (format) {
    if (rows.empty()) throw std::runtime_error(arguments.measured + ": expected rows to draw, found none");
    write_plot(arguments.output, draw(measured_plot(rows), *format), gate);
  }
  std::cout << (arguments.json ? json_text(measured_json(rows)) : measured_text(rows));
}

}  // namespace

void add_correlate_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<CorrelateArguments>();
  Command command = line.add_command("correlate", "Hold modelled times to measured ones");
  command.add("MEASURED", arguments->measured, "a CSV file with a row for each measured number").required();
  command.add("-o,--output", arguments->output, "also draw modelled against measured: FILE.svg or FILE.png");
  command.add_flag("--json", arguments->json, "print JSON");
  command.footer(
      "The file starts with this line; fields with commas are in quotes:\n"
      "  name,folder,technique,implementation,over_folder,over_technique,measured,fitted,source\n"
      "folder      that run or compare wrote, relative to the file\n"
      "over_...    with over_technique, the row is a quotient: the first time over this one; over_folder if it is of\n"
      "            another run\n"
      "measured    milliseconds per frame, or the quotient\n"
      "fitted      empty, or the word fitted: the number was used to choose rates, and the statistics leave it out\n\n"
      "in turn     one stage after the other; at once: all units at once\n"
      "MAPE        mean absolute error, in percent of what was measured\n"
      "spread      geometric standard deviation of modelled over measured\n\n"
      "Example:\n"
      "  docs/examples/silicon/make_runs.py beampipe silicon\n"
      "  beampipe correlate silicon/measured.csv -o silicon.svg");
  command.set_work([arguments, &gate] { correlate(*arguments, gate); });
}

}  // namespace beampipe
