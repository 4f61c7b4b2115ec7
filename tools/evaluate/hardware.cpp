#include "tools/evaluate/hardware.h"

#include <algorithm>
#include <stdexcept>
#include <system_error>

#include "tools/evaluate/hardware_text.h"
#include "tools/evaluate/hardware_units.h"
#include "tools/evaluate/memory_system.h"
#include "traces/closest_name.h"
#include "traces/files/input_file.h"

namespace beampipe {
namespace {

using UnitsOfStages = decltype(Implementation::units);

constexpr const char* kSource = "where the number is from, or that it is a choice";

Form<ShadingCost> cost_form() {
  constexpr double kMost = 1e6;
  return ObjectForm<ShadingCost>()
      .required("operations", &ShadingCost::operations, form::number(0, kMost), "Multiplications and additions.")
      .required("fetches", &ShadingCost::fetches, form::number(0, kMost), "Bilinear probes of a texture.")
      .required("registers", &ShadingCost::registers, form::number(0, kMost),
                "Registers that an invocation takes; the fewer fit, the less latency they hide.");
}

// May the stage name the unit? The counters of other stages would say nothing to it.
bool can_do(HardwareUnit::Kind unit, const StageInfo& stage) {
  switch (unit) {
    case HardwareUnit::Kind::fixed_function:
      return stage.can_be_fixed_function;
    case HardwareUnit::Kind::shader:
      return stage.can_be_shader;
    case HardwareUnit::Kind::beside:
      return true;
    case HardwareUnit::Kind::implied:
      break;
  }
  return false;
}

bool does_work(HardwareUnit::Kind kind) {
  return kind == HardwareUnit::Kind::fixed_function || kind == HardwareUnit::Kind::shader;
}

// The name of a unit that the stage may name. If it does work of the other kind, an error says so.
Form<std::string> unit_form(const StageInfo& stage, const std::vector<std::string>& names) {
  Form<std::string> unit = form::one_of(names);
  std::vector<std::string> others;
  for (const HardwareUnit& each : hardware_units())
    if (does_work(each.kind) && !can_do(each.kind, stage)) others.emplace_back(each.name);
  unit.read = [read = unit.read, others, stage = std::string(stage.name),
               kind = stage.can_be_shader ? "shaders" : "fixed functions"](const JsonCursor& at, std::string& value) {
    if (at.is_string() && std::ranges::count(others, at.string()) > 0)
      at.fail(std::string("a unit of ") + kind + ", in which alone " + stage + " is modelled (`beampipe counters " +
              stage + "`)");
    read(at, value);
  };
  return unit;
}

// Work of a stage without units would cost nothing, and so would that of a mistyped name. A depth pre-pass runs on the
// units of the other pass. The reference is no pipeline of a GPU.
Form<UnitsOfStages> units_form() {
  ObjectForm<UnitsOfStages> object("the name of a stage");
  for (const StageInfo& stage : stage_list()) {
    if (!stage.can_be_fixed_function && !stage.can_be_shader) continue;
    std::vector<std::string> names;
    for (const HardwareUnit& unit : hardware_units())
      if (can_do(unit.kind, stage)) names.emplace_back(unit.name);
    const Form<std::vector<std::string>> list = form::list(unit_form(stage, names), "unit");
    object.add(
        {std::string(stage.name), "The units that it uses.", true, list.schema,
         [list, id = stage.id](const JsonCursor& at, UnitsOfStages& of) {
           list.read(at, of[id]);
           if (std::ranges::none_of(of[id], [](const std::string& unit) { return does_work(info_of_unit(unit).kind); }))
             at.fail("a unit that does the work of the stage");
         }});
  }
  return object;
}

Form<Implementation> implementation_form() {
  return ObjectForm<Implementation>()
      .add(form::unused<Implementation>("description", false, form::text(), "What it is, for people."))
      .required("units", &Implementation::units, units_form(),
                "By the name of a stage (`beampipe counters`): its units.");
}

Form<RateRange> range_form(const Form<double>& number) {
  return {form::array_schema(number.schema, 2), [number](const JsonCursor& at, RateRange& range) {
            if (at.elements().size() != 2) at.fail("two numbers, the lowest and the highest");
            range = {number(at.elements()[0]), number(at.elements()[1])};
          }};
}

Form<std::map<std::string, RateRange>> energy_form() {
  constexpr double kMostEnergy = 1e6;
  using Energies = std::map<std::string, RateRange>;
  return ObjectForm<Energies>()
      .required("picojoules", std::identity(),
                form::record(hardware_energies(), true, range_form(form::number(kLeastRate, kMostEnergy))),
                "[lowest, highest] of each operation and byte.")
      .add(form::unused<Energies>("sources", true, form::record(hardware_energies(), true, form::text(kSource)),
                                  "Where each of these is from, or that it is a choice, by its name."))
      .check([](const JsonCursor& at, const Energies& energies) {
        for (const auto& [name, range] : energies)
          if (range.low > range.high)
            at["picojoules"][name].fail("the lowest before the highest",
                                        Json(range.low).dump() + " to " + Json(range.high).dump());
      });
}

// The rates lie in their ranges, and what depends on another number fits to it.
void expect_consistent(const JsonCursor& at, const Hardware& hardware) {
  if (const auto conflict = find_conflict(hardware)) at["rates"][conflict->rate].fail(conflict->expected);
  for (const auto& [name, range] : hardware.ranges) {
    const double rate = hardware.rates.at(name);
    if (!(range.low <= rate && rate <= range.high))
      at["ranges"][name].fail("a range around the rate of " + Json(rate).dump(),
                              Json(range.low).dump() + " to " + Json(range.high).dump());
  }
}

Form<Hardware> hardware_form() {
  const Form<double> rate = form::number(kLeastRate, kMostRate);
  std::vector<form::Key> sources = {{"clock_mhz", "Of the clock."}};
  for (const form::Key& each : hardware_rates()) sources.push_back({each.key, "Of this rate."});
  const Form<Hardware> shading = ObjectForm<Hardware>()
                                     .required("material", &Hardware::material, cost_form(), "Of materials.")
                                     .required("light", &Hardware::light, cost_form(), "Of lights.");
  return ObjectForm<Hardware>()
      .add(form::unused<Hardware>("beampipe_hardware", true, form::version(5), "The version of this format."))
      .required("name", &Hardware::name, form::text(), "What it is, for people.")
      .required("clock_mhz", &Hardware::clock_mhz, form::number(1, 100'000), "The clock, in MHz.")
      .required("memory_system", &Hardware::memory, memory_system_form(),
                "Caches, memory on chip and cores, as far as they differ from those of a Titan V.")
      .required("rates", &Hardware::rates, form::record(hardware_rates(), true, rate), "What the units do per clock.")
      .optional("ranges", &Hardware::ranges, form::record(hardware_rates(), false, range_form(rate)),
                "Where a rate lies, [lowest, highest], as far as its source tells. Others are taken as exact.")
      .add(form::unused<Hardware>("sources", true, form::record(sources, true, form::text(kSource)),
                                  "Where each number is from, or that it is a choice, by its name."))
      .optional("energy", &Hardware::picojoules, energy_form(),
                "What operations and bytes take. Without it no energy is modelled.")
      .required("implementations", &Hardware::implementations,
                form::named(implementation_form(), &Implementation::name, "implementation"),
                "Ways to do the same work, by name: which units each stage uses beside L2 and DRAM.")
      .add({"shading", "What each invocation of a fragment shader costs beside what the materials of the trace cost.",
            false, shading.schema, shading.read})
      .check(expect_consistent);
}

}  // namespace

std::vector<std::string> hardware_names() {
  std::vector<std::string> names;
  for (const BuiltInHardware& each : kBuiltInHardware) names.push_back(each.name);
  return names;
}

std::optional<RateConflict> find_conflict(const Hardware& hardware) {
  const auto rate = [&](const char* name) { return hardware.rates.at(name); };
  if (rate(kDramEfficiency) > 1) return RateConflict{kDramEfficiency, "a number up to 1"};
  if (rate("core_threads") < 1) return RateConflict{"core_threads", "at least 1"};
  if (rate("dram_clocks") < rate("l2_clocks"))
    return RateConflict{"dram_clocks", "at least the l2_clocks of " + Json(rate("l2_clocks")).dump()};
  const double registers = std::max(hardware.material.registers, hardware.light.registers);
  if (rate("core_registers") < registers)
    return RateConflict{"core_registers", "at least the " + Json(registers).dump() + " of an invocation"};
  return std::nullopt;
}

const std::vector<form::Key>& hardware_rates() {
  static const std::vector<form::Key> all = {
      {"triangles_per_clk", "Triangles that are set up; and, in their bins, rasterized."},
      {"raster_pixels_per_clk", "Pixels (or cells) that the sample raster finds."},
      {"conservative_pixels_per_clk", "Pixels that the conservative raster touches."},
      {"quads_per_clk", "2x2 quads of pixels that shading is started for."},
      {"export_bytes_per_clk", "Bytes of shaded colours that the cores hand on and the ROPs take."},
      {"core_issue_per_clk", "Operations that a core issues, of any kind."},
      {"core_mul_add_per_clk", "Multiplications and additions of floats in a core."},
      {"core_add_per_clk", "Additions and comparisons in a core."},
      {"core_bit_per_clk", "Operations on 32-bit integers and bits in a core."},
      {"core_wide_per_clk", "Operations on 64-bit integers in a core."},
      {"core_fetch_per_clk", "Loads and stores of a core."},
      {"core_special_per_clk", "Reciprocals, square roots and the like in a core."},
      {"core_convert_per_clk", "Conversions between types in a core."},
      {"core_texture_bytes_per_clk", "Bytes of texels that the filters of a core read."},
      {"core_on_chip_bytes_per_clk", "Bytes of a core's memory on chip that are read and written."},
      {"core_threads", "Threads that a core keeps in flight, at least 1."},
      {"core_registers", "Registers of a core, which its threads share."},
      {"operation_clocks", "Clocks from an operation to the next one of its thread."},
      {"fetch_clocks", "Clocks that a thread waits for a load that L1 holds."},
      {"l2_clocks", "Clocks that four threads wait for a sector that L2 holds."},
      {"dram_clocks", "Clocks that they wait for one from DRAM, at least l2_clocks."},
      {"mask_positions_per_clk", "Positions times edges that the mask generator tests."},
      {"sort_operations_per_clk", "Comparisons of the sorter."},
      {"compose_positions_per_clk", "Positions at which the composer compares depths."},
      {"rop_samples_per_clk", "Depth samples that the ROPs test."},
      {"rop_fragments_per_clk", "Fragments that the ROPs blend."},
      {"rop_bytes_per_clk", "Bytes of pixels in memory that the ROPs read and write."},
      {"l2_bytes_per_clk", "Bytes that L2 moves."},
      {"dram_bytes_per_clk", "Bytes that DRAM moves at its peak."},
      {kDramEfficiency, "The part of the peak that requests reach, up to 1."},
  };
  return all;
}

const std::vector<form::Key>& hardware_energies() {
  static const std::vector<form::Key> all = {
      {"mul_add", "A multiplication."},
      {"add", "An addition or comparison."},
      {"bit", "An operation on bits."},
      {"fetch", "A look-up in a table."},
      {"special", "A division, square root or the like."},
      {"convert", "A conversion between types."},
      {"wide", "What an operation on 64-bit integers takes more than one on 32 bits."},
      {"instruction", "What an instruction takes in a lane of the shader cores beside its arithmetic."},
      {"on_chip_byte",
       "A byte in the memory next to the units: registers, queues, pixels on chip, L1, caches of ROPs."},
      {"texture_byte", "A byte of a texel that a filter reads, and its part of the filter."},
      {"l2_byte", "A byte of L2."},
      {"dram_byte", "A byte of DRAM."},
  };
  return all;
}

std::string label_of(const std::string& named) { return std::filesystem::path(named).stem().string(); }

Hardware titan_v() { return read_hardware("titan_v"); }

Hardware read_hardware(const std::string& name_or_file) {
  if (name_or_file.empty()) throw std::runtime_error("--hardware: expected names or files, found an empty one");
  for (const BuiltInHardware& each : kBuiltInHardware) {
    if (name_or_file != each.name) continue;
    const std::string file = std::string("the built-in description ") + each.name;
    Hardware hardware = parse_hardware(parse_json_text(each.text, file), file);
    hardware.named = hardware.label = each.name;
    return hardware;
  }
  if (std::error_code error; !std::filesystem::exists(name_or_file, error)) {
    std::string names;
    for (const std::string& name : hardware_names()) names += (names.empty() ? "" : ", ") + name;
    fail_trace(name_or_file, "a readable file or one of " + names,
               "neither" + did_you_mean(name_or_file, hardware_names()));
  }
  Hardware hardware = parse_hardware(parse_json(name_or_file), name_or_file);
  hardware.named = name_or_file;
  hardware.label = label_of(name_or_file);
  return hardware;
}

Json hardware_schema() { return schema_file(hardware_form().schema, "beampipe hardware, version 5"); }

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

}  // namespace beampipe
