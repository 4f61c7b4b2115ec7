// What a frame needs of the machine's memory, known before any is taken.
#pragma once

#include <cstdint>
#include <string>

#include "pipeline/technique.h"

namespace beampipe {

std::uint64_t machine_memory();  // bytes

// Throws std::runtime_error, in a line that starts with `name`, where `technique` needs more than `memory` bytes for
// the frame's pixels alone. (The system grants memory that it does not have, and ends the program when that is used.)
void require_memory(const Technique& technique, const Frame& frame, const std::string& name, std::uint64_t memory);

}  // namespace beampipe
