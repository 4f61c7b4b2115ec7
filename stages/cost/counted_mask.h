// A mask that counts: a rule that runs on it shows how many operations it takes on masks.
#pragma once

#include <cstddef>

#include "stages/cost/counters.h"

namespace beampipe {

// An operation on a mask takes one operation for each word of 32 positions.
struct CountedMask {
  std::size_t words = 0;
  OperationCounts* tally = nullptr;

  CountedMask counted() const {
    if (tally) tally->bit += words;
    return *this;
  }
  bool none() const {
    counted();
    return false;
  }
};
inline CountedMask operator&(const CountedMask& a, const CountedMask&) { return a.counted(); }
inline CountedMask operator|(const CountedMask& a, const CountedMask&) { return a.counted(); }
inline CountedMask without(const CountedMask& a, const CountedMask&) { return a.counted(); }

}  // namespace beampipe
