// The area that a fragment adds to a pixel's aggregate: its analytic area, corrected with mask bits so that no area is
// given away twice.
//
// Two numbers are known about every surface: its exact area, and how many mask positions it covers. Their difference is
// the error that the mask makes for that surface. Counting visible positions alone is multisampling. Here,
//   - a fragment that shows a fraction f of its positions also gets f^2 of its own mask's error: all of it if the whole
//     fragment is visible, and little if the visible part has another outline than the fragment;
//   - what the surfaces in front took beyond the area of their positions is missing behind them. A partly hidden
//     fragment gives up its share of it, in proportion to the free positions that it takes.
// The background is a fragment that covers the whole pixel. It gets exactly what is left, so the areas add up to 1.
#pragma once

#include "simd/scalar.h"

namespace beampipe {

// What a pixel has taken so far, from near to far.
template <class Float>
struct Taken {
  Float area;       // 0..1
  Float positions;  // how many mask positions are owned
};

// `area` is the fragment's area in the pixel, 0..1. It covers `covered` > 0 of the mask's `positions`, of which nothing
// nearer owns `visible` <= covered. Returns the visible area, 0..min(area, 1 - taken.area).
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
