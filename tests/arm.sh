#!/usr/bin/env bash
# Builds the tests for 64-bit Arm and runs them in an emulator: tests/arm.sh [FOLDER]
#
# The pictures and counters that they find must be those of x86: `Digests` compares them with the same file. FOLDER
# (build/arm) gets Debian's libraries for Arm, which are unpacked and not installed, and the build. Needed first:
#   dpkg --add-architecture arm64 && apt-get update
#   apt-get install g++-aarch64-linux-gnu qemu-user-static
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
folder=$(realpath -m "${1:-$source/build/arm}")
root=$folder/root
libraries=$root/usr/lib/aarch64-linux-gnu

for program in aarch64-linux-gnu-g++ qemu-aarch64-static; do
  if ! command -v "$program" >/dev/null; then
    echo "arm.sh: $program is missing; the head of this file says how to install it" >&2
    exit 1
  fi
done

if [[ ! -e $root/complete ]]; then
  mkdir -p "$folder/packages" "$root/lib"
  (
    cd "$folder/packages"
    for_arm=(
      libhwy1 libhwy-dev libopenexr-3-1-30 libopenexr-dev libimath-3-1-29 libimath-dev libtbb12 libtbb-dev libtbbmalloc2
      libtbbbind-2-5 libpng16-16 libpng-dev zlib1g zlib1g-dev liblzma5 liblzma-dev
      libjpeg62-turbo libjpeg62-turbo-dev libturbojpeg0 libturbojpeg0-dev libtinyobjloader2rc10 libtinyobjloader-dev
      libtinygltf2d libtinygltf-dev libstb0 libsqlite3-0 libsqlite3-dev libboost1.74-dev libgtest-dev spirv-tools
    )
    apt-get download "${for_arm[@]/%/:arm64}" libglm-dev nlohmann-json3-dev libcli11-dev spirv-headers
    for package in *.deb; do dpkg-deb --extract "$package" "$root"; done
  )
  cp -r /usr/share/nodejs "$root/usr/share/"  # D3, which becomes part of the report page
  # Some links and CMake files name the folder where the packages would be installed.
  cp -a "$root"/lib/aarch64-linux-gnu/. "$libraries/"
  ln -sf libz.so.1 "$libraries/libz.so"
  sed -i "s|\"/usr/lib/aarch64|\"$root/usr/lib/aarch64|; s|\"/usr/include|\"$root/usr/include|" \
    "$libraries"/cmake/libjpeg-turbo/*Targets*.cmake
  # Imath's CMake file asks for the library of its Python module, which is in a package of its own.
  touch "$libraries/libPyImath_Python3_11-3_1.so.29.5.0"
  touch "$root/complete"
fi

emulator="qemu-aarch64-static;-L;/usr/aarch64-linux-gnu;-E;LD_LIBRARY_PATH=$libraries"
cmake -G Ninja -S "$source" -B "$folder/build" -DCMAKE_BUILD_TYPE=Release -DBEAMPIPE_TESTS=ON -DCMAKE_UNITY_BUILD=ON \
  -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++ \
  -DCMAKE_C_COMPILER=aarch64-linux-gnu-gcc -DCMAKE_LIBRARY_ARCHITECTURE=aarch64-linux-gnu \
  -DCMAKE_FIND_ROOT_PATH="$root" -DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY \
  -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=ONLY \
  -DCMAKE_CROSSCOMPILING_EMULATOR="$emulator" -DCMAKE_EXE_LINKER_FLAGS="-Wl,-rpath-link,$libraries"
cmake --build "$folder/build" --parallel "$(nproc)" --target {simd,traces,stages,spirv,programs,pipeline,tools}_tests

cd "$source"
failed=0
for run in {simd,traces,stages,spirv,programs,pipeline}_tests "tools_tests --gtest_filter=Digests.*"; do
  # shellcheck disable=SC2086  # a program and its option
  ${emulator//;/ } "$folder"/build/tests/$run --gtest_brief=1 || failed=1
done
exit $failed
