#include "tools/sweep/sweep_plan.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <limits>
#include <map>

#include "pipeline/technique.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/memory_system.h"
#include "traces/files/json_form.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

constexpr const char *kTraces = "traces", *kTechniques = "techniques", *kSizes = "sizes", *kHardware = "hardware",
                     *kImplementations = "implementations", *kMemorySystem = "memory_system";
constexpr const char* kClock = "clock_mhz";  // is varied like a rate
constexpr const char *kTableRows = "rows of the table", *kKinds = "kinds of hardware";
constexpr std::uint32_t kMostPixels = 16384;

Form<double> rate_form() { return form::number(kLeastRate, kMostRate); }

// The values of one axis, where they stand in the file.
using Axes = std::map<std::string, std::vector<JsonCursor>>;

// What a file says.
struct PlanFile {
  bool errors = false;
  std::vector<std::uint32_t> frames;
  Axes axes;
  std::vector<Axes> points;
};

// A list of values, which are read where they are needed. `axes`: where it goes in a T.
template <class T, class Place>
void add_axis(ObjectForm<T>& grid, Place axes, const std::string& name, const std::string& meaning, const Json& value) {
  grid.add({name,
            meaning,
            false,
            {{"type", "array"}, {"minItems", 1}, {"items", value}},
            [axes, name](const JsonCursor& at, T& object) {
              std::invoke(axes, object)[name] = at.elements();
              if (at.elements().empty()) at.fail("at least one value", "none");
            }});
}

template <class T, class Place>
void add_axes(ObjectForm<T>& grid, Place axes) {
  const Json text = form::text().schema, rate = rate_form().schema;
  const auto add = [&](const std::string& name, const std::string& meaning, const Json& value) {
    add_axis(grid, axes, name, meaning, value);
  };
  add(kTraces, "Files, relative to the plan's folder.", text);
  add(kTechniques, "Specs, as `beampipe run -t` takes them.", text);
  add(kSizes, "Sizes of the picture, WIDTHxHEIGHT. Default: each trace's own.", text);
  add(kHardware, "Built-in names, or files. Default: titan_v.", text);
  add(kImplementations, "Names in the descriptions of hardware. Default: all.", text);
  const std::string of_hardware = std::string(kHardware) + ".", of_memory = std::string(kMemorySystem) + ".";
  add(of_hardware + kClock, "Replaces the hardware's clock, in MHz.", rate);
  for (const auto& [name, meaning] : hardware_rates()) add(of_hardware + name, "Replaces the rate: " + meaning, rate);
  for (const MemoryParameter& parameter : memory_parameters())
    add(of_memory + parameter.key, "Replaces the parameter: " + parameter.meaning + ".", parameter.schema);
}

void expect_rising(const JsonCursor& root, const PlanFile& plan) {
  for (std::size_t i = 1; i < plan.frames.size(); ++i)
    if (plan.frames[i] <= plan.frames[i - 1])
      root["frames"].elements()[i].fail("a larger number than the one before it");
}

Form<PlanFile> plan_form() {
  constexpr const char* kKeys = "one of the keys of a grid (beampipe sweep --help)";
  ObjectForm<PlanFile> plan(kKeys);
  ObjectForm<Axes> point(kKeys);
  add_axes(point, std::identity());
  const Form<std::vector<Axes>> points = form::list(Form<Axes>(point), "point");
  plan.add(form::unused<PlanFile>("beampipe_sweep", true, form::version(1), "The version of this format."))
      .optional("errors", &PlanFile::errors, form::boolean(),
                "Whether pictures are compared with the reference, for rmse and emr.")
      .optional("frames", &PlanFile::frames,
                form::list(form::integer(0, std::numeric_limits<std::int32_t>::max()), "frame"),
                "The frames to render, rising. Default: all of each trace.")
      .add({"points", "Small grids in place of the one, which take the axes that they do not have from it.", false,
            points.schema, [points](const JsonCursor& at, PlanFile& file) { points.read(at, file.points); }});
  add_axes(plan, &PlanFile::axes);
  return plan.check(expect_rising);
}

// The index of a value in a list to which it is added if it is new.
template <class Value>
std::size_t index_in(std::vector<Value>& list, const Value& value) {
  const auto found = std::find(list.begin(), list.end(), value);
  if (found != list.end()) return static_cast<std::size_t>(found - list.begin());
  list.push_back(value);
  return list.size() - 1;
}

PictureSize read_size(const JsonCursor& at) {
  const std::string text = at.string();
  PictureSize size;
  const char* const end = text.data() + text.size();
  auto parsed = std::from_chars(text.data(), end, size.width);
  const bool has_times = parsed.ec == std::errc() && parsed.ptr != end && *parsed.ptr == 'x';
  if (has_times) parsed = std::from_chars(parsed.ptr + 1, end, size.height);
  const auto is_side = [](std::uint32_t side) { return side > 0 && side <= kMostPixels; };
  if (!has_times || parsed.ec != std::errc() || parsed.ptr != end || !is_side(size.width) || !is_side(size.height))
    at.fail("WIDTHxHEIGHT, each from 1 to 16384, such as \"320x180\"");
  return size;
}

