#!/usr/bin/env bash
# Captures the frames of docs/accuracy.md: docs/capture_frames.sh PROGRAM FOLDER [NAME...]
#
# PROGRAM is for instance beampipe. Each frame becomes FOLDER/NAME.json with its files; those that are there already stay.
# NAMEs are parts of the frames' names; without any, all are captured. Programs that are not installed are left out, and
# the Debian package that has them is named. Needs what `tools/install_packages.sh capture` installs.
set -euo pipefail

(($# >= 2)) || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
program=$(realpath "$1")
mkdir -p "$2"
folder=$(realpath "$2")
shift 2
names=("$@")
PATH=$PATH:/usr/games
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset DISPLAY                      # each frame has a virtual screen of its own
export HOME=$work SDL_AUDIODRIVER=dummy ALSOFT_DRIVERS=null  # settings as they are after installing; no sound

wanted() {  # NAME
  ((${#names[@]} == 0)) && return 0
  for part in "${names[@]}"; do [[ $1 == *"$part"* ]] && return 0; done
  return 1
}

frame() {  # NAME PACKAGE OPTIONS... -- COMMAND...
  local name=$1 package=$2 options=()
  shift 2
  while [[ $1 != -- ]]; do options+=("$1"); shift; done
  shift
  wanted "$name" && [[ ! -e $folder/$name.json ]] || return 0
  if ! command -v "$1" > /dev/null; then
    echo "$name: not captured: install the Debian package $package"
    return 0
  fi
  echo "$name:"
  # Some programs crash now and then as RenderDoc is loaded into them.
  for _ in 1 2 3; do
    "$program" capture "${options[@]}" -o "$folder/$name.json" -- "$@" && return 0
  done
  echo "$name: not captured"
}

# A bumpy sphere of 977,202 triangles.
dense_model() {  # FILE
  python3 - "$1" <<'PYTHON'
import sys
import numpy as np
side = 700
u, v = np.meshgrid(np.linspace(0, 2 * np.pi, side), np.linspace(0, np.pi, side))
radius = 1 + 0.05 * np.sin(23 * u) * np.sin(19 * v) + 0.02 * np.sin(71 * u) * np.sin(67 * v)
places = radius[..., None] * np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], -1)
at = np.arange(side * side).reshape(side, side)
a, b, c, d = (corner.ravel() for corner in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
corners = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
faces = np.zeros(len(corners), [("count", "u1"), ("corners", "<i4", 3)])
faces["count"], faces["corners"] = 3, corners
with open(sys.argv[1], "wb") as file:
    file.write(f"""ply
format binary_little_endian 1.0
element vertex {side * side}
property float x
property float y
property float z
element face {len(faces)}
property list uchar int vertex_indices
end_header
""".encode() + places.reshape(-1, 3).astype("<f4").tobytes() + faces.tobytes())
PYTHON
}

for scene in build texture shading bump jellyfish shadow refract terrain effect2d pulsar ideas buffer function conditionals \
  loop desktop; do
  frame "glmark2_$scene" glmark2-es2-x11 --after 4 -- glmark2-es2 -s 800x600 -b "$scene:duration=1000"
done
frame vkcube vulkan-tools --frame 200 -- vkcube
frame glxgears mesa-utils --frame 60 -- glxgears
frame neverball_menu neverball --after 12 -- neverball
frame neverball_level neverball --after 25 -- neverball /usr/share/games/neverball/map-easy/easy.sol
frame warzone2100_menu warzone2100 --after 30 -- warzone2100 --window --resolution=640x480 --nosound
frame warzone2100_game warzone2100 --after 60 --timeout 3000 -- warzone2100 --window --resolution=640x480 --nosound --game=CAM_1A
if wanted f3d_dense && command -v f3d > /dev/null; then dense_model "$work/dense.ply"; fi
frame f3d_dense f3d --after 10 -- f3d --up=+Z "$work/dense.ply"
