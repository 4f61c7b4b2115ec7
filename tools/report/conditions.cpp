#include "tools/report/conditions.h"

#include <algorithm>
#include <cstdio>
#include <set>

#include "tools/evaluate/hardware.h"

namespace beampipe {
namespace {

// "12 345": groups of three digits with narrow blanks between them.
std::string grouped(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, "\u202f");
  return text;
}

std::string counted(std::uint64_t number, const std::string& one) {
  return grouped(number) + " " + one + (number == 1 ? "" : "s");
}

std::string bytes_text(std::uint64_t bytes) {
  char text[32];
  if (bytes >= 1 << 20)
    std::snprintf(text, sizeof text, "%.4g MiB", static_cast<double>(bytes) / (1 << 20));
  else
    std::snprintf(text, sizeof text, "%.4g KiB", static_cast<double>(bytes) / (1 << 10));
  return text;
}

// The frames' numbers under a key: "3 draws", or "3 to 5 draws".
std::string range_of(const std::vector<Json>& frames, const char* key, const std::string& one) {
  std::set<std::uint64_t> values;
  for (const Json& frame : frames) values.insert(frame.at(key).get<std::uint64_t>());
  if (values.size() == 1) return counted(*values.begin(), one);
  return grouped(*values.begin()) + " to " + grouped(*values.rbegin()) + " " + one + "s";
}

std::string picture_text(const std::vector<Json>& frames, std::uint64_t all) {
  std::vector<std::string> sizes;
  for (const Json& frame : frames) {
    const std::string size = frame.at("width").dump() + " × " + frame.at("height").dump();
    if (std::find(sizes.begin(), sizes.end(), size) == sizes.end()) sizes.push_back(size);
  }
  std::string text;
  for (const std::string& size : sizes) text += (text.empty() ? "" : ", ") + size;
  text += " pixels, " + counted(frames.size(), "frame");
  return all > frames.size() ? text + " of " + grouped(all) : text;
}

// "ours (Our part, 1455 MHz)"
std::string hardware_text(const Json& report) {
  const Json& hardware = report.at("hardware");
  return label_of(report.value("hardware_named", std::string("unnamed"))) + " (" +
         hardware.at("name").get<std::string>() + ", " + hardware.at("clock_mhz").dump() + " MHz)";
}

std::string memory_text(const Json& memory) {
  if (!memory.at("modelled").get<bool>()) return "not modelled";
  const auto size = [&](const char* key) { return bytes_text(memory.at(key).get<std::uint64_t>()); };
  const std::string side = memory.at("bin_pixels").dump();
  return "L2 " + size("l2_bytes") + ", L1 " + size("l1_bytes") + ", ROP caches " + size("rop_bytes") + ", sectors of " +
         memory.at("sector_bytes").dump() + " bytes, compression " +
         (memory.at("compression").get<bool>() ? "on" : "off") + ", bins of at most " + side + " × " + side +
         " pixels, " + memory.at("cores").dump() + " cores, each with " + size("on_chip_bytes") +
         " on chip for the pixels of " + memory.at("bins_per_core").dump() +
         " bins of 32 × 32 pixels, or of more smaller ones" +
         (memory.value("binned", true) ? "" : "; nothing is binned");
}

// What its invocations of fragment shaders cost beside what the trace's materials cost; empty if nothing.
std::string shading_text(const Json& hardware) {
  const Json* const shading = hardware.find("shading");
  if (!shading) return "";
  const auto cost = [&](const char* of) {
    return shading->at(of).at("operations").dump() + " operations and " + shading->at(of).at("fetches").dump() +
           " fetches";
  };
  return cost("material") + " per invocation for materials, " + cost("light") +
         " for lights, beside what the trace's own take";
}

}  // namespace

Json report_conditions(const ReportFile& report) {
  Json conditions = Json::array();
  const auto add = [&](const std::string& name, const std::string& text) {
    if (!text.empty()) conditions.push_back(Json::array({name, text}));
  };
  if (const Json* const frames = report.json.find("frames"); frames && frames->size() > 0) {
    const std::vector<Json>& all = frames->elements();
    add("picture", picture_text(all, report.json.at("trace_frames").get<std::uint64_t>()));
    add("scene", range_of(all, "triangles", "triangle") + ", " + range_of(all, "draws", "draw") + ", " +
                     range_of(all, "lights", "light"));
  }
  add("trace", report.json.at("trace").get<std::string>());
  add("command", report.json.value("command_line", std::string()));
  if (const Json* const hardware = report.json.find("hardware")) {
    add("hardware", hardware_text(report.json));
    add("shading", shading_text(*hardware));
  }
  if (const Json* const memory = report.json.find("memory_system")) add("memory system", memory_text(*memory));
  add("program", "beampipe " + report.json.value("version", std::string()) + ", " +
                     counted(report.json.value("threads", std::uint64_t{1}), "thread") + ", " +
                     report.json.value("simd", std::string()));
  const Json notes = report.json.value("notes", Json::array());
  for (const Json& note : notes.elements())
    add(note.at("left_out").get<bool>() ? "left out" : "drawn otherwise",
        note.at("reason").get<std::string>() + ": " + counted(note.at("draws").get<std::uint64_t>(), "draw") + ", " +
            counted(note.at("triangles").get<std::uint64_t>(), "triangle") +
            (note.contains("invocations") ? ", " + counted(note.at("invocations").get<std::uint64_t>(), "invocation")
                                          : ""));
  return conditions;
}

}  // namespace beampipe
