// Tells apart contents that differ by accident: CRC-64 of the XZ format, as 16 hexadecimal digits.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "traces/trace.h"

namespace beampipe {

std::string digest_of(std::string_view bytes);

// Of everything in the trace that a picture depends on.
std::string digest_of(const Trace& trace);

std::string digest_of_file(const std::filesystem::path& path);

}  // namespace beampipe
