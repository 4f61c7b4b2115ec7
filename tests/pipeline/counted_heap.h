// What operator new has given out in this program.
#pragma once

#include <cstdint>

namespace beampipe {

std::int64_t heap_bytes();
std::int64_t heap_peak();   // the most since the last restart
std::int64_t heap_given();  // in all, given back or not
void restart_heap_peak();

}  // namespace beampipe
