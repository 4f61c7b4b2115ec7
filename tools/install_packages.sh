#!/usr/bin/env bash
# Installs the Debian packages of one set that are not installed yet: tools/install_packages.sh build|capture|test
#   build    what the program needs to be built and to run
#   capture  what `beampipe capture` runs
#   test     everything in `build` and `capture`, and what the tests, the fuzz targets and the benchmarks need
set -euo pipefail

build=(
  g++ cmake ninja-build
  libglm-dev libopenexr-dev libimath-dev libhwy-dev libtbb-dev libpng-dev zlib1g-dev liblzma-dev
  libjpeg62-turbo-dev libturbojpeg0-dev libtinyobjloader-dev libtinygltf-dev
  libcli11-dev nlohmann-json3-dev
  libsqlite3-dev
  spirv-tools spirv-headers  # reads the shaders of captured programs
  libboost-dev  # only headers: exact arithmetic
  node-d3       # D3, which becomes part of the report page
  pybind11-dev python3-dev python3-numpy  # the Python module
  python3-matplotlib                      # `beampipe figure`
  gnuplot-nox                             # the plots of `beampipe plot` and `beampipe report`
)
capture=(
  renderdoc python3-renderdoc python3-numpy
  python3-pil  # compressed textures
  mesa-vulkan-drivers libgl1-mesa-dri xvfb  # to capture without a GPU and a display
  mesa-utils   # glxgears, the example
)
test=(
  chromium chromium-driver python3  # tests of the report page
  python3-jsonschema                # holds results to their JSON Schemas
  python3-skimage                   # another SSIM
  python3-pip python3-venv          # installs the wheel
  python3-nbconvert python3-ipykernel  # runs the notebook
  git make  # for the list of sources, and for projects outside the tree
  libgtest-dev libbenchmark-dev
  libvulkan-dev mesa-vulkan-drivers  # holds shaders to Mesa's lavapipe
  clang libclang-rt-dev             # fuzz targets
  assimp-testmodels                 # glTF models that other programs wrote, sound and broken ones
  "${capture[@]}"
  vulkan-tools glmark2-es2-x11  # programs to capture
)

case ${1:-} in
  build) packages=("${build[@]}") ;;
  capture) packages=("${capture[@]}") ;;
  test) packages=("${build[@]}" "${test[@]}") ;;
  *)
    echo "usage: tools/install_packages.sh build|capture|test" >&2
    exit 2
    ;;
esac

missing=()
for package in $(printf '%s\n' "${packages[@]}" | sort -u); do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
((${#missing[@]} == 0)) && exit 0

if ! command -v apt-get >/dev/null; then
  echo "install_packages.sh: apt-get is missing. Please install the contents of these Debian packages: ${missing[*]}" >&2
  exit 1
fi
as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "install_packages.sh: sudo is missing. As root: apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "Installing packages, which takes a few minutes: ${missing[*]}"
"${as_root[@]}" apt-get -qq update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 install -y \
  --no-install-recommends "${missing[@]}" >/dev/null
