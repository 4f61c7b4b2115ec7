// How many times as much as in continuous integration a random search tries: the environment variable
// BEAMPIPE_THOROUGH, 1 by default.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace beampipe {

inline int thoroughness() {
  const char* const text = std::getenv("BEAMPIPE_THOROUGH");
  return text ? std::max(1, std::atoi(text)) : 1;
}

}  // namespace beampipe