std::string beside(const std::string& plan, const std::string& name) {
  return (fs::path(plan).parent_path() / name).lexically_normal().string();
}

[[noreturn]] void fail_limit(const JsonCursor& grid, std::uint64_t most, const char* what) {
  grid.fail("at most " + std::to_string(most) + " " + what, "more");
}

// Throws if the axes whose names start with a prefix have more combinations than that.
void limit_combinations(const Axes& axes, const std::string& prefix, std::uint64_t most, const JsonCursor& grid,
                        const char* what) {
  std::uint64_t count = 1;
  for (const auto& [name, values] : axes) {
    if (!name.starts_with(prefix)) continue;
    if (count > most / values.size()) fail_limit(grid, most, what);
    count *= values.size();
  }
}

// Calls visit(values) for every combination of the axes with this prefix: one value for each name without the prefix.
// The last axis changes fastest.
template <class Visit>
void each_combination(const Axes& axes, const std::string& prefix, Visit&& visit) {
  std::vector<const Axes::value_type*> varied;
  for (const Axes::value_type& axis : axes)
    if (axis.first.starts_with(prefix)) varied.push_back(&axis);
  std::vector<std::size_t> at(varied.size());
  for (;;) {
    std::vector<std::pair<std::string, JsonCursor>> values;
    for (std::size_t i = 0; i < varied.size(); ++i)
      values.emplace_back(varied[i]->first.substr(prefix.size()), varied[i]->second[at[i]]);
    visit(values);
    std::size_t i = varied.size();
    while (i > 0 && ++at[i - 1] == varied[i - 1]->second.size()) at[--i] = 0;
    if (i == 0) return;
  }
}

class PlanReader {
 public:
  explicit PlanReader(const std::string& file) : json_(parse_json(file)) { plan_.file = file; }

  SweepPlan read() {
    const JsonCursor root(json_, plan_.file);
    PlanFile said = plan_form()(root);
    plan_.errors = said.errors;
    plan_.frames.assign(said.frames.begin(), said.frames.end());
    if (said.points.empty()) add_grid(root, said.axes);
    for (std::size_t i = 0; i < said.points.size(); ++i) {
      said.points[i].insert(said.axes.begin(), said.axes.end());
      add_grid(root["points"].elements()[i], said.points[i]);
    }
    return std::move(plan_);
  }

 private:
  void add_grid(const JsonCursor& grid, const Axes& axes) {
    for (const char* required : {kTraces, kTechniques})
      if (!axes.contains(required)) grid.fail("the key " + in_quotes(required), "none");
    // Everything that is counted here is in the table's rows, so it is checked before any of it is made. Points that
    // came before and implementations that are not named count too, and are checked while rows are added.
    limit_combinations(axes, "", kMostRows, grid, kTableRows);
    limit_combinations(axes, kHardware, kMostHardware, grid, kKinds);

    const std::vector<System> systems = read_systems(grid, axes);
    std::vector<std::size_t> sizes = {0};
    if (plan_.sizes.empty()) plan_.sizes.push_back({});
    if (axes.contains(kSizes)) {
      sizes.clear();
      for (const JsonCursor& size : axes.at(kSizes)) sizes.push_back(index_in(plan_.sizes, read_size(size)));
    }
    std::vector<std::size_t> traces, techniques;
    for (const JsonCursor& trace : axes.at(kTraces)) traces.push_back(index_in(plan_.traces, trace.string()));
    for (const JsonCursor& technique : axes.at(kTechniques)) techniques.push_back(read_technique(technique));

    for (const std::size_t trace : traces)
      for (const std::size_t size : sizes)
        for (const std::size_t technique : techniques)
          for (const System& system : systems) {
            const std::size_t cell = add_cell({trace, size, technique, system.memory}, grid);
            for (const std::size_t each : system.hardware) {
              add_rows(cell, each, axes);
              if (plan_.rows.size() > kMostRows) fail_limit(grid, kMostRows, kTableRows);
            }
          }
    if (plan_.hardware.size() > kMostHardware) fail_limit(grid, kMostHardware, kKinds);
  }

  std::size_t add_cell(const SweepCell& cell, const JsonCursor& grid) {
    const auto [found, is_new] = cell_numbers_.emplace(cell, plan_.cells.size());
    if (!is_new) return found->second;
    const std::string& spec = plan_.techniques[cell.technique];
    if (lacks_bins(plan_.memory[cell.memory], parse_technique(spec)))
      grid.fail("techniques that work without bins, because a memory system has none", spec);
    plan_.cells.push_back(cell);
    return found->second;
  }

