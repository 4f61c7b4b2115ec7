// The formulas of stages/beam/owner_rules.h that work on masks. No include guard: see simd/scalar.h.

// Bit planes -> the positions in each state, states[0 .. 2^planes - 1]. `plane(p)`: bit p of every position's state.
template <class Mask, class Plane>
void split_states(std::size_t planes, const Mask& everywhere, Plane&& plane, Mask* states) {
  states[0] = everywhere;
  for (std::size_t p = 0; p < planes; ++p) {
    const Mask here = plane(p);
    for (std::size_t state = 0; state < std::size_t{1} << p; ++state) {
      states[state | std::size_t{1} << p] = states[state] & here;
      states[state] = without(states[state], here);
    }
  }
}

// The positions in each state -> bit plane p.
template <class Mask>
Mask join_states(std::size_t p, std::size_t count, const Mask& nowhere, const Mask* states) {
  Mask plane = nowhere;
  for (std::size_t state = 0; state < count; ++state)
    if (state >> p & 1) plane = plane | states[state];
  return plane;
}

// ---- Claim: a fragment takes the positions where it is nearer than their owners ----

// Has the fragment's mask any of these positions?
template <class Mask>
bool is_met(const Mask& positions, const Mask& mask) {
  return !(positions & mask).none();
}

// What is won so far, and from an owner that is farther in the whole pixel.
template <class Mask>
Mask with_won(const Mask& won, const Mask& owned, const Mask& mask) {
  return won | (owned & mask);
}

// Of all that the fragment covers: what is free, and what it wins.
template <class Mask>
Mask claim_of(const Mask& empty, const Mask& mask, const Mask& won) {
  return (empty & mask) | won;
}

// Takes the claim away from a state. Returns whether something is left.
template <class Mask>
bool take_from(Mask& positions, const Mask& claimed) {
  positions = without(positions, claimed);
  return !positions.none();
}
