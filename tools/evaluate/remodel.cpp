#include "tools/evaluate/remodel.h"

#include "tools/evaluate/frame_json.h"
#include "tools/evaluate/memory_system.h"

namespace beampipe {
namespace {

const std::string kFile = "report.json";

}  // namespace

MemoryParameters memory_of(const Json& report, const std::string& file) {
  Json named = Json::object();
  MemoryParameters memory;
  for (const auto& [key, value] : report.at("memory_system").members())
    if (key != "modelled") named[key] = value;
  set_parameters(memory, JsonCursor(named, file));
  memory.modelled = report.at("memory_system").at("modelled").get<bool>();
  return memory;
}

namespace {

Hardware hardware_of(const Json& report) {
  Hardware hardware = parse_hardware(report.at("hardware"), kFile);
  hardware.named = report.at("hardware_named").get<std::string>();
  hardware.label = label_of(hardware.named);
  return hardware;
}

// The parameters that options of the run changed.
std::vector<std::string> changed_by_options(const MemoryParameters& described, const MemoryParameters& run) {
  std::vector<std::string> changed;
  while (const auto difference = find_difference(described, run, changed)) changed.push_back(difference->name);
  return changed;
}

}  // namespace

Report remodelled(const Json& json, const Hardware* other) {
  Report report;
  report.trace = json.at("trace").get<std::string>();
  report.made_by = json.value("made_by", Json());
  report.memory = memory_of(json, kFile);
  report.hardware = hardware_of(json);
  if (other) {
    const auto difference =
        find_difference(report.memory, other->memory, changed_by_options(report.hardware.memory, report.memory));
    if (difference)
      throw OtherMemory("counted with " + difference->name + " " + difference->first.dump() + ", and " + other->named +
                        " has " + difference->second.dump() + ": run it again with --hardware " + other->named);
    report.hardware = *other;
  }
  report.hardware.memory = report.memory;
  for (const Json& result : json.at("results").elements()) {
    TechniqueReport& technique = report.results.emplace_back();
    technique.technique = result.at("technique").get<std::string>();
    technique.pixels_on_chip = result.at("pixels_on_chip").get<bool>();
    for (const Json& frame : result.at("frames").elements()) technique.frames.push_back(frame_of(frame));
  }
  return report;
}

}  // namespace beampipe
