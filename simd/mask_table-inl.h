// The formulas of simd/mask_table.h. No include guard: see simd/scalar.h.

// The mask of a half-plane. `row`: where the table's row for its unflipped angle begins. `distance`: of that from the
// pixel's centre.
template <class Mask, class Int, class Flipped, class Float>
Mask table_word(Int row, Flipped is_flipped, Float distance, const MaskTable& table) {
  const Float zero(0.0f), one(1.0f);
  const Float scaled = (distance * Float(1.0f / kHalfDiagonal) + one) * Float(kTableDistances / 2);
  const Int column = to_integer(lesser(greater(scaled, zero), Float(kTableDistances - 1)));
  const Mask word = fetch(table.words(), row + column);
  return select(is_flipped, ~word, word);
}

// An edge that is farther than half a diagonal from the centre has no sample inside, or all of them.
template <class Int, class Mask, class Float>
Mask table_mask_formula(const TableTriangleOf<Int, Mask, Float>& triangle, const MaskTable& table) {
  const Float zero(0.0f), reach(kHalfDiagonal);
  Mask mask(~0u);
  for (const TableEdgeOf<Int, Mask, Float>& edge : triangle.edges) {
    Mask word = table_word<Mask>(edge.angle * Int(kTableDistances), edge.flip != Mask(0u), edge.distance, table);
    word = select(edge.distance <= zero - reach, edge.flip, word);
    word = select(edge.distance >= reach, ~edge.flip, word);
    mask = mask & word;
  }
  return mask;
}
