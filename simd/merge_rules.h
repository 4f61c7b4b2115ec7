// Choices that the published rules for merging (Crassin et al. 2018, section 2, and the slides of the talk) leave open.
// Each is a policy with a name. The first value is the default: of the readings that contradict neither the text nor
// the slides, the one with the least error.
#pragma once

namespace beampipe {

struct MergeRules {
  // How two coverages are correlated where masks overlap and one surface is in front.
  enum class Overlap {
    tiny,        // specks lie beside what is there (ADD), all others are independent (OVER): section 2.2.1
    over,        // all are independent: the formulas of section 2.2 alone
    add,         // all lie beside each other as far as there is room: the other end of slide 12's transition
    unbounded,   // as `tiny`, but what lies behind a speck keeps all of its area, even where both together exceed the
                 // region: not in the text
    transition,  // slide 12: from ADD to OVER by a fuzziness of |M_A|, alpha_A and "sadp(A, B)", see merge-inl.h
  } overlap = Overlap::tiny;

  // What alpha' is in a region where masks overlap. A surface with |M| positions has alpha_O = alpha |M_O| / |M| of its
  // area in a region of |M_O| positions (slide 10).
  enum class Regional {
    local,  // normalized by the region's share of positions: alpha_O 32 / |M_O| = alpha 32 / |M|, section 2.2's local
            // coverage, to be weighted by |M_O| / 32
    area,   // not normalized: alpha_O itself, to be added up. So even an opaque region hides only a part of what is
            // there.
  } regional = Regional::local;

  // How to blend within the slab.
  enum class Fuzzy {
    unite,  // colours by b_i = alpha'_i (1 - Delta), b_a = alpha'_a Delta, as in section 2.2; the region's coverage is
            // that of both together in every other region where they overlap, by `overlap`
    delta,  // b_i + b_a is the region's coverage as well. In the middle of a slab, two halves become a half. Specks
            // have the factors of section 2.2.1, as in front of the slab.
    mix,  // interpolate by Delta from the fragment over to the fragment under the aggregate: not in the text
  } fuzzy = Fuzzy::unite;

  // Where the slab ends at a position, for the depth partition and for Delta.
  enum class Extents {
    range,  // clamped to z_min..z_max: "comparing the slabs S and depth ranges", section 2.2
    slab,   // by plane and thickness alone
  } extents = Extents::range;

  // Which part of a fragment extends the slab and its depth range, where "the slab extent depends on the maximal
  // distance from the fragment to the combined plane" (section 2.2).
  enum class Slab {
    visible,  // positions that are not behind the slab; a fragment that is all behind it changes nothing
    full,     // all of its positions, hidden ones too
  } slab = Slab::visible;

  // How to weight the two planes: "a final coverage-weighted blend of the prior planes", section 2.2.
  enum class Plane {
    visible,  // by the coverage of each after the merge
    area,     // by alpha before it
  } plane = Plane::visible;

  // How much of the earlier thickness to keep.
  enum class Thickness {
    larger,      // all of it, "or the input slab extent, if larger": section 2.2
    containing,  // and twice the distance that the plane moved: "bounds containing all merged primitives", figure 2
    none,        // a slab is no thicker than its plane: not in the text
  } thickness = Thickness::larger;

  // How to find the positions that lie in front of the slab and behind it.
  enum class Partition {
    lines,      // by the lines in which the planes meet, with the table of masks: figure 4
    positions,  // exactly, position by position
    given,      // by the fragment's `front`: everything else lies behind
  } partition = Partition::lines;

  bool operator==(const MergeRules&) const = default;
};

}  // namespace beampipe
