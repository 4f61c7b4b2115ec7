// Reading files that a user named, and errors about what is in them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace beampipe {

// Throws TraceError "WHERE: expected EXPECTED, found FOUND". Control characters in the parts become "?", so that the
// message is one line.
[[noreturn]] void fail_trace(const std::string& where, const std::string& expected, const std::string& found);

// Is the path in the folder, or in one inside that, as far as their names tell? Links must have been followed before.
bool is_inside(const std::filesystem::path& path, const std::filesystem::path& folder);

inline constexpr std::uint64_t kMostInputBytes = std::uint64_t{16} << 30;

// Opens a regular file, or a link to one, of at most `most_bytes`, a multiple of 1 GiB. Pipes and devices are refused,
// because they may have no end. Throws TraceError for these and for a file that cannot be read; the message starts with
// `where`.
std::ifstream open_input_file(const std::filesystem::path& file, const std::string& where,
                              std::uint64_t most_bytes = kMostInputBytes);

// Returns all bytes of a file that open_input_file() opens. Throws TraceError.
std::string read_input_file(const std::filesystem::path& file, const std::string& where,
                            std::uint64_t most_bytes = kMostInputBytes);

}  // namespace beampipe
