#!/usr/bin/env bash
# Builds with sanitizers and runs all tests under them: tests/sanitizers.sh address|thread [ctest options...]
#   address  AddressSanitizer, UndefinedBehaviorSanitizer and LeakSanitizer
#   thread   ThreadSanitizer, which needs a oneTBB that is built with it: Debian's source, fetched and built into
#            build/tsan/tbb. Kernels are built for the baseline instruction set only, because threads do the same work
#            with every instruction set.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Fetches and builds Debian's source of oneTBB. No root is needed, because apt gets its own lists of the known archives.
build_tbb() {
  local folder=$PWD/build/tsan/tbb lists
  [[ -d $folder/lib/cmake/TBB ]] && return
  mkdir -p "$folder/source/lists/partial"
  lists=$folder/source/debian.sources
  sed 's/^Types: deb$/Types: deb-src/' /etc/apt/sources.list.d/debian.sources >"$lists"
  local options=(-o Dir::Etc::SourceList="$lists" -o Dir::Etc::SourceParts=- -o Dir::State::Lists="$folder/source/lists"
                 -o APT::Sandbox::User="$(id -un)")
  cd "$folder/source"
  apt-get "${options[@]}" update
  apt-get "${options[@]}" source --download-only onetbb
  tar --extract --strip-components 1 --file onetbb_*.orig.tar.xz
  cmake -G Ninja -B build -DCMAKE_BUILD_TYPE=RelWithDebInfo -DTBB_SANITIZE=thread -DTBB_TEST=OFF -DTBB_STRICT=OFF \
    -DTBBMALLOC_BUILD=OFF
  cmake --build build
  cmake --install build --prefix "$folder"
  cd - >/dev/null
}

case ${1:-} in
  address)
    preset=asan options=()
    ;;
  thread)
    build_tbb
    preset=tsan options=(-DTBB_DIR="$PWD/build/tsan/tbb/lib/cmake/TBB")
    ;;
  *)
    echo "usage: tests/sanitizers.sh address|thread [ctest options...]" >&2
    exit 2
    ;;
esac
cmake --preset "$preset" -DCMAKE_UNITY_BUILD=ON "${options[@]}"
cmake --build --preset "$preset" --parallel "$(nproc)"
# Left out is the test that links programs without sanitizers against the libraries.
ctest --preset "$preset" --parallel "$(nproc)" --exclude-regex '^install$' "${@:2}"
