// Random cases. Each has its own seed, which a failure names.
#pragma once

#include "tests/simd/random.h"
#include "tests/thorough.h"

namespace beampipe {

// Calls body(random) `count` times, multiplied by how thorough the search is to be (tests/thorough.h).
template <class Body>
void search(std::uint64_t first_seed, int count, Body&& body) {
  for (int i = 0; i < count * thoroughness(); ++i) {
    Random random(first_seed + static_cast<std::uint64_t>(i));
    body(random);
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace beampipe
