// What the paper (Crassin et al. 2018, section 2) and the slides of its talk leave open about merging: one named policy
// each, with the first as the default, which is the paper's text where it speaks. docs/accuracy.md says what each is
// worth.
#pragma once

namespace beampipe {

struct MergeRules {
  // How two coverages lie to each other where masks overlap and one surface is in front.
  enum class Overlap {
    tiny,        // tiny triangles beside what is there (ADD), all others independent (OVER): section 2.2.1
    over,        // all independent: the formulas of section 2.2 alone
    add,         // all beside each other, as far as there is room: the other end of slide 12's transition
    transition,  // slide 12: from ADD to OVER by a fuzziness of |M_A|, alpha_A and "sadp(A, B)", see merge.h
  } overlap = Overlap::tiny;

  // Local coverage alpha 32 / |M| above 1, which makes 1 - alpha' negative in the published formulas.
  enum class Local {
    clamp,  // to 1 where the surfaces overlap: a position cannot be covered more than wholly
    keep,   // what shows keeps its area; what it hides is bounded by 0
  } local = Local::clamp;

  // Blending within the slab.
  enum class Fuzzy {
    delta,  // b_i = alpha'_i (1 - Delta), b_a = alpha'_a Delta: section 2.2
    mix,    // Delta between the fragment over and under the aggregate, so that area is not lost when both are thin
  } fuzzy = Fuzzy::delta;

  // Where the slab ends at a position, for the depth partition and for Delta.
  enum class Extents {
    range,  // cut by z_min and z_max: "comparing the slabs S and depth ranges", section 2.2
    slab,   // plane and thickness alone
  } extents = Extents::range;

  // What of a fragment thickens the slab and its depth range.
  enum class Slab {
    full,     // all of its positions: section 2.2, "the maximal distance from the fragment"
    visible,  // those that are not behind the slab; a fragment that is behind it altogether leaves the slab alone
  } slab = Slab::full;

  // Weights of the planes: "a final coverage-weighted blend of the prior planes", section 2.2.
  enum class Plane {
    area,     // by alpha
    visible,  // by what shows of each
  } plane = Plane::area;

  // Thickness that is kept from before.
  enum class Thickness {
    larger,      // "or the input slab extent, if larger": section 2.2
    containing,  // and by how much the plane moved: "bounds containing all merged primitives", figure 2
  } thickness = Thickness::larger;

  bool operator==(const MergeRules&) const = default;
};

}  // namespace beampipe
