// The formula of simd/mask_table.h. No include guard: see simd/scalar.h.

// An edge that is farther than half a diagonal from the centre has no sample inside, or all of them.
template <class Int, class Mask, class Float>
Mask table_mask_formula(const TableTriangleOf<Int, Mask, Float>& triangle, const MaskTable& table) {
  const Float zero(0.0f), one(1.0f), reach(kHalfDiagonal);
  Mask mask(~0u);
  for (const TableEdgeOf<Int, Mask, Float>& edge : triangle.edges) {
    const Float scaled = (edge.distance * Float(1.0f / kHalfDiagonal) + one) * Float(kTableDistances / 2);
    const Int column = to_integer(lesser(greater(scaled, zero), Float(kTableDistances - 1)));
    const Int row = edge.angle * Int(kTableDistances);
    const Int reverse = row + Int((kTableAngles / 2 + 1) * kTableDistances - 1) - column;
    Mask word = fetch(table.words(), select(edge.flip != Mask(0u), reverse, row + column));
    word = select(edge.distance <= zero - reach, edge.flip, word);
    word = select(edge.distance >= reach, ~edge.flip, word);
    mask = mask & word;
  }
  return mask;
}
