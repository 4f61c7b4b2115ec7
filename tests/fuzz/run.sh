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
# The keys and names of JSON files, from their readers, a few other words, and the NUL that ends a part of an input.
{
  {
    grep -rohE '"[a-z][a-z0-9_.-]*"' --include=*.{cpp,h,json} tools/{evaluate,files,inspect,report,sweep,claims} \
      stages/cost pipeline/memory docs/examples | sort -u
    printf '%s\n' '"h.json"' '"memory_system.' '"hardware.' '{}' '[]' -1 1e308 1e-308 18446744073709551615 null true ../
  } | sed 's/"/\\"/g; s/.*/"&"/'
  echo '"\x00"'
} | tee "$TMPDIR/config.dict" >"$TMPDIR/results.dict"
# Inputs to start from: the corpus, a sweep with its hardware, and results that the program makes now.
seeds=$TMPDIR/seeds
cp -r tests/fuzz/corpus "$seeds"
{
  sed 's/"hardware.json"/"h.json"/' docs/examples/sweep.json
  printf '\0'
  cat docs/examples/hardware.json
} >"$seeds/config/grid"
in_one_line() {
  python3 -c 'import json, sys; print(json.dumps(json.load(sys.stdin), separators=(",", ":"), ensure_ascii=False))' <"$1"
}
if [[ " ${targets[*]} " == *" results "* ]]; then
  # To configure it once more would reset the options of its build.
  [[ -e build/release/build.ninja ]] || cmake --preset release >/dev/null
  cmake --build --preset release --parallel "$(nproc)" --target beampipe
  program=build/release/tools/beampipe trace=$PWD/traces/samples/two_quads.json
  mkdir -p "$seeds/results"
  "$program" compare "$trace" -t beam -o "$TMPDIR/compared" --inspect-worst 1 >/dev/null
  echo '{"beampipe_sweep":1,"traces":["'"$trace"'"],"techniques":["msaa:1"]}' >"$TMPDIR/plan.json"
  "$program" sweep "$TMPDIR/plan.json" -o "$TMPDIR/swept" >/dev/null
  {
    in_one_line "$TMPDIR/compared/report.json"
    printf '\0'
    in_one_line "$TMPDIR/compared/beam/inspections.json"
    printf '\0\0'
    in_one_line "$TMPDIR"/swept/cells/*.json
  } >"$seeds/results/compared"
  "$program" run "$trace" -t msaa:1 --no-memory-model -o "$TMPDIR/run" >/dev/null
  in_one_line "$TMPDIR/run/report.json" >"$seeds/results/run"
fi
most_bytes=98304  # a seed that is longer would be cut
if [[ $(find "$seeds" -type f -size +"$most_bytes"c) ]]; then
  echo "tests/fuzz/run.sh: a seed is longer than $most_bytes bytes" >&2
  exit 1
fi
# Runs one target, and then prints what it said.
run_target() {
  local target=$1 seconds=$2 most_bytes=$3 found=build/fuzz/found/$1 dictionary=tests/fuzz/$1.dict options=() said status=0
  [[ ! -e $TMPDIR/$target.dict ]] || dictionary=$TMPDIR/$target.dict
  [[ ! -e $dictionary ]] || options=(-dict="$dictionary")
  mkdir -p "$found"
  said=$(build/fuzz/tests/fuzz/"${target}_fuzz" "$found" "$TMPDIR/seeds/$target" "${options[@]}" \
    -max_total_time="$seconds" -max_len=$most_bytes -rss_limit_mb=2048 -timeout=20 -artifact_prefix="build/fuzz/${target}-" \
    -print_final_stats=1 -verbosity=0 2>&1) || status=$?
  printf '== %s: %s s\n%s\n' "$target" "$seconds" "$said"
  return "$status"
}
export -f run_target
# Each takes one core.
printf '%s\n' "${targets[@]}" | xargs --max-procs="$(nproc)" -I{} bash -c 'run_target {} "$@"' - "$seconds" "$most_bytes"
