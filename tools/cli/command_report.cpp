// beampipe report: makes a page, plots and tables from the results of run or compare, or a page of several of them.

#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/files/output.h"
#include "tools/files/shell_word.h"
#include "tools/report/figures.h"
#include "tools/report/gnuplot.h"
#include "tools/report/inspections.h"
#include "tools/report/layers.h"
#include "tools/report/overview.h"
#include "tools/report/page.h"
#include "tools/report/tables.h"

namespace beampipe {
namespace {

struct ReportArguments {
  std::vector<std::string> folders;
  std::string output;
  std::optional<std::size_t> frame;
};

// The position in the report of the frame with this index in the trace.
std::size_t position_of(const ReportFile& report, std::optional<std::size_t> frame) {
  if (!frame) return 0;
  const auto& frames = report.json.at("results").at(0).at("frames").elements();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].at("index").get<std::size_t>() == *frame) return i;
  }
  throw UsageError("--frame " + std::to_string(*frame) + ": expected one of the report's frames, " +
                   frames.front().at("index").dump() + " to " + frames.back().at("index").dump());
}

void write_report(const ReportArguments& arguments, InterruptGate& gate) {
  OutputFolder output(arguments.folders.front(), gate);
  output.lock();
  const ReportFile report = read_report(arguments.folders.front());
  std::vector<Figure> figures;
  read_from_report(report.folder, [&] {
    const std::vector<Table> tables = report_tables(report);
    figures = report_figures(report);
    const std::size_t shown = position_of(report, arguments.frame);
    const Json layers = page_layers(report, shown);
    const auto index = report.json.at("results").at(0).at("frames").at(shown).at("index").get<std::size_t>();
    output.write("report.html", page_html(report, tables, figures, layers, index, report_inspections(report)));
    for (const Table& table : tables) output.write("tables/" + table.name + ".csv", csv_text(table));
  });
  output.keep();
  for (const Figure& figure : figures) {
    for (const auto& choice : figure.choices) {
      std::visit([&](const auto& plot) { output.write(plot_file(plot), draw(plot, PlotFormat::svg)); }, choice.second);
    }
  }
  output.keep();
  std::cout << "page:   " << (report.folder / "report.html").string()
            << "\ntables: " << (report.folder / "tables").string()
            << "/*.csv\nplots:  " << (report.folder / "plots").string() << "/*.svg\n";
}

void write_overview(const ReportArguments& arguments, InterruptGate& gate) {
  const std::filesystem::path file = std::filesystem::absolute(arguments.output);
  if (file.extension() != ".html")
    throw UsageError("--output " + arguments.output + ": expected a name that ends in .html");
  for (const std::string& folder : arguments.folders)
    if (std::filesystem::weakly_canonical(file) == std::filesystem::weakly_canonical(folder) / "report.html")
      throw UsageError("--output " + arguments.output + ": expected another name than that of the run's own page");
  require_writable_file(file);
  std::string command = "beampipe report";
  std::vector<ReportFile> reports;
  for (const std::string& folder : arguments.folders) {
    command += " " + short_shell_word(folder);
    reports.push_back(read_report(folder));
  }
  const Overview overview = overview_of(reports, file.parent_path());
  OutputFolder output(file.parent_path(), gate);
  output.write(file.filename(), overview_html(overview, command + " -o " + short_shell_word(arguments.output)));
  output.keep();
  std::cout << "page:   " << arguments.output << "\n";
}

void work(const ReportArguments& arguments, InterruptGate& gate) {
  if (!arguments.output.empty()) return write_overview(arguments, gate);
  if (arguments.folders.size() > 1)
    throw UsageError("several folders: expected -o FILE.html for their page, found none");
  write_report(arguments, gate);
}

}  // namespace

void add_report_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<ReportArguments>();
  Command command =
      line.add_command("report", "Make a page to read, with tables and plots, from the results of run or compare");
  command.add("DIR", arguments->folders, "folders that run or compare wrote").required();
  const Option output =
      command.add("-o,--output", arguments->output, "FILE.html: one page over all these runs; several folders need it");
  command
      .add("--frame", arguments->frame,
           "the frame that the page shows first (default: the first one); if a page would be too large, it has only "
           "some frames, and always this one")
      .excludes(output);
  command.footer(
      "With -o, writes that file alone. Without it, writes into DIR: report.html, a single file to open in a browser;\n"
      "tables/*.csv, the tables of the page; and plots/*.svg, its plots (needs the program gnuplot).\n\n"
      "Example:\n  beampipe compare fence.json -t beam msaa:8 -o out\n"
      "  beampipe report out\n"
      "  beampipe report fence maple -o overview.html");
  command.set_work([arguments, &gate] { work(*arguments, gate); });
}

}  // namespace beampipe
