// The options that say on which hardware times are modelled.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/command_line.h"
#include "tools/evaluate/hardware.h"

namespace beampipe {

// The options as the user wrote them.
struct HardwareOptions {
  std::string hardware, material_cost, light_cost;

  bool operator==(const HardwareOptions&) const = default;
};

enum class HardwareCount { one, several };  // that the command can show

// `options` must live until the command line is parsed.
void add_hardware_options(Command& command, HardwareOptions& options, HardwareCount count = HardwareCount::several);

// At least one. Throws UsageError, or what reading a description throws.
std::vector<Hardware> read_hardware(const HardwareOptions& options);

}  // namespace beampipe
