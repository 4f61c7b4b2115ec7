#include "tools/cli/hardware_options.h"

#include <array>
#include <charconv>

#include "pipeline/spec.h"

namespace beampipe {
namespace {

// "OPERATIONS", "OPERATIONS,FETCHES" or "OPERATIONS,FETCHES,REGISTERS".
ShadingCost parse_cost(const std::string& option, const std::string& text) {
  std::array<double, 3> numbers{};
  std::size_t count = 0;
  const char *at = text.data(), *const end = text.data() + text.size();
  for (;; ++at) {
    if (count < numbers.size()) {
      const auto parsed = std::from_chars(at, end, numbers[count]);
      const bool is_valid = parsed.ec == std::errc() && numbers[count] >= 0 && numbers[count] <= 1e9;
      at = is_valid ? parsed.ptr : nullptr;
    }
    if (count++ == numbers.size() || !at || (at != end && *at != ','))
      throw UsageError(option + " " + text + ": expected OPERATIONS[,FETCHES[,REGISTERS]], numbers from 0 to 1e9");
    if (at == end) return {numbers[0], numbers[1], numbers[2]};
  }
}

}  // namespace

void add_hardware_options(Command& command, HardwareOptions& options, HardwareCount count) {
  const std::string several =
      count == HardwareCount::several ? "; several with commas between them are shown side by side" : "";
  command.add("--hardware", options.hardware,
              "the hardware whose times are modelled: " + list_of(hardware_names(), "or") +
                  ", or a file that describes one" + several + " (default: " + hardware_names().front() + ")");
  command.add(
      "--material-cost", options.material_cost,
      "OPERATIONS[,FETCHES[,REGISTERS]]: what each fragment shader invocation costs in modelled times, in addition to "
      "the materials of the trace");
  command.add("--light-cost", options.light_cost,
              "the same for lighting, in the stage `light` or, without one, in the fragment shader");
}

std::vector<Hardware> read_hardware(const HardwareOptions& options) {
  std::vector<Hardware> all =
      read_hardware_list(options.hardware.empty() ? hardware_names().front() : options.hardware);
  if (options.material_cost.empty() && options.light_cost.empty()) return all;
  for (Hardware& each : all) {
    const auto cost = [](const std::string& option, const std::string& text, const ShadingCost& described) {
      return text.empty() ? described : parse_cost(option, text);
    };
    each = with_shading_costs(each, cost("--material-cost", options.material_cost, each.material),
                              cost("--light-cost", options.light_cost, each.light));
  }
  return all;
}

}  // namespace beampipe
