#include "tools/evaluate/hardware.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <stdexcept>

#include "tools/evaluate/hardware_text.h"
#include "traces/json.h"

namespace beampipe {
namespace {

// What a unit has to do for a stage, in clocks.
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
         return over(s.lanes_used, rates.at("conservative_pixels_per_clk"));  // touched, hidden ones too
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

constexpr const char* kRates[] = {"triangles_per_clk",     "raster_pixels_per_clk", "conservative_pixels_per_clk",
                                  "quads_per_clk",         "issue_per_clk",         "mul_add_per_clk",
                                  "add_per_clk",           "bit_per_clk",           "fetch_per_clk",
                                  "special_per_clk",       "convert_per_clk",       "rop_samples_per_clk",
                                  "rop_fragments_per_clk", "l2_bytes_per_clk",      "dram_bytes_per_clk"};

// Reads a file's values, naming the file and the key in what it throws.
class Reader {
 public:
  Reader(const Json& json, const std::string& file) : file_(file), json_(json) {
    if (!json_.is_object()) fail("", "expected an object");
  }

  Hardware read() {
    only(json_, "", {"beampipe_hardware", "name", "clock_mhz", "rates", "sources", "implementations"});
    if (number(json_, "", "beampipe_hardware") != 1) fail("beampipe_hardware", "expected version 1");
    Hardware hardware;
    const Json& name = at(json_, "", "name");
    if (!name.is_string()) fail("name", "expected text, found " + name.dump());
    hardware.name = name.get<std::string>();
    hardware.clock_mhz = number(json_, "", "clock_mhz");
    const Json& rates = object(json_, "", "rates");
    only(rates, "rates.", {std::begin(kRates), std::end(kRates)});
    for (const char* key : kRates) hardware.rates[key] = number(rates, "rates.", key);
    const Json& implementations = object(json_, "", "implementations");
    if (implementations.size() == 0) fail("implementations", "expected at least one");
    for (const auto& item : implementations.members())
      hardware.implementations.push_back(implementation(item.key, item.value));
    hardware.json = json_;
    return hardware;
  }

 private:
  Implementation implementation(const std::string& name, const Json& json) {
    const std::string prefix = "implementations." + name + ".";
    Implementation result{name, {}};
    const Json& stages = object(json, prefix, "units");
    for (const auto& stage : stages.members()) {
      const std::string key = prefix + "units." + stage.key;
      if (!stage.value.is_array()) fail(key, "expected an array of units, found " + stage.value.dump());
      for (const Json& unit : stage.value.elements()) {
        if (!unit.is_string() || !units().contains(unit.get<std::string>())) {
          std::string known;
          for (const auto& [known_unit, clocks] : units()) known += (known.empty() ? "" : ", ") + known_unit;
          fail(key, "expected units out of " + known + ", found " + unit.dump());
        }
        result.units[stage.key].push_back(unit.get<std::string>());
      }
    }
    return result;
  }

  const Json& at(const Json& json, const std::string& prefix, const std::string& key) const {
    if (!json.contains(key)) fail(prefix + key, "expected this key, found none");
    return json.at(key);
  }
  const Json& object(const Json& json, const std::string& prefix, const std::string& key) const {
    if (!json.is_object() || !at(json, prefix, key).is_object()) fail(prefix + key, "expected an object");
    return json.at(key);
  }
  double number(const Json& json, const std::string& prefix, const std::string& key) const {
    const Json& value = at(json, prefix, key);
    if (!value.is_number() || !(value.get<double>() > 0))
      fail(prefix + key, "expected a number above 0, found " + value.dump());
    return value.get<double>();
  }
  void only(const Json& json, const std::string& prefix, const std::vector<std::string>& keys) const {
    for (const auto& item : json.members())
      if (std::find(keys.begin(), keys.end(), item.key) == keys.end()) fail(prefix + item.key, "there is no such key");
  }
  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw std::runtime_error(file_ + ": " + (key.empty() ? "" : key + ": ") + what);
  }

  const std::string& file_;
  const Json& json_;
};

}  // namespace

Hardware titan_v() {
  return parse_hardware(parse_json_text(kTitanVText, "the built-in description"), "the built-in description");
}

Hardware read_hardware(const std::filesystem::path& file) {
  return parse_hardware(parse_json(file.string()), file.string());
}

Hardware parse_hardware(const Json& json, const std::string& file) { return Reader(json, file).read(); }

std::map<std::string, double> unit_times(const Hardware& hardware, const Implementation& implementation,
                                         const StageCounters& stage) {
  const double clocks_per_ms = hardware.clock_mhz * 1e3;
  std::map<std::string, double> times;
  const auto use = [&](const std::string& unit) {
    times[unit] = units().at(unit)(hardware.rates, stage) / clocks_per_ms;
  };
  if (const auto found = implementation.units.find(stage.stage); found != implementation.units.end())
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
