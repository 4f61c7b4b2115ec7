#!/usr/bin/env bash
# From nothing to a first comparison: installs packages, builds, makes a chain-link fence, and compares beam with MSAA on it.
# Results go to out/demo, or to the folder that is named as the argument.
set -euo pipefail

output=$(realpath --canonicalize-missing "${1:-"$(dirname "${BASH_SOURCE[0]}")/../out/demo"}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/install_packages.sh
cmake --preset release
cmake --build --preset release --target beampipe --parallel "$(nproc)"

build/release/tools/beampipe make fence -o "$output/fence.json"
build/release/tools/beampipe compare "$output/fence.json" -t beam beam:rules=paper alpha msaa:1,8,32,256 -o "$output"
