#!/usr/bin/env bash
# Breaks the program in one place after the other and tells which test notices: tests/mutation.sh [BUILD FOLDER [FILE...]]
# Works on this tree, one mutant at a time, in all files or in those that are named, and restores each file. Ends with an
# error if no test notices a mutant.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=${1:-build/release}
only=" ${*:2} "
mutants=(  # file | text as it is | broken
  'simd/lanes-inl.h|LANES_COMPARISON(<=, Le)|LANES_COMPARISON(<=, Lt)'
  'simd/lanes-inl.h|LANES_BINARY(-, Sub)|LANES_BINARY(-, Add)'
  'simd/lanes-inl.h|yes.raw, no.raw|no.raw, yes.raw'
  'simd/lanes-inl.h|hn::DemoteTo(half, x.part[1].raw)|hn::DemoteTo(half, x.part[0].raw)'
  'simd/soa-inl.h|rows + HWY_MIN(lane, count - 1)|rows'
  'simd/triangle_in_pixel-inl.h|triangle.y[k] - triangle.y[next]|triangle.y[next] - triangle.y[k]'
  'simd/coverage-inl.h|1.0f / 6.0f|1.0f / 6.1f'
  'simd/coverage-inl.h|a * b <= zero|a * b >= zero'
  'simd/coverage-inl.h|half * beyond * (from + to)|half * beyond * (from + from)'
  'simd/coverage-inl.h|b * v_out + c|b * v_in + c'
  'simd/coverage-inl.h|moment / safe_area|moment'
  'simd/depth_range-inl.h|in.dzdv * (v - half)|in.dzdv * v'
  'simd/depth_range-inl.h|corner[from] - corner[to]|corner[to] - corner[from]'
  'simd/depth_range-inl.h|corner[side + 2] < zero|corner[side + 1] < zero'
  'simd/depth_range-inl.h|include(inside_u & inside_v|include(inside_u'
  'simd/depth_plane-inl.h|plane.dzdv * v|plane.dzdv * u'
  'simd/plane_order-inl.h|< depth_at|<= depth_at'
  'simd/plane_order-inl.h|lesser(nearest|greater(nearest'
  'simd/depth_span-inl.h|depth < stored|depth <= stored'
  'simd/sample_mask.cpp|kDecided = 1 << 30|kDecided = 1 << 20'
  'simd/sample_mask.cpp|kSmallSlope = 1 << 20|kSmallSlope = 1 << 25'
  'simd/mask_table.cpp|kTableDistances / 2)|kTableDistances / 2 + 1)'
  'simd/mask_table-inl.h|Float(kTableDistances / 2)|Float(kTableDistances / 2 + 1)'
  'simd/mask_table-inl.h|kTableDistances - 1) - column|kTableDistances) - column'
  'simd/mask_table-inl.h|mask = mask & word|mask = word'
  'simd/merge-inl.h|bits(32.0f)|bits(31.0f)'
  'simd/merge-inl.h|depth >= back|depth > back'
  'simd/merge-inl.h|lesser(back, old.z_max)|back'
  'simd/merge-inl.h|select(tiny, added, independent)|select(tiny, independent, added)'
  'simd/merge-inl.h|cover_a * delta)}|cover_a)}'
  'simd/merge-inl.h|farthest + farthest|farthest'
  'simd/merge-inl.h|moved + moved|moved'
  'simd/merge-inl.h|rest * fragment.surface.alpha|fragment.surface.alpha'
  'simd/sample_pattern.cpp|{1, -3}, {-1, 3}|{1, -2}, {-1, 3}'
  'simd/sample_pattern.cpp|pattern.x[static_cast<std::size_t>(i)] = i * 8 + 4|pattern.x[static_cast<std::size_t>(i)] = i * 8 + 3'
  'simd/conserve.h|fraction * fraction * own_error|fraction * own_error'
  'stages/beam/specks.h|kSurfaceReach = 1.0f / 64.0f|kSurfaceReach = 1.0f'
  'stages/beam/specks.h|kSpeckShares = 4.0f|kSpeckShares = 1.0f'
  'stages/beam/compose_beam.cpp|votes / 3.0f|votes / 2.0f'
  'stages/beam/beam_fragment.h|kZeroArea = 5e-7f|kZeroArea = 5e-5f'
  'stages/raster/reference_raster.cpp|2 * reversed + 1|2 * reversed'
  'simd/vertex_transform-inl.h|Real(double{kSubpixelUnits}) + Real(0.5)|Real(double{kSubpixelUnits}) + Real(0.25)'
  'simd/vertex_transform-inl.h|v.w > Real(0.0)|v.w >= Real(0.0)'
  'simd/vertex_transform-inl.h|magnitude(v.x) <= v.w|magnitude(v.x) < v.w'
  'simd/vertex_transform-inl.h|magnitude(v.z) <= v.w|magnitude(v.z) < v.w'
  'simd/vertex_transform-inl.h|m[8 + r] * z|m[8 + r] * y'
  'simd/vertex_transform-inl.h|one - v.y * inverse_w|one + v.y * inverse_w'
  'stages/geometry/clip.h|kGuardBand = 32768.0|kGuardBand = 65536.0'
  'simd/window_owners.cpp|kFar = std::numeric_limits<float>::infinity()|kFar = -0.25f'
  'simd/position_mask.cpp|kSmallSlope = 1 << 20|kSmallSlope = 1 << 25'
  'simd/position_mask.cpp|kDecided = 1 << 30|kDecided = 1 << 20'
  'simd/cell_rows.cpp|hn::Iota(d, 0.0)|hn::Iota(d, 1.0)'
  'stages/beam/windows.h|return nearest <= farthest|return nearest < farthest'
  'stages/beam/merge_sort.h|return depth < other|return depth <= other'
  'stages/beam/merge_sort.h|comes_first(depth_of(from[i]), depth_of(from[j]))|!comes_first(depth_of(from[j]), depth_of(from[i]))'
  'stages/data/pixel_depth.h|rounding(0x1p-21)|rounding(0x1p-31)'
  'stages/data/closed_depth.h|nearest > depth_[tile_.index(x, y)]|nearest >= depth_[tile_.index(x, y)]'
  'stages/data/closed_depth.h|nearest > farthest_|nearest >= farthest_'
  'pipeline/bins/bands.cpp|edge.b > 0 ? bottom : top|edge.b > 0 ? top : bottom'
  'pipeline/bins/bands.cpp|floor_of(-at_zero - 1,|floor_of(-at_zero,'
)

