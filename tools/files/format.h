// printf into a string, of which at most 511 bytes are kept.
#pragma once

#include <string>

namespace beampipe {

[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

}  // namespace beampipe
