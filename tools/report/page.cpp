#include "tools/report/page.h"

#include "tools/report/page_files.h"

namespace beampipe {
namespace {

Json to_json(const Table& table) {
  Json json = {{"name", table.name}, {"title", table.title}, {"columns", Json::array()}, {"rows", table.rows}};
  for (const Column& column : table.columns) {
    json["columns"].push_back(
        {{"key", column.key}, {"title", column.title}, {"unit", column.unit}, {"definition", column.definition}});
  }
  return json;
}

// Replaces {{name}}, which stands in the page once, by the text.
std::string fill(std::string page, const std::string& name, const std::string& text) {
  const std::string place = "{{" + name + "}}";
  return page.replace(page.find(place), place.size(), text);
}

std::string escaped(const std::string& text) {
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

}  // namespace

std::string page_html(const ReportFile& report, const std::vector<Table>& tables, const std::vector<Figure>& figures,
                      const Json& layers, const Json& inspections) {
  const Json& results = report.json.at("results");
  Json data = {{"scene", report.scene},
               {"layers", layers},
               {"inspections", inspections},
               {"colors", std::vector(kPlotColors.begin(), kPlotColors.end())}};
  data["facts"] = {{"trace", report.json.at("trace")},
                   {"frames", std::to_string(results.at(0).at("frames").size())},
                   {"techniques", std::to_string(results.size())},
                   {"program", "beampipe " + report.json.value("version", std::string())},
                   {"threads", std::to_string(report.json.value("threads", 1))},
                   {"SIMD target", report.json.value("simd", std::string())}};
  data["tables"] = Json::array();
  for (const Table& table : tables) data["tables"].push_back(to_json(table));
  data["figures"] = Json::array();
  for (const Figure& figure : figures) data["figures"].push_back(beampipe::to_json(figure));
  std::string page = fill(kPageHtml, "css", kPageCss);
  page = fill(page, "d3", kD3);
  page = fill(page, "scripts", kPageScripts);
  page = fill(page, "data", script_json(data));
  return fill(
      page, "title",
      escaped(report.scene) + " · beampipe report");  // the page may contain the same characters again, but only later
}

}  // namespace beampipe
