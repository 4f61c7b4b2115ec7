// Digests that tell different contents apart: CRC-64 as in the XZ format, written as 16 hexadecimal digits. They detect
// accidental changes, not deliberate forgeries.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "traces/trace.h"

namespace beampipe {

std::string digest_of(std::string_view bytes);

// Covers everything in the trace that a picture depends on.
std::string digest_of(const Trace& trace);

std::string digest_of_file(const std::filesystem::path& path);

}  // namespace beampipe
