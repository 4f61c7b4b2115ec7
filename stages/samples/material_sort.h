// material_sort: triangles of shading samples -> the samples that show one, material by material.
//
// A shader of one material then runs on samples that follow each other in a list. The sort is the radix sort that GPUs
// use: least significant digit first, 8 bits a pass. In each pass, a bin counts its samples by digit, adds the counts
// of earlier bins, and writes each sample to its place (Adinets and Merrill: Onesweep, 2022). Here the order is that
// within the bin; the bins' lists of a material would follow each other.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/cost/counters.h"

namespace beampipe {

// Returns indices of `triangles`, ordered by material and, within a material, as they were. Samples of kNoTriangle are
// left out. `materials`: one per triangle, of at most `digits` digits of 8 bits.
std::vector<std::uint32_t> material_sort(const std::vector<std::uint32_t>& triangles,
                                         const std::vector<std::uint32_t>& materials, int digits,
                                         StageCounters& counters);

}  // namespace beampipe
