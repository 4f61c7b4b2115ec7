#!/usr/bin/env bash
# Installs the Debian packages that beampipe is built from, those that are missing. Does nothing when all are there.
set -euo pipefail

packages=(
  g++ cmake ninja-build
  libglm-dev libopenexr-dev libimath-dev libhwy-dev libtbb-dev libpng-dev libtinyobjloader-dev
  libcli11-dev nlohmann-json3-dev
  gnuplot-nox                       # draws the plots, when the program runs
  node-d3                           # draws the plots of the report page
  chromium chromium-driver python3  # test the report page
  libboost-dev                      # headers: exact arithmetic
  libgtest-dev libbenchmark-dev
  clang-14 libclang-rt-14-dev       # fuzz targets
)

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
((${#missing[@]} == 0)) && exit 0

if ! command -v apt-get >/dev/null; then
  echo "install_packages.sh: no apt-get here; install what these Debian packages hold: ${missing[*]}" >&2
  exit 1
fi
as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "install_packages.sh: run as root, or install first: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "Installing packages: ${missing[*]}"
"${as_root[@]}" apt-get -qq update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends "${missing[@]}"
