// Reads any bytes as what runs, comparisons and sweeps leave: report.json and, after NULs, the inspections that it may
// name, the record of a frame of a stopped run, and a stored result of a sweep. Each gives an error of one line, or
// what the page, the tables, `beampipe model` and `beampipe claims` make of it.
#include <cmath>

#include "tests/fuzz/fuzz_input.h"
#include "tests/traces/test_images.h"
#include "tools/claims/our_figures.h"
#include "tools/evaluate/remodel.h"
#include "tools/evaluate/resume.h"
#include "tools/files/digest.h"
#include "tools/files/image_io.h"
#include "tools/files/sealed_json.h"
#include "tools/inspect/recorded.h"
#include "tools/report/gnuplot.h"
#include "tools/report/inspections.h"
#include "tools/report/layers.h"
#include "tools/report/page.h"
#include "tools/report/report_text.h"
#include "tools/report/times_text.h"
#include "traces/files/trace_io.h"

namespace beampipe {
namespace {

// Calls read(), which may throw any error of one line, but not one of the standard library or of the file system, which
// would say nothing about the file.
template <class Read>
void expect_value_or_line(const Read& read) {
  try {
    read();
  } catch (const std::system_error&) {
    std::abort();
  } catch (const std::runtime_error& error) {
    require_one_line(error.what());
  }
}

// What `beampipe report` makes: nothing in the page but its own files looks like a tag, and plots have names of files.
void make_page(const ReportFile& report) {
  const std::vector<Table> tables = report_tables(report);
  for (const Table& table : tables) {
    csv_text(table);
    for (const auto& row : table.rows) require(row.size() == table.columns.size());
  }
  const std::vector<Figure> figures = report_figures(report);
  for (const Figure& figure : figures)
    for (const auto& choice : figure.choices)
      std::visit(
          [](const auto& plot) {
            const std::string file = plot_file(plot);
            require(file.rfind('/') == file.find('/'));
            gnuplot_script(plot, PlotFormat::svg);
          },
          choice.second);
  const std::string page = page_html(report, tables, figures, page_layers(report, 0), 0, report_inspections(report));
  static const std::ptrdiff_t tags = std::count(page.begin(), page.end(), '<');
  require(std::count(page.begin(), page.end(), '<') == tags);
}

void model(const ReportFile& report) {
  const Report again = remodelled(report.json);
  times_text(again);
  times_json(again).dump();
  static const std::vector<Formula> formulas = our_formulas();
  for (const Formula& formula : formulas) formula.ours({again, again.hardware.implementations.front()});
}

// A record of this run, whatever it says about itself, is read as it was written or not at all.
void resume(const FuzzFolder& folder, std::string_view text) {
  static InterruptGate gate;
  static OutputFolder output(folder.path(), gate);
  const Json maker = {{"command", "compare"}, {"trace", "digest of a trace"}}, sums = {{"squares", {{"rgb", 0}}}};
  const std::vector<std::size_t> frames = {0};
  const std::vector<std::string> specs = {"msaa:1"};
  FrameRecords records(output, maker);
  const std::string name = frame_record_name(0);
  folder.write(name, text);
  expect_value_or_line([&] { records.require_own_folder(); });
  const auto read = [&] {
    std::vector<FrameRecord> found;
    records.read(frames, specs, sums, [&](const FrameRecord& record) {
      found.push_back(record);
      return true;
    });
    return found;
  };
  expect_value_or_line([&] { read(); });
  expect_value_or_line([&] {
    Json json = parse_json((folder.path() / name).string());
    if (!json.is_object()) return;
    json["made_by"] = maker;
    json.erase("digest");
    const std::string digest = digest_of(json_text(json));
    json["digest"] = digest;
    folder.write(name, json_text(json));
    const std::vector<FrameRecord> found = read();
    if (found.empty()) return;
    require(found.size() == 1 && found[0].reports.size() == 1 && found[0].reports[0].index == 0);
    records.write(found[0], 1, 1);
    const std::vector<FrameRecord> again = read();
    require(again.size() == 1 && again[0].sums == found[0].sums &&
            again[0].reports[0].stages == found[0].reports[0].stages);
  });
  expect_value_or_line([&] { records.is_finished(); });
}

// What was sealed is what comes back, and what was not sealed is nothing.
void unseal(const FuzzFolder& folder, std::string_view text) {
  const std::filesystem::path file = folder.write("result.json", text);
  expect_value_or_line([&] {
    Json json = parse_json(file.string());
    const Json result = unsealed(json);
    if (!json.is_object()) return require(result.is_null());
    json.erase("digest");
    require(result.is_null() || result == json);
    require(unsealed(sealed(json)) == json);
  });
}

}  // namespace
}  // namespace beampipe

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace beampipe;
  static const FuzzFolder folder;
  static const bool pictures_are_there = [] {
    folder.write("beam/frame_0000.png", kColors);
    for (const char* name : {"beam/frame_0000.exr", "msaa_1/frame_0000.exr", "reference/frame_0000.exr"})
      folder.write(name, encode_exr(Image{2, 1, {0, 0.5f, 1, 1, INFINITY, NAN, -1, 0}}));
    folder.write("beam/frame_0000_counters.exr", encode_exr({2, 1, {{"fragments", {1, NAN}}}}));
    return true;
  }();
  require(pictures_are_there);
  const std::vector<std::string_view> parts = parts_of(text_of(data, size), 4);
  folder.write("report.json", parts[0]);
  folder.write(std::string("beam/") + kInspectionsFile, parts[1]);
  expect_value_or_line([&] {
    const ReportFile report = read_report(folder.path());
    expect_value_or_line([&] { make_page(report); });
    expect_value_or_line([&] { model(report); });
    expect_value_or_line([&] { storage_plot({report, report}); });
  });
  resume(folder, parts[2]);
  unseal(folder, parts[3]);
  return 0;
}
