#!/usr/bin/env bash
# Makes the packages of a build anew, for the tests that install them: make_packages.sh BUILD FOLDER
set -euo pipefail
build=$1 folder=$2
skip() { echo "SKIPPED: $*"; exit 77; }
for tool in dpkg-deb dpkg-shlibdeps cpack; do command -v "$tool" >/dev/null || skip "program absent: $tool"; done
[ -z "$(sed -n 's/^MORTISE_SANITIZE:[A-Z]*=//p' "$build/CMakeCache.txt")" ] || skip "sanitizer: a build with sanitizers is not packaged"
rm -rf "$folder"
mkdir -p "$folder"
python=$(grep -q '^build mortise_python:' "$build/build.ninja" && echo mortise_python || true)
# shellcheck disable=SC2086
cmake --build "$build" --target package_documents shared_libraries $python
cpack --config "$build/CPackConfig.cmake" -B "$folder"
rm -rf "$folder/_CPack_Packages"
for package in mortise-server mortise-tools mortise-web libmortise-{engine,io,client,dev} ${python:+python3-mortise}; do ls "$folder/$package"_*.deb; done
