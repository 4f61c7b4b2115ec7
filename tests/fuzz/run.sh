#!/usr/bin/env bash
# Builds the fuzz targets with clang's libFuzzer and sanitizers, and runs each: tests/fuzz/run.sh [SECONDS each] [TARGET...]
# Kernels are built for the baseline instruction set only, because the targets read files, which is the same on all.
# Inputs that reach new code go to build/fuzz/found/TARGET, and the next run starts from them. A crash leaves its input
# in build/fuzz and ends the script with an error.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

seconds=${1:-20}
targets=("${@:2}")
((${#targets[@]} > 0)) || targets=(trace obj gltf image exr spirv spec config results)
TMPDIR=$(mktemp --directory /dev/shm/beampipe-fuzz-XXXXXX)  # in memory
export TMPDIR
trap 'rm -r "$TMPDIR"' EXIT
cmake --preset fuzz -DCMAKE_UNITY_BUILD=ON >/dev/null
cmake --build --preset fuzz --parallel "$(nproc)" --target "${targets[@]/%/_fuzz}"
# The names of techniques and their options, from the tables of docs/techniques.md.
sed -n '/tables of .*: begin/,/tables of .*: end/p' docs/techniques.md | grep -oE '[a-z0-9.-]+[=:]?' | sort -u |
  sed 's/.*/"&"/' >"$TMPDIR/spec.dict"
# The keys and names of JSON files, from their readers, and a few other words.
{
  grep -rohE '"[a-z][a-z0-9_]*"' tools/{evaluate,report,sweep,claims} docs/examples/*.json | sort -u
  printf '%s\n' '{}' '[]' -1 1e308 1e-308 18446744073709551615 null true ../
} | sed 's/"/\\"/g; s/.*/"&"/' | tee "$TMPDIR/config.dict" >"$TMPDIR/results.dict"
# Runs one target, and then prints what it said.
run_target() {
  local target=$1 seconds=$2 found=build/fuzz/found/$1 dictionary=tests/fuzz/$1.dict options=() said status=0
  [[ ! -e $TMPDIR/$target.dict ]] || dictionary=$TMPDIR/$target.dict
  [[ ! -e $dictionary ]] || options=(-dict="$dictionary")
  mkdir -p "$found"
  said=$(build/fuzz/tests/fuzz/"${target}_fuzz" "$found" tests/fuzz/corpus/"$target" "${options[@]}" \
    -max_total_time="$seconds" -max_len=65536 -rss_limit_mb=2048 -timeout=20 -artifact_prefix="build/fuzz/${target}-" \
    -print_final_stats=1 -verbosity=0 2>&1) || status=$?
  printf '== %s: %s s\n%s\n' "$target" "$seconds" "$said"
  return "$status"
}
export -f run_target
# Each takes one core.
printf '%s\n' "${targets[@]}" | xargs --max-procs="$(nproc)" -I{} bash -c 'run_target {} "$0"' "$seconds"
