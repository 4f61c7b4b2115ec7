// The options that say on which hardware times are modelled.
#pragma once

#include <string>

#include "tools/cli/command_line.h"
#include "tools/evaluate/hardware.h"

namespace beampipe {

// The options as the user wrote them.
struct HardwareOptions {
  std::string hardware, material_cost, light_cost;

  bool operator==(const HardwareOptions&) const = default;
};

// `options` must live until the command line is parsed. `fallback`: what is taken without --hardware, for the help.
void add_hardware_options(Command& command, HardwareOptions& options, const std::string& fallback = "titan_v");

// What --hardware names, or titan_v. Throws UsageError, or what reading a description throws.
Hardware read_hardware(const HardwareOptions& options);

// " --material-cost 200,4": the options that add to what shading costs.
std::string shading_options(const HardwareOptions& options);

// The same hardware with the costs that the options name.
Hardware with_costs(const Hardware& hardware, const HardwareOptions& options);

}  // namespace beampipe
