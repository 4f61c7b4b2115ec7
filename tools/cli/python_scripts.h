// Commands whose work is done by Python scripts.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace beampipe {

// A folder of the installed program, named from its prefix, if it has this file; else the one of the source tree.
std::filesystem::path scripts_folder(const std::string& installed, const std::string& source, const std::string& file);

// Becomes Python with these arguments, which does not return. The process stays the same, so that signals reach it.
// Throws std::runtime_error, one line, if there is no Python.
[[noreturn]] void become_python(const std::vector<std::string>& arguments);

}  // namespace beampipe
