#include "tools/report/inspections.h"

#include "tools/evaluate/results.h"
#include "tools/inspect/recorded.h"

namespace beampipe {

Json report_inspections(const ReportFile& report) {
  Json list = Json::array();
  for (const Json& result : report.json.at("results").elements()) {
    if (!result.contains("inspections")) continue;
    const std::string spec = result.at("technique").get<std::string>();
    const std::filesystem::path file = result.at("inspections").get<std::string>();
    if (file != std::filesystem::path(spec_folder(spec)) / kInspectionsFile)
      throw ReportError((report.folder / "report.json").string() + ": expected the inspections of " + in_quotes(spec) +
                        " in " + in_quotes(spec_folder(spec) + "/" + kInspectionsFile) + ", found " +
                        in_quotes(file.string()));
    const Json recorded = parse_json((report.folder / file).string());
    for (const Json& pixel : recorded.at("pixels").elements())
      list.push_back({{"technique", pixel.at("technique").get<std::string>()},
                      {"frame", pixel.at("frame").get<std::uint64_t>()},
                      {"x", pixel.at("x").get<std::uint64_t>()},
                      {"y", pixel.at("y").get<std::uint64_t>()},
                      {"error", pixel.at("error").get<double>()},
                      {"causes", pixel.at("cause_shares").get<std::string>()},
                      {"svg", pixel.at("svg").get<std::string>()},
                      {"text", pixel.at("text").get<std::string>()}});
  }
  return list;
}

}  // namespace beampipe
