// Text of numbers.
#pragma once

#include <cstdint>
#include <string>

namespace beampipe {

// printf into a string, of which at most 511 bytes are kept.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

std::string with_noun(std::uint64_t number, const std::string& noun);  // "1 draw", "2 draws", "2 meshes"

}  // namespace beampipe
