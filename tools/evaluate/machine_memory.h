// Checks before rendering that a frame fits into the machine's memory.
#pragma once

#include <cstdint>
#include <string>

#include "traces/trace.h"

namespace beampipe {

std::uint64_t machine_memory();  // bytes

// An upper estimate, in bytes, of what a technique takes for a frame besides the trace: so many bytes for each pixel,
// and those of all its triangles, as if all were in view. If triangles vary, these also count: their vertices' and
// their own inputs for shading, what the shader keeps for each material of the trace, the textures with all their mip
// levels, as they are made, which is when they take most, and the tested alpha of the frame's cutouts. Memory for pairs
// is not in it: FrameInput::memory_limit limits that.
std::uint64_t frame_memory(const Trace& trace, const Frame& frame, std::uint32_t bytes_per_pixel);

// Throws std::runtime_error, one line that starts with `name`, if frame_memory() is more than `memory` bytes. Without
// this check the system would grant memory that it does not have, and kill the program when it is used.
void require_memory(const Trace& trace, const Frame& frame, std::uint32_t bytes_per_pixel, const std::string& name,
                    std::uint64_t memory);

}  // namespace beampipe
