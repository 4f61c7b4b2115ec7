// How much more than the quick run of continuous integration a search is to try: BEAMPIPE_THOROUGH=N, 1 by default.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace beampipe {

inline int thoroughness() {
  const char* const text = std::getenv("BEAMPIPE_THOROUGH");
  return text ? std::max(1, std::atoi(text)) : 1;
}

}  // namespace beampipe
