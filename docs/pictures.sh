#!/usr/bin/env bash
# Makes the pictures of the pages: docs/pictures.sh PROGRAM [MODELS]
#
# MODELS is the folder of the eight models of docs/accuracy.md. Without it, frontier.svg stays as it is: it takes a sweep
# over all scenes, which goes on where it was interrupted. Needs gnuplot for that figure and for report.png, which also
# needs Chromium; without that, it stays as it is. Traces and results stay in build/pictures.
set -euo pipefail

(($# == 1 || $# == 2)) || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
program=$(realpath "$1")
models=${2:+$(realpath "$2")}
docs=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mkdir -p "$docs/../build/pictures"
cd "$docs/../build/pictures"

# The fence: README.md, and a part of it in docs/findings.md.
"$program" make fence -o fence.json
"$program" run fence.json -t reference beam casav msaa:8 --no-memory-model --force -o fence
cp fence/beam/frame_0000.png "$docs/pictures/fence_beam.png"
cp fence/msaa_8/frame_0000.png "$docs/pictures/fence_msaa_8.png"
"$docs/detail.py" 120,40,60,50 4 fence/{reference,beam,casav,msaa_8}/frame_0000.png -o "$docs/pictures/fence_detail.png"

# Where the literal reading of casav errs most, in parts of this size: docs/accuracy.md.
for part in classroom:102,51,56,44 boat:65,109,56,44 hairball:120,37,56,44; do
  scene=${part%%:*}
  "$program" make "$scene" -o "$scene.json"
  "$program" run "$scene.json" -t reference casav:reading=literal casav msaa:32,256 --no-memory-model --force \
    -o "readings_$scene"
  "$docs/detail.py" "${part#*:}" 4 readings_"$scene"/{reference,casav_reading=literal,casav,msaa_32,msaa_256}/frame_0000.png \
    -o "$docs/pictures/${scene}_detail.png"
done

# Whole pictures, and parts of some: docs/shading.md.
for part in tiles: stairs:20,30,76,50 leaves:84,26,56,44 sheets:200,64,56,44 rigging:166,100,56,44; do
  scene=${part%%:*} places=${part#*:}
  "$program" make "$scene" -o "$scene.json"
  "$program" run "$scene.json" -t reference beam msaa:8,32 --no-memory-model --force -o "$scene"
  if [[ $scene != rigging ]]; then
    for technique in reference beam msaa_8 msaa_32; do
      cp "$scene/$technique/frame_0000.png" "$docs/pictures/${scene}_$technique.png"
    done
  fi
  if [[ -n $places ]]; then
    "$docs/detail.py" "$places" 4 "$scene"/{reference,beam,msaa_8,msaa_32}/frame_0000.png \
      -o "$docs/pictures/${scene}_detail.png"
  fi
done

# The worst pixel of the boat: docs/tutorial.md.
"$program" make boat -o boat.json
"$program" inspect boat.json --worst 1 -t beam -o "$docs/pictures/inspect_boat.svg" >inspect_boat.txt

# A report: docs/tutorial.md.
if command -v chromium >/dev/null; then
  "$program" compare fence.json -t beam beam:order=sorted casav acaa:8 msaa:8 --force -o report
  "$program" report report
  chromium --headless --no-sandbox --hide-scrollbars --window-size=1440,2480 \
    --screenshot="$docs/pictures/report.png" "file://$PWD/report/report.html" 2>/dev/null
fi

# The pipeline: CONTRIBUTING.md.
"$docs/pipeline_figure.py" "$program" "$docs/pictures/pipeline.svg"

# Bytes per pixel against EMR: docs/findings.md.
if [[ -n $models ]]; then
  "$docs/accuracy.py" sweep "$program" "$models" -o accuracy
  "$docs/accuracy.py" frontier accuracy/table.csv -o "$docs/pictures/frontier.svg"
fi
