#include "tools/report/page.h"

#include "pipeline/technique.h"
#include "tools/evaluate/hardware.h"
#include "tools/evaluate/results.h"
#include "tools/files/shell_word.h"
#include "tools/report/cards.h"
#include "tools/report/conditions.h"
#include "tools/report/page_files.h"

namespace beampipe {
namespace {

Json to_json(const Table& table) {
  Json json = {{"name", table.name},
               {"title", table.title},
               {"note", table.note},
               {"columns", Json::array()},
               {"rows", table.rows}};
  for (const Column& column : table.columns) {
    json["columns"].push_back({{"key", column.key},
                               {"title", column.title},
                               {"unit", column.unit},
                               {"definition", column.definition},
                               {"view", column.view}});
  }
  return json;
}

// The techniques whose pixels `beampipe inspect` can explain. Those of another version may be unknown.
Json inspectable(const ReportFile& report) {
  Json specs = Json::array();
  for (const TechniqueSummary& summary : report.techniques) try {
      if (parse_technique(summary.spec).is_observable) specs.push_back(summary.spec);
    } catch (const SpecError&) {
    }
  return specs;
}

// Replaces {{name}}, which stands in the page once, by the text.
std::string fill(std::string page, const std::string& name, const std::string& text) {
  const std::string place = "{{" + name + "}}";
  return page.replace(page.find(place), place.size(), text);
}

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  return out;
}

// JSON inside <script> must contain nothing that looks like a tag.
std::string script_json(const Json& json) {
  std::string text;
  for (const char c : json.dump()) {
    text += c == '<' ? "\\u003c" : std::string(1, c);
  }
  return text;
}

// The description, to be saved under its name; null if there is none.
Json hardware_file(const ReportFile& report) {
  const Json* const hardware = report.json.find("hardware");
  if (!hardware) return nullptr;
  const std::string label = label_of(report.json.value("hardware_named", std::string("hardware")));
  return {{"file", label + ".json"}, {"text", hardware->dump(2)}};
}

template <class Item>
Json to_json(const std::vector<Item>& items) {
  Json json = Json::array();
  for (const Item& item : items) json.push_back(to_json(item));
  return json;
}

// `name`: of what the page is about.
std::string filled_page(const std::string& name, const Json& data) {
  std::string page = fill(kPageHtml, "css", kPageCss);
  page = fill(page, "d3", kD3);
  page = fill(page, "scripts", kPageScripts);
  page = fill(page, "data", script_json(data));
  // The page may contain the same characters again, but only later.
  return fill(page, "title", html_text(name) + " · beampipe report");
}

}  // namespace

std::string page_html(const ReportFile& report, const std::vector<Table>& tables, const std::vector<Figure>& figures,
                      const Json& layers, std::size_t shown, const Json& inspections) {
  const Json data = {{"scene", report.scene},
                     {"trace", short_shell_word(report.json.at("trace").get<std::string>())},
                     {"frames", report.json.at("results").at(0).at("frames").size()},
                     {"shown", shown},
                     {"conditions", report_conditions(report)},
                     {"hardware", hardware_file(report)},
                     {"summary", report_cards(report)},
                     {"layers", layers},
                     {"inspections", inspections},
                     {"inspectable", inspectable(report)},
                     {"tables", to_json(tables)},
                     {"figures", to_json(figures)}};
  return filled_page(report.scene, data);
}

std::string overview_html(const Overview& overview, const std::string& command) {
  const std::string name = "Overview of " + std::to_string(overview.runs.rows.size()) + " runs";
  const Json conditions =
      Json::array({Json::array({"command", command}), Json::array({"program", "beampipe " + program_version()})});
  return filled_page(name, {{"scene", name},
                            {"conditions", conditions},
                            {"summary", {{"cards", Json::array()}}},
                            {"runs", to_json(overview.runs)},
                            {"tables", to_json(overview.measures)},
                            {"figures", to_json(overview.figures)}});
}

}  // namespace beampipe
