#!/usr/bin/env bash
# Breaks one constant after the other and prints which test notices: tests/mutation.sh [BUILD FOLDER [FILE...]]
# Changes this source tree, one file at a time (all files, or the named ones), and restores each file. Ends with an
# error if there is a change that no test notices.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=${1:-build/release}
only=" ${*:2} "
mutants=(  # file | constant as it is | broken
  'simd/coverage.cpp|1.0f / 6.0f|1.0f / 6.1f'
  'simd/sample_mask.cpp|kDecided = 1 << 30|kDecided = 1 << 20'
  'simd/sample_mask.cpp|kSmallSlope = 1 << 20|kSmallSlope = 1 << 25'
  'simd/mask_table.cpp|kTableDistances / 2)|kTableDistances / 2 + 1)'
  'simd/merge.cpp|bits = hn::Set(d, 32.0f)|bits = hn::Set(d, 31.0f)'
  'simd/sample_pattern.cpp|{1, -3}, {-1, 3}|{1, -2}, {-1, 3}'
  'simd/sample_pattern.cpp|pattern.x[static_cast<std::size_t>(i)] = i * 8 + 4|pattern.x[static_cast<std::size_t>(i)] = i * 8 + 3'
  'simd/conserve.h|fraction * fraction * own_error|fraction * own_error'
  'stages/beam/specks.h|kSurfaceReach = 1.0f / 64.0f|kSurfaceReach = 1.0f'
  'stages/beam/specks.h|kSpeckShares = 4.0f|kSpeckShares = 1.0f'
  'stages/beam/compose_beam.cpp|votes / 3.0f|votes / 2.0f'
  'stages/beam/beam_fragment.h|kZeroArea = 5e-7f|kZeroArea = 5e-5f'
  'stages/raster/reference_raster.cpp|2 * reversed + 1|2 * reversed'
  'simd/vertex_transform.h|Real(double{kSubpixelUnits}) + Real(0.5)|Real(double{kSubpixelUnits}) + Real(0.25)'
  'simd/vertex_transform.cpp|hn::Le(hn::Abs(value), w)|hn::Lt(hn::Abs(value), w)'
  'simd/vertex_transform.cpp|hn::Gt(w, zero)|hn::Ge(w, zero)'
  'simd/vertex_transform.h|magnitude(v.z) <= v.w|magnitude(v.z) < v.w'
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
  'pipeline/bands.cpp|edge.b > 0 ? bottom : top|edge.b > 0 ? top : bottom'
  'pipeline/bands.cpp|floor_of(-at_zero - 1,|floor_of(-at_zero,'
)

unnoticed=0
for mutant in "${mutants[@]}"; do
  IFS='|' read -r file constant broken <<<"$mutant"
  [[ $only == "  " || $only == *" $file "* ]] || continue
  original=$(mktemp)
  cp "$file" "$original"
  trap 'cp "$original" "$file"' EXIT
  CONSTANT=$constant BROKEN=$broken perl -0pi -e 's/\Q$ENV{CONSTANT}\E/$ENV{BROKEN}/' "$file"
  if cmp -s "$file" "$original"; then
    echo "$file has no \"$constant\" any more" >&2
    exit 1
  fi
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
  echo "$file: $constant -> $broken: ${noticed:-NOBODY}"
  [[ $noticed ]] || unnoticed=1
done
exit $unnoticed
