#!/usr/bin/env bash
# Installs all packages, builds everything (the benchmarks too), and runs all tests: tests/run.sh [CMake options...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/install_packages.sh test
# Sources are compiled several together, which is faster.
cmake --preset release -DBEAMPIPE_BENCH=ON -DCMAKE_UNITY_BUILD=ON "$@"
cmake --build --preset release --parallel "$(nproc)"
ctest --preset release --parallel "$(nproc)"