  void add_rows(std::size_t cell, std::size_t hardware, const Axes& axes) {
    const std::vector<Implementation>& known = plan_.hardware[hardware].implementations;
    if (!axes.contains(kImplementations)) {
      for (std::size_t i = 0; i < known.size(); ++i) plan_.rows.push_back({cell, hardware, i});
      return;
    }
    for (const JsonCursor& wanted : axes.at(kImplementations)) {
      std::vector<std::string_view> names;
      for (const Implementation& each : known) names.push_back(each.name);
      plan_.rows.push_back({cell, hardware, wanted.choice(names)});
    }
  }

  std::size_t read_technique(const JsonCursor& at) {
    const std::string spec = at.string();
    try {
      parse_technique(spec);
    } catch (const SpecError& error) {
      throw SpecError(at.where() + ": " + error.what());
    }
    if (is_reference(spec)) at.fail("a technique other than the reference, which costs nothing on hardware");
    return index_in(plan_.techniques, spec);
  }

  // A memory system, and all hardware that has it.
  struct System {
    std::size_t memory;
    std::vector<std::size_t> hardware;
  };

  std::vector<System> read_systems(const JsonCursor& grid, const Axes& axes) {
    std::vector<System> systems;
    for (const std::size_t hardware : read_hardware_axes(axes))
      each_combination(axes, std::string(kMemorySystem) + ".", [&](const auto& values) {
        const std::size_t memory = add_memory(with_parameters(plan_.hardware[hardware].memory, values, grid));
        const auto is_it = [&](const System& system) { return system.memory == memory; };
        const auto found = std::find_if(systems.begin(), systems.end(), is_it);
        System& system = found == systems.end() ? systems.emplace_back(System{memory, {}}) : *found;
        system.hardware.push_back(hardware);
      });
    return systems;
  }

  std::size_t add_memory(const MemoryParameters& memory) {
    const auto [found, is_new] = memory_numbers_.emplace(parameters_json(memory).dump(), plan_.memory.size());
    if (is_new) plan_.memory.push_back(memory);
    return found->second;
  }

  static MemoryParameters with_parameters(MemoryParameters memory,
                                          const std::vector<std::pair<std::string, JsonCursor>>& values,
                                          const JsonCursor& grid) {
    for (const auto& [name, value] : values)
      for (const MemoryParameter& parameter : memory_parameters())
        if (name == parameter.key) parameter.read(value, memory);
    if (const auto conflict = find_conflict(memory))
      grid.fail(std::string(kMemorySystem) + "." + conflict->name + " of " + conflict->expected, conflict->found);
    return memory;
  }

  std::vector<std::size_t> read_hardware_axes(const Axes& axes) {
    std::vector<Hardware> parts;
    if (axes.contains(kHardware)) {
      for (const JsonCursor& name : axes.at(kHardware)) {
        parts.push_back(named_hardware(name));
        parts.back().label = name.string();
      }
    } else {
      parts.push_back(titan_v());
    }
    std::vector<std::size_t> numbers;
    for (Hardware& part : parts) {
      part.json = nullptr;  // not needed any more, and large
      each_combination(axes, std::string(kHardware) + ".", [&](const auto& values) {
        std::string key = part.label;
        for (const auto& [name, value] : values) {
          index_in(plan_.varied_rates, name);
          const double rate = rate_form()(value);
          (name == kClock ? part.clock_mhz : part.rates[name]) = rate;
          part.ranges.erase(name);  // the plan says which it is
          key += "," + name + Json(rate).dump();
        }
        if (const auto conflict = find_conflict(part)) fail_rates(values, *conflict);
        const auto [found, is_new] = hardware_numbers_.emplace(key, plan_.hardware.size());
        if (is_new) plan_.hardware.push_back(part);
        numbers.push_back(found->second);
      });
    }
    return numbers;
  }

  // At the value of the rate, or of another one that it does not fit to.
  [[noreturn]] static void fail_rates(const std::vector<std::pair<std::string, JsonCursor>>& values,
                                      const RateConflict& conflict) {
    for (const auto& [name, value] : values)
      if (name == conflict.rate) value.fail(conflict.expected);
    values.front().second.fail("rates that fit: " + std::string(conflict.rate) + " " + conflict.expected);
  }

  Hardware named_hardware(const JsonCursor& at) const {
    const std::string name = at.string();
    const std::vector<std::string> built_in = hardware_names();
    return read_hardware(
        std::find(built_in.begin(), built_in.end(), name) != built_in.end() ? name : beside(plan_.file, name));
  }

  Json json_;
  SweepPlan plan_;
  std::map<SweepCell, std::size_t> cell_numbers_;
  std::map<std::string, std::size_t> memory_numbers_, hardware_numbers_;
};

}  // namespace

SweepPlan read_sweep_plan(const std::string& file) { return PlanReader(file).read(); }

std::string file_beside_plan(const SweepPlan& plan, const std::string& name) { return beside(plan.file, name); }

Json sweep_plan_schema() { return schema_file(plan_form().schema, "beampipe sweep, version 1"); }

}  // namespace beampipe
