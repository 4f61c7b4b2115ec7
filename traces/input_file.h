// Opening what a user named for reading.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace beampipe {

// Opens a regular file, or a link to one, of at most 16 GiB: pipes and devices may have no end. Anything else, and what
// cannot be read, throws TraceError, which starts with `where`.
std::ifstream open_input_file(const std::filesystem::path& file, const std::string& where);

// All of its bytes. Throws TraceError.
std::string read_input_file(const std::filesystem::path& file, const std::string& where);

}  // namespace beampipe
