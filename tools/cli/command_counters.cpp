// beampipe counters: what is counted, of a stage, of a pixel and of a frame.

#include <algorithm>
#include <iostream>
#include <memory>

#include "pipeline/technique_table.h"
#include "stages/cost/counter_registry.h"
#include "stages/cost/counters.h"
#include "tools/cli/commands.h"
#include "tools/report/report_text.h"
#include "traces/closest_name.h"
#include "traces/files/json.h"

namespace beampipe {
namespace {

using Rows = std::vector<std::vector<std::string>>;

struct CountersArguments {
  std::string stage;  // empty: all
  bool json = false;
};

std::string text_of(const StageInfo& stage) {
  const char* const units = stage.can_be_fixed_function && stage.can_be_shader ? "fixed function or shader"
                            : stage.can_be_fixed_function                      ? "fixed function"
                            : stage.can_be_shader                              ? "shader"
                                                                               : "not modelled";
  std::string names;
  for (const CounterInfo& counter : stage_counters())
    if (has_counter(stage, counter)) names += std::string(names.empty() ? "" : " ") + counter.name;
  Rows rows = {{"  in", std::string(stage.items_in)}, {"  out", std::string(stage.items_out)}};
  if (!stage.lanes_used.empty()) {
    rows.push_back({"  lanes used", std::string(stage.lanes_used)});
    rows.push_back({"  lanes issued", std::string(stage.lanes_issued)});
  }
  rows.push_back({"  counters", names});
  return std::string(stage.name) + " (" + std::string(name_of(stage.group)) + "; " + units + ")\n" +
         align_columns(rows, {0, 1}) + "\n";
}

// "beam, casav", "msaa:N with motion", "compare".
std::string place_of(const PixelCounterInfo& counter) {
  std::string titles;
  for (const TechniqueKind& kind : technique_kinds())
    if (std::count(kind.counters.begin(), kind.counters.end(), counter.name) > 0)
      titles += (titles.empty() ? "" : ", ") + title_of(kind);
  const std::string where = counter.where;
  return titles.empty() ? where : where.empty() ? titles : titles + " with " + where;
}

std::string all_text() {
  std::string text;
  for (const StageInfo& stage : stage_list()) text += text_of(stage);
  Rows rows;
  for (const CounterInfo& counter : stage_counters()) rows.push_back({counter.name, counter.unit, counter.meaning});
  text += "Counters of stages. Those of a depth pre-pass are counted apart, as prepass_depth_test and so on.\n" +
          align_columns(rows, {0, 1, 2});
  rows.clear();
  for (const auto* counters : {&pixel_counters(), &error_counters()})
    for (const PixelCounterInfo& counter : *counters)
      rows.push_back({counter.name, counter.unit, std::string(counter.meaning) + " (" + place_of(counter) + ")"});
  text += "\nCounters of pixels\n" + align_columns(rows, {0, 1, 2});
  rows.clear();
  for (const FrameCounterInfo& counter : frame_counters())
    rows.push_back({counter.name, counter.unit, counter.meaning});
  return text + "\nCounters of frames\n" + align_columns(rows, {0, 1, 2});
}

Json to_json(const StageInfo& stage) {
  Json json = {{"stage", stage.name},           {"group", name_of(stage.group)},
               {"color", stage.color},          {"fixed_function", stage.can_be_fixed_function},
               {"shader", stage.can_be_shader}, {"items_in", stage.items_in},
               {"items_out", stage.items_out}};
  if (!stage.lanes_used.empty()) json["lanes_used"] = stage.lanes_used, json["lanes_issued"] = stage.lanes_issued;
  json["counters"] = Json::array();
  for (const CounterInfo& counter : stage_counters())
    if (has_counter(stage, counter)) json["counters"].push_back(counter.name);
  return json;
}

template <class Counters>
Json list_of_counters(const Counters& counters) {
  Json json = Json::array();
  for (const auto& counter : counters)
    json.push_back({{"name", counter.name}, {"unit", counter.unit}, {"meaning", counter.meaning}});
  return json;
}

void print_counters(const CountersArguments& arguments) {
  std::vector<std::string> names;
  for (const StageInfo& stage : stage_list()) names.emplace_back(stage.name);
  const std::optional<Stage> chosen = find_stage(arguments.stage);
  if (!arguments.stage.empty() && !chosen)
    throw UsageError(arguments.stage + ": expected the name of a stage, found none" +
                     did_you_mean(arguments.stage, names));
  if (!arguments.json) {
    std::cout << (chosen ? text_of(info_of(chosen->id)) : all_text());
    return;
  }
  Json json = {{"stages", Json::array()},
               {"of_stages", list_of_counters(stage_counters())},
               {"of_pixels", list_of_counters(pixel_counters())},
               {"of_errors", list_of_counters(error_counters())},
               {"of_frames", list_of_counters(frame_counters())}};
  for (const StageInfo& stage : stage_list())
    if (!chosen || stage.id == chosen->id) json["stages"].push_back(to_json(stage));
  std::cout << json.dump(2) << '\n';
}

}  // namespace

void add_counters_command(CommandLine& line) {
  const auto arguments = std::make_shared<CountersArguments>();
  Command command = line.add_command("counters", "List the stages and what is counted of stages, pixels and frames");
  command.add("STAGE", arguments->stage, "one stage alone");
  command.add_flag("--json", arguments->json, "print JSON, with the stages' groups and colours");
  command.footer(
      "Operations are counted by running a stage's scalar formulas on numbers that count.\n\nExample:\n"
      "  beampipe counters compose");
  command.set_work([arguments] { print_counters(*arguments); });
}

}  // namespace beampipe
