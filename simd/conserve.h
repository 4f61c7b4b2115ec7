// The area that a fragment adds to a pixel's aggregate, from analytic areas corrected by mask bits: nothing is given
// twice.
//
// Two numbers are known of every surface: its exact area, and how many mask positions it covers. Their difference is
// the error that the mask makes about that surface. Counting visible positions alone is multisampling; here
//   - a fragment that shows with the fraction f of its positions brings f^2 of its own mask's error along. All of it
//   when
//     the fragment is whole, and little when what is seen of it has another outline than its own;
//   - what the surfaces in front took beyond their positions is missing behind them. A fragment that is partly hidden
//   gives
//     up its share: its part of the positions that were still free.
// The background is a fragment that covers the pixel: it gets exactly what is left, so that the areas add up to 1.
#pragma once

#include "simd/scalar.h"

namespace beampipe {

// What one pixel has taken in so far, near to far.
template <class Float>
struct Taken {
  Float area;       // 0..1
  Float positions;  // owned mask positions
};

// `area`: of the fragment in the pixel, 0..1. `covered` > 0: mask positions that it covers. `visible` <= covered: those
// that nothing nearer owns. `positions`: bits of the mask. Returns the visible area, 0..min(area, 1 - taken.area).
template <class Float>
Float visible_area(Float area, Float covered, Float visible, Float positions, const Taken<Float>& taken) {
  const Float zero(0.0f), one(1.0f);
  const Float fraction = visible / covered;
  const Float own_error = area - covered / positions;
  const Float taken_error = taken.area - taken.positions / positions;
  const Float free = greater(positions - taken.positions, one);
  const Float share = select(visible < covered, visible / free, zero);
  const Float estimate = visible / positions + fraction * fraction * own_error - share * taken_error;
  return lesser(greater(estimate, zero), lesser(area, one - taken.area));
}

}  // namespace beampipe
