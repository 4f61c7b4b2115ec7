// Bytes that operator new has allocated in this program.
#pragma once

#include <cstdint>

namespace beampipe {

std::int64_t heap_bytes();
std::int64_t heap_peak();   // the largest value of heap_bytes() since the last restart
std::int64_t heap_given();  // all allocations so far, freed or not
void restart_heap_peak();

}  // namespace beampipe
