// What tests do with reports: read report.json, change frames, which a report only adds, and model no energy.
#pragma once

#include <cstddef>
#include <string>

#include "tools/evaluate/hardware.h"
#include "tools/report/report_json.h"
#include "traces/files/json.h"

namespace beampipe {

inline std::string report_text(const Report& report) {
  std::string text;
  write_json(report, [&](std::string_view part) { text += part; });
  return text;
}

inline Json report_json(const Report& report) { return parse_json_text(report_text(report), "report.json"); }

// change(frame, i) for each frame i of a result.
template <class Change>
void change_frames(TechniqueReport& result, const Change& change) {
  FrameReports changed;
  for (std::size_t i = 0; i < result.frames.size(); ++i) {
    FrameReport frame = result.frames[i];
    change(frame, i);
    changed.push_back(frame);
  }
  result.frames = changed;
}

// The description of a Titan V as it may be, too.
inline Json titan_without_energy() {
  const Json whole = titan_v().json;
  Json json = Json::object();
  for (const auto& [key, value] : whole.members())
    if (key != "energy") json[key] = value;
  return json;
}

}  // namespace beampipe
