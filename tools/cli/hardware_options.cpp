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

void add_hardware_options(Command& command, HardwareOptions& options, const std::string& fallback) {
  command.add("--hardware", options.hardware,
              "the GPU whose memory system and times are modelled: " + list_of(hardware_names(), "or") +
                  ", or a file that describes one (`beampipe schema hardware`; default: " + fallback + ")");
  command.add(
      "--material-cost", options.material_cost,
      "OPERATIONS[,FETCHES[,REGISTERS]]: what each fragment shader invocation costs in modelled times, in addition to "
      "the materials of the trace");
  command.add("--light-cost", options.light_cost,
              "the same for lighting, in the stage `light` or, without one, in the fragment shader");
}

Hardware read_hardware(const HardwareOptions& options) {
  return with_costs(read_hardware(options.hardware.empty() ? hardware_names().front() : options.hardware), options);
}

std::string shading_options(const HardwareOptions& options) {
  return (options.material_cost.empty() ? "" : " --material-cost " + options.material_cost) +
         (options.light_cost.empty() ? "" : " --light-cost " + options.light_cost);
}

Hardware with_costs(const Hardware& hardware, const HardwareOptions& options) {
  if (options.material_cost.empty() && options.light_cost.empty()) return hardware;
  const auto cost = [](const std::string& option, const std::string& text, const ShadingCost& described) {
    return text.empty() ? described : parse_cost(option, text);
  };
  const Hardware priced =
      with_shading_costs(hardware, cost("--material-cost", options.material_cost, hardware.material),
                         cost("--light-cost", options.light_cost, hardware.light));
  if (const auto conflict = find_conflict(priced))
    throw UsageError("--material-cost, --light-cost: expected " + std::string(conflict->rate) + " of the hardware " +
                     conflict->expected);
  return priced;
}

}  // namespace beampipe
