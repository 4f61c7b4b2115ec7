#include "tools/evaluate/hardware.h"

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string_view>

#include "stages/cost/counter_registry.h"
#include "tools/evaluate/hardware_text.h"
#include "traces/json_cursor.h"

namespace beampipe {
namespace {

// The clocks that a unit needs for the work of a stage.
using Clocks = std::function<double(const std::map<std::string, double>& rates, const StageCounters& stage)>;

double over(std::uint64_t work, double rate) { return static_cast<double>(work) / rate; }

const std::map<std::string, Clocks>& units() {
  using Rates = std::map<std::string, double>;
  static const std::map<std::string, Clocks> all = {
      {"triangles",
       [](const Rates& rates, const StageCounters& s) { return over(s.items_in, rates.at("triangles_per_clk")); }},
      {"raster",
       [](const Rates& rates, const StageCounters& s) { return over(s.items_out, rates.at("raster_pixels_per_clk")); }},
      {"conservative_raster",
       [](const Rates& rates, const StageCounters& s) {
         return over(s.lanes_used, rates.at("conservative_pixels_per_clk"));  // touched pixels, hidden ones included
       }},
      {"quads",
       [](const Rates& rates, const StageCounters& s) { return over(s.lanes_issued, 4 * rates.at("quads_per_clk")); }},
      {"shader",
       [](const Rates& rates, const StageCounters& s) {
         return std::max({over(s.ops.total(), rates.at("issue_per_clk")),
                          over(s.ops.mul_add, rates.at("mul_add_per_clk")) + over(s.ops.add, rates.at("add_per_clk")),
                          over(s.ops.bit, rates.at("bit_per_clk")), over(s.ops.fetch, rates.at("fetch_per_clk")),
                          over(s.ops.special, rates.at("special_per_clk")),
                          over(s.ops.convert, rates.at("convert_per_clk"))});
       }},
      {"rop_samples",
       [](const Rates& rates, const StageCounters& s) { return over(s.items_in, rates.at("rop_samples_per_clk")); }},
      {"rop_fragments",
       [](const Rates& rates, const StageCounters& s) { return over(s.items_in, rates.at("rop_fragments_per_clk")); }},
      {"l2", [](const Rates& rates, const StageCounters& s) { return over(s.l2_bytes, rates.at("l2_bytes_per_clk")); }},
      {"dram",
       [](const Rates& rates, const StageCounters& s) { return over(s.dram_bytes, rates.at("dram_bytes_per_clk")); }},
  };
  return all;
}

const std::initializer_list<std::string_view> kRates = {
    "triangles_per_clk",     "raster_pixels_per_clk", "conservative_pixels_per_clk",
    "quads_per_clk",         "issue_per_clk",         "mul_add_per_clk",
    "add_per_clk",           "bit_per_clk",           "fetch_per_clk",
    "special_per_clk",       "convert_per_clk",       "rop_samples_per_clk",
    "rop_fragments_per_clk", "l2_bytes_per_clk",      "dram_bytes_per_clk"};

double positive_number(const JsonCursor& at) { return at.number_between(0, std::numeric_limits<double>::infinity()); }

std::vector<std::string> read_units(const JsonCursor& stage) {
  std::vector<std::string> names;
  for (const JsonCursor& unit : stage.elements()) {
    names.push_back(unit.string());
    if (units().contains(names.back())) continue;
    std::string known;
    for (const auto& [name, clocks] : units()) known += (known.empty() ? "" : ", ") + name;
    unit.fail("one of the units " + known);
  }
  return names;
}

}  // namespace

Hardware titan_v() {
  const std::string file = "the built-in description";
  return parse_hardware(parse_json_text(kTitanVText, file), file);
}

Hardware read_hardware(const std::filesystem::path& file) {
  return parse_hardware(parse_json(file.string()), file.string());
}

Hardware parse_hardware(const Json& json, const std::string& file) {
  const JsonCursor root(json, file);
  root.expect_keys({"beampipe_hardware", "name", "clock_mhz", "rates", "sources", "implementations"});
  root["beampipe_hardware"].integer(1, 1);
  Hardware hardware;
  hardware.name = root["name"].string();
  hardware.clock_mhz = positive_number(root["clock_mhz"]);
  const JsonCursor rates = root["rates"];
  rates.expect_keys(kRates);
  for (const std::string_view rate : kRates) hardware.rates[std::string(rate)] = positive_number(rates[rate]);
  for (const auto& [name, description] : root["implementations"].members()) {
    Implementation& implementation = hardware.implementations.emplace_back(Implementation{name, {}});
    for (const auto& [stage, names] : description["units"].members()) implementation.units[stage] = read_units(names);
  }
  if (hardware.implementations.empty()) root["implementations"].fail("at least one implementation", "none");
  hardware.json = json;
  return hardware;
}

std::map<std::string, double> unit_times(const Hardware& hardware, const Implementation& implementation,
                                         const StageCounters& stage) {
  const double clocks_per_ms = hardware.clock_mhz * 1e3;
  std::map<std::string, double> times;
  const auto use = [&](const std::string& unit) {
    times[unit] = units().at(unit)(hardware.rates, stage) / clocks_per_ms;
  };
  if (const auto found = implementation.units.find(std::string(without_pass(stage.stage))); found != implementation.units.end())
    for (const std::string& unit : found->second) use(unit);
  use("l2");
  use("dram");
  return times;
}

ModelledTime modelled_time(const Hardware& hardware, const Implementation& implementation,
                           const std::vector<StageCounters>& stages) {
  ModelledTime time;
  std::map<std::string, double> busy;
  for (const StageCounters& stage : stages) {
    double longest = 0;
    for (const auto& [unit, ms] : unit_times(hardware, implementation, stage)) {
      busy[unit] += ms;
      longest = std::max(longest, ms);
    }
    time.stages.push_back(longest);
    time.sum_ms += longest;
  }
  for (const auto& [unit, ms] : busy) {
    if (ms < time.overlap_ms) continue;
    time.overlap_ms = ms;
    time.busiest = unit;
  }
  return time;
}

}  // namespace beampipe