for mutant in "${mutants[@]}"; do  # before anything is built
  IFS='|' read -r file whole broken <<<"$mutant"
  [[ -f $file ]] && WHOLE=$whole perl -0ne 'exit !/\Q$ENV{WHOLE}\E/' "$file" || {
    echo "$file has no \"$whole\" any more" >&2
    exit 1
  }
done

unnoticed=0
for mutant in "${mutants[@]}"; do
  IFS='|' read -r file whole broken <<<"$mutant"
  [[ $only == "  " || $only == *" $file "* ]] || continue
  original=$(mktemp)
  cp "$file" "$original"
  trap 'cp "$original" "$file"' EXIT
  WHOLE=$whole BROKEN=$broken perl -0pi -e 's/\Q$ENV{WHOLE}\E/$ENV{BROKEN}/' "$file"
  noticed=
  folders=(simd stages pipeline)
  [[ $file == stages/* ]] && folders=(stages pipeline)
  [[ $file == pipeline/* ]] && folders=(pipeline)
  for folder in "${folders[@]}"; do
    cmake --build "$build" --target "${folder}_tests" >/dev/null
    log=$("$build/tests/${folder}_tests" --gtest_fail_fast --gtest_brief=1 2>&1) && continue
    noticed=$(sed -n 's/^\[  FAILED  \] \([^ ,]*\).*/\1/p' <<<"$log" | head -1)
    break
  done
  cp "$original" "$file"
  trap - EXIT
  rm "$original"
  echo "$file: $whole -> $broken: ${noticed:-NOBODY}"
  [[ $noticed ]] || unnoticed=1
done
exit $unnoticed
