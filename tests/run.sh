#!/usr/bin/env bash
# Installs packages, builds (the benchmarks too), and runs all tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/install_packages.sh
cmake --preset release -DBEAMPIPE_TESTS=ON -DBEAMPIPE_BENCH=ON
cmake --build --preset release --parallel "$(nproc)"
ctest --preset release --parallel "$(nproc)"
tests/fuzz/run.sh 20
