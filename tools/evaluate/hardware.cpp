#include "tools/evaluate/hardware.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <system_error>

#include "tools/evaluate/hardware_text.h"
#include "traces/closest_name.h"
#include "traces/files/input_file.h"

namespace beampipe {
namespace {

using Rates = std::map<std::string, double>;
using UnitsOfStages = decltype(Implementation::units);

struct StageWork : StageCounters {
  bool pixels_on_chip = false;  // the state of pixels that it reads and writes; otherwise it is in memory
};

// The clocks that a unit needs for the work of a stage.
using Clocks = std::function<double(const Rates& rates, const StageWork& stage)>;

constexpr double kProbeBytes = 16;  // a bilinear probe: four texels of 4 bytes

// Not a unit: it marks the stages that work on the pixels of a bin, which may be on chip.
constexpr const char* kOnChip = "on_chip";

double over(double work, double rate) { return work / rate; }

// Operations on 64-bit integers are in the integer lanes, and issued twice. All that a shader reads and writes, except
// for texels, passes its core's L1 or shared memory.
double shader_clocks(const Rates& rates, const StageWork& s) {
  const auto& ops = s.ops;
  const double wide = static_cast<double>(ops.wide), total = static_cast<double>(ops.total());
  const double mul_add = static_cast<double>(ops.mul_add), add = static_cast<double>(ops.add);
  const double narrow = mul_add + add > 0 ? std::max(1 - wide / (mul_add + add), 0.0) : 0;
  return std::max({over(total + wide, rates.at("issue_per_clk")),
                   narrow * (over(mul_add, rates.at("mul_add_per_clk")) + over(add, rates.at("add_per_clk"))),
                   over(ops.bit, rates.at("bit_per_clk")) + over(wide, rates.at("wide_per_clk")),
                   over(ops.fetch, rates.at("fetch_per_clk")), over(ops.special, rates.at("special_per_clk")),
                   over(ops.convert, rates.at("convert_per_clk")),
                   over(s.logical_bytes() - s.texture_bytes, rates.at("on_chip_bytes_per_clk"))});
}

// What is read and written where pixels are, by bytes of the formats: through the ROP's caches, or in the memory of the
// cores.
double pixel_clocks(const Rates& rates, const StageWork& s) {
  return over(s.logical_bytes(), rates.at(s.pixels_on_chip ? "on_chip_bytes_per_clk" : "rop_bytes_per_clk"));
}

const std::map<std::string, Clocks>& units() {
  static const std::map<std::string, Clocks> all = {
      {"triangles",
       [](const Rates& rates, const StageWork& s) { return over(s.items_in, rates.at("triangles_per_clk")); }},
      {"raster",
       [](const Rates& rates, const StageWork& s) { return over(s.items_out, rates.at("raster_pixels_per_clk")); }},
      {"conservative_raster",
       [](const Rates& rates, const StageWork& s) {
         return over(s.lanes_used, rates.at("conservative_pixels_per_clk"));  // touched pixels, hidden ones included
       }},
      {"quads",
       [](const Rates& rates, const StageWork& s) { return over(s.lanes_issued, 4 * rates.at("quads_per_clk")); }},
      {"shader", shader_clocks},
      {"shading", shader_clocks},
      {"texture",
       [](const Rates& rates, const StageWork& s) { return over(s.texture_bytes, rates.at("texture_bytes_per_clk")); }},
      {"mask_generator",
       [](const Rates& rates, const StageWork& s) {
         return std::max(over(s.items_in, rates.at("conservative_pixels_per_clk")),
                         over(s.position_tests, rates.at("mask_positions_per_clk")));
       }},
      {"sorter",
       [](const Rates& rates, const StageWork& s) {
         return std::max(over(s.items_in, rates.at("rop_fragments_per_clk")),
                         over(s.ops.total(), rates.at("sort_operations_per_clk")));
       }},
      {"composer",
       [](const Rates& rates, const StageWork& s) {
         return std::max({over(s.items_in, rates.at("rop_fragments_per_clk")),
                          over(s.position_tests, rates.at("compose_positions_per_clk")), pixel_clocks(rates, s)});
       }},
      {"rop_samples",
       [](const Rates& rates, const StageWork& s) {
         return std::max(over(s.items_in, rates.at("rop_samples_per_clk")), pixel_clocks(rates, s));
       }},
      {"rop_fragments",
       [](const Rates& rates, const StageWork& s) {
         return std::max(over(s.items_in, rates.at("rop_fragments_per_clk")), pixel_clocks(rates, s));
       }},
      {"l2", [](const Rates& rates, const StageWork& s) { return over(s.l2_bytes, rates.at("l2_bytes_per_clk")); }},
      {"dram",
       [](const Rates& rates, const StageWork& s) { return over(s.dram_bytes, rates.at("dram_bytes_per_clk")); }},
  };
  return all;
}

Form<ShadingCost> cost_form() {
  constexpr double kMost = 1e6;
  return ObjectForm<ShadingCost>()
      .required("operations", &ShadingCost::operations, form::number(0, kMost), "Multiplications and additions.")
      .required("fetches", &ShadingCost::fetches, form::number(0, kMost), "Bilinear probes of a texture.")
      .required("registers", &ShadingCost::registers, form::number(0, kMost),
                "Registers that an invocation takes; the fewer invocations fit, the slower they are.");
}

// Can the unit do the stage's work? The counters of other stages would say nothing to it. Textures and the rate of
// triangles and quads serve both kinds of stages.
bool can_do(const std::string& unit, const StageInfo& stage) {
  if (unit == "shader" || unit == "shading") return stage.can_be_shader;
  for (const char* const each :
       {"raster", "conservative_raster", "mask_generator", "sorter", "composer", "rop_samples", "rop_fragments"})
    if (unit == each) return stage.can_be_fixed_function;
  return true;
}

// Work of a stage with a mistyped name would cost nothing. A depth pre-pass runs on the units of the other pass.
Form<UnitsOfStages> units_form() {
  ObjectForm<UnitsOfStages> object("the name of a stage");
  for (const StageInfo& stage : stage_list()) {
    std::vector<std::string> names = {kOnChip};
    for (const auto& [name, clocks] : units())
      if (can_do(name, stage)) names.push_back(name);
    const Form<std::vector<std::string>> list = form::list(form::one_of(names));
    object.add({std::string(stage.name), "The units that it uses.", false, list.schema,
                [list, id = stage.id](const JsonCursor& at, UnitsOfStages& of) { of[id] = list(at); }});
  }
  return object;
}

Form<Implementation> implementation_form() {
  return ObjectForm<Implementation>()
      .add(form::unused<Implementation>("description", false, form::text(), "What it is, for people."))
      .required(
          "units", &Implementation::units, units_form(),
          "By the name of a stage (`beampipe counters`): its units. on_chip is no unit; it marks stages that work "
          "on what a bin has on chip.");
}

Form<Hardware> hardware_form() {
  constexpr double kLeast = 1e-6, kMost = 1e12;  // far beyond any rate, and near enough that no time becomes infinite
  const Form<double> rate = form::number(kLeast, kMost);
  std::vector<form::Key> sources = {{"clock_mhz", "Of the clock."}};
  for (const form::Key& each : hardware_rates()) sources.push_back({each.key, "Of this rate."});
  const Form<Hardware> shading = ObjectForm<Hardware>()
                                     .required("material", &Hardware::material, cost_form(), "Of materials.")
                                     .required("light", &Hardware::light, cost_form(), "Of lights.");
  return ObjectForm<Hardware>()
      .add(form::unused<Hardware>("beampipe_hardware", true, form::version(3), "The version of this format."))
      .required("name", &Hardware::name, form::text(), "What it is, for people.")
      .required("clock_mhz", &Hardware::clock_mhz, rate, "The clock, in MHz.")
      .required("rates", &Hardware::rates, form::record(hardware_rates(), true, rate), "What the units do per clock.")
      .add(form::unused<Hardware>(
          "sources", true, form::record(sources, true, form::text("where the number is from, or that it is a choice")),
          "Where each number is from, or that it is a choice, by its name."))
      .required("implementations", &Hardware::implementations,
                form::named(implementation_form(), &Implementation::name, "implementation"),
                "Ways to do the same work, by name: which units each stage uses. A stage that is not listed uses L2 "
                "and DRAM only, as all stages do.")
      .add({"shading", "What each invocation of a fragment shader costs beside what the materials of the trace cost.",
            false, shading.schema, shading.read});
}

// The counters of a stage that shades, with the costs that come to its materials' own. Lighting is a stage of its own
// in some techniques. `registers`: that an invocation takes.
StageCounters with_costs(const Hardware& hardware, const StageCounters& stage, bool has_light, double& registers) {
  StageCounters priced = stage;
  const auto add = [&](const ShadingCost& cost) {
    constexpr double kMostInvocations = 1e11;  // so that nothing overflows, whatever a damaged report says
    const double invocations = std::min(static_cast<double>(stage.lanes_issued), kMostInvocations);
    priced.ops.mul_add += static_cast<std::uint64_t>(invocations * cost.operations / 2);
    priced.ops.add += static_cast<std::uint64_t>(invocations * cost.operations / 2);
    const auto texels = static_cast<std::uint64_t>(invocations * cost.fetches * kProbeBytes);
    priced.bytes_read += texels;
    priced.texture_bytes += texels;
    registers = std::max(registers, cost.registers);
  };
  if (stage.stage.id == StageId::shade) add(hardware.material);
  if (stage.stage.id == StageId::light || (stage.stage.id == StageId::shade && !has_light)) add(hardware.light);
  return priced;
}

std::map<std::string, double> times_of(const Hardware& hardware, const Implementation& implementation,
                                       const StageCounters& unpriced, bool has_light, double bin_bytes) {
  double registers = 0;
  const StageWork stage{with_costs(hardware, unpriced, has_light, registers), bin_bytes > 0};
  const Rates& rates = hardware.rates;
  const double clocks_per_ms = hardware.clock_mhz * 1e3;
  std::map<std::string, double> times;
  const auto use = [&](const std::string& unit) { times[unit] = units().at(unit)(rates, stage) / clocks_per_ms; };
  bool on_chip = false;
  if (const auto found = implementation.units.find(stage.stage.id); found != implementation.units.end())
    for (const std::string& unit : found->second) unit == kOnChip ? static_cast<void>(on_chip = true) : use(unit);
  if (const auto shading = times.find("shading"); shading != times.end())
    shading->second *= std::max(1.0, registers / rates.at("registers_at_full_rate"));
  const double room = rates.at("on_chip_bytes_per_core"), wanted = rates.at("bins_per_core");
  if (on_chip && bin_bytes > 0) {
    const double held = std::clamp(std::floor(room / bin_bytes), 1.0, std::max(wanted, 1.0));
    for (auto& [unit, ms] : times) ms *= std::max(wanted / held, 1.0);
  }
  use("l2");
  use("dram");
  if (on_chip && bin_bytes > room)
    times["l2"] += over(stage.logical_bytes(), rates.at("l2_bytes_per_clk")) * (1 - room / bin_bytes) / clocks_per_ms;
  return times;
}

}  // namespace

std::vector<std::string> hardware_names() {
  std::vector<std::string> names;
  for (const BuiltInHardware& each : kBuiltInHardware) names.push_back(each.name);
  return names;
}

const std::vector<form::Key>& hardware_rates() {
  static const std::vector<form::Key> all = {
      {"triangles_per_clk", "Triangles that are set up."},
      {"raster_pixels_per_clk", "Pixels (or cells) that the sample raster finds."},
      {"conservative_pixels_per_clk", "Pixels that the conservative raster touches."},
      {"quads_per_clk", "2x2 quads of pixels that shading is started for."},
      {"issue_per_clk", "Operations that the shader cores issue, of any kind."},
      {"mul_add_per_clk", "Multiplications and additions of floats."},
      {"add_per_clk", "Additions and comparisons."},
      {"bit_per_clk", "Operations on 32-bit integers and bits."},
      {"wide_per_clk", "Operations on 64-bit integers."},
      {"fetch_per_clk", "Loads and stores of the shader cores."},
      {"special_per_clk", "Reciprocals, square roots and the like."},
      {"convert_per_clk", "Conversions between types."},
      {"texture_bytes_per_clk", "Bytes of texels that filters read."},
      {"registers_at_full_rate", "Registers that an invocation may take at full rate."},
      {"mask_positions_per_clk", "Positions times edges that the mask generator tests."},
      {"sort_operations_per_clk", "Comparisons of the sorter."},
      {"compose_positions_per_clk", "Positions at which the composer compares depths."},
      {"rop_samples_per_clk", "Depth samples that the ROPs test."},
      {"rop_fragments_per_clk", "Fragments that the ROPs blend."},
      {"rop_bytes_per_clk", "Bytes of pixels in memory that the ROPs read and write."},
      {"on_chip_bytes_per_clk", "Bytes of pixels on chip that are read and written."},
      {"l2_bytes_per_clk", "Bytes that L2 moves."},
      {"dram_bytes_per_clk", "Bytes that DRAM moves."},
      {"on_chip_bytes_per_core", "Bytes that a core has for the pixels of bins."},
      {"bins_per_core", "Bins that a core works on at a time."},
  };
  return all;
}

Hardware titan_v() { return read_hardware("titan_v"); }

Hardware read_hardware(const std::string& name_or_file) {
  if (name_or_file.empty()) throw std::runtime_error("--hardware: expected names or files, found an empty one");
  for (const BuiltInHardware& each : kBuiltInHardware) {
    if (name_or_file != each.name) continue;
    const std::string file = std::string("the built-in description ") + each.name;
    Hardware hardware = parse_hardware(parse_json_text(each.text, file), file);
    hardware.label = each.name;
    return hardware;
  }
  if (std::error_code error; !std::filesystem::exists(name_or_file, error)) {
    std::string names;
    for (const std::string& name : hardware_names()) names += (names.empty() ? "" : ", ") + name;
    fail_trace(name_or_file, "a readable file or one of " + names,
               "neither" + did_you_mean(name_or_file, hardware_names()));
  }
  Hardware hardware = parse_hardware(parse_json(name_or_file), name_or_file);
  hardware.label = std::filesystem::path(name_or_file).stem().string();
  return hardware;
}

std::vector<Hardware> read_hardware_list(const std::string& list) {
  std::vector<Hardware> all;
  for (std::size_t at = 0, comma; at <= list.size(); at = comma + 1) {
    comma = std::min(list.find(',', at), list.size());
    Hardware hardware = read_hardware(list.substr(at, comma - at));
    for (const Hardware& other : all)
      if (other.label == hardware.label)
        throw std::runtime_error("--hardware " + list + ": expected different names, found " + other.label + " twice");
    all.push_back(std::move(hardware));
  }
  return all;
}

Json hardware_schema() { return schema_file(hardware_form().schema, "beampipe hardware, version 3"); }

Hardware parse_hardware(const Json& json, const std::string& file) {
  Hardware hardware = hardware_form()(JsonCursor(json, file));
  hardware.json = json;
  return hardware;
}

Hardware with_shading_costs(const Hardware& hardware, const ShadingCost& material, const ShadingCost& light) {
  Hardware priced = hardware;
  priced.material = material;
  priced.light = light;
  const auto written = cost_form().write;
  priced.json["shading"] = {{"material", written(material)}, {"light", written(light)}};
  return priced;
}

std::map<std::string, double> unit_times(const Hardware& hardware, const Implementation& implementation,
                                         const StageCounters& stage, double bin_bytes) {
  return times_of(hardware, implementation, stage, false, bin_bytes);
}

ModelledTime modelled_time(const Hardware& hardware, const Implementation& implementation,
                           const std::vector<StageCounters>& stages, double bin_bytes) {
  const bool has_light =
      std::any_of(stages.begin(), stages.end(), [](const auto& s) { return s.stage.id == StageId::light; });
  ModelledTime time;
  std::map<std::string, double> busy;
  for (const StageCounters& stage : stages) {
    double longest = 0;
    std::map<std::string, double> of_stage = times_of(hardware, implementation, stage, has_light, bin_bytes);
    if (const auto shading = of_stage.extract("shading"))  // the same lanes
      of_stage["shader"] = std::max(of_stage["shader"], shading.mapped());
    for (const auto& [unit, ms] : of_stage) {
      busy[unit] += ms;
      longest = std::max(longest, ms);
    }
    time.stages.push_back({stage.stage, longest});
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
