// Checks before rendering that a frame fits into the machine's memory.
#pragma once

#include <cstdint>
#include <string>

#include "traces/trace.h"

namespace beampipe {

std::uint64_t machine_memory();  // bytes

// Throws std::runtime_error, one line that starts with `name`, if the frame may need more than `memory` bytes: so many
// bytes for each pixel, and those of all its triangles, as if all were in view. Without this check the system would
// grant memory that it does not have, and kill the program when it is used.
void require_memory(const Trace& trace, const Frame& frame, std::uint32_t bytes_per_pixel, const std::string& name,
                    std::uint64_t memory);

}  // namespace beampipe
