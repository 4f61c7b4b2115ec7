#include "tools/evaluate/remodel.h"

#include "tools/evaluate/frame_json.h"

namespace beampipe {

Report remodelled(const Json& json, const std::vector<Hardware>& all) {
  Report report;
  report.trace = json.at("trace").get<std::string>();
  report.made_by = json.value("made_by", Json());
  report.memory.modelled = json.at("memory_system").at("modelled").get<bool>();
  report.hardware = all.front();
  report.more_hardware.assign(all.begin() + 1, all.end());
  for (const Json& result : json.at("results").elements()) {
    TechniqueReport& technique = report.results.emplace_back();
    technique.technique = result.at("technique").get<std::string>();
    for (const Json& frame : result.at("frames").elements()) technique.frames.push_back(frame_of(frame));
  }
  return report;
}

}  // namespace beampipe
