// What the arithmetic units of a core can do at most.
#pragma once

#include <cstdint>

namespace beampipe {

// Adds and multiplies in the widest vectors of the best instruction set, as many of each, without waiting for results
// and without memory. Returns the number of operations, each lane of a vector being one; `result` keeps them from being
// left out.
std::uint64_t run_vector_operations(float& result);

}  // namespace beampipe
