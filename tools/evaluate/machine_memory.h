// What a frame needs of the machine's memory, known before any is taken.
#pragma once

#include <cstdint>
#include <string>

#include "traces/trace.h"

namespace beampipe {

std::uint64_t machine_memory();  // bytes

// Throws std::runtime_error, in a line that starts with `name`, where the frame's pixels, of so many bytes each, and
// its triangles, all of them in view, take more than `memory` bytes. (The system grants memory that it does not have,
// and ends the program when that is used.)
void require_memory(const Trace& trace, const Frame& frame, std::uint32_t bytes_per_pixel, const std::string& name,
                    std::uint64_t memory);

}  // namespace beampipe
