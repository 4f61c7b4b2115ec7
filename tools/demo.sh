#!/usr/bin/env bash
# Installs what the program needs, builds it, makes the scene of a chain-link fence, and compares beam with multisampling
# on it. The results go to out/demo, or to the folder given as the argument.
set -euo pipefail

output=$(realpath --canonicalize-missing "${1:-"$(dirname "${BASH_SOURCE[0]}")/../out/demo"}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/install_packages.sh build
cmake --preset release -DBEAMPIPE_TESTS=OFF -DCMAKE_UNITY_BUILD=ON
cmake --build --preset release --target beampipe beampipe_python --parallel "$(nproc)"

build/release/tools/beampipe make fence -o "$output/fence.json"
build/release/tools/beampipe compare "$output/fence.json" -t beam casav alpha msaa:1,8,32,256 -o "$output"
build/release/tools/beampipe report "$output"
echo "pictures: $output/*/frame_0000.png"
