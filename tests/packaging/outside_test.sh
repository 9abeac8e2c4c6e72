#!/usr/bin/env bash
# Programs of others on what is installed: outside_test.sh BUILD. Installs the library below a folder of its own, first the engine alone, builds
# client/api/examples there and runs them.
set -euo pipefail
build=$1
skip() { echo "[  SKIPPED ] $*"; exit 77; }
fail() { echo "FAILED: $*"; cat "$work/said.txt" 2>/dev/null || true; exit 1; }
[ -z "$(sed -n 's/^MORTISE_SANITIZE:[A-Z]*=//p' "$build/CMakeCache.txt")" ] || skip "sanitizer: a build with sanitizers is not installed"
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill -INT "$server" 2>/dev/null || true; rm -rf "$work"' EXIT
prefix=$work/prefix
say() { "$@" >"$work/said.txt" 2>&1; }
say cmake --build "$build" --target shared_libraries package_changelog sbom || fail "the shared libraries"
install() { for component in "$@"; do say cmake --install "$build" --prefix "$prefix" --component "$component" || fail "install $component"; done; }

# 1. the engine alone: six headers, which name Eigen and nothing else
install engine dev
examples=$prefix/share/doc/libmortise-dev/examples
headers=$(cd "$prefix/include" && find . -type f | sort | xargs)
[ "$headers" = "./mortise/client.h ./mortise/geometry.h ./mortise/io.h ./mortise/judge.h ./mortise/mortise.h ./mortise/session.h" ] || fail "installed: $headers"
others=$(echo '#include <mortise/mortise.h>' | g++ -std=c++20 -M -I"$prefix/include" -isystem /usr/include/eigen3 -x c++ - | tr ' \\' '\n\n' |
  grep '^/' | grep -vE "^($prefix/include/mortise|/usr/include/eigen3|/usr/include/c\+\+|/usr/lib/gcc|/usr/include/x86_64-linux-gnu|/usr/include/[a-z]+[a-z0-9_-]*\.h\$|/usr/include/(linux|asm|asm-generic)/)" || true)
[ -z "$others" ] || fail "the headers name more than Eigen: $others"
echo "six headers, which name Eigen alone"
# Nothing that the rooms are made of may be looked for.
hidden=()
for package in fcl fastrtps fastcdr yaml-cpp fmt zstd nlohmann_json assimp OpenSSL SQLite3 CLI11 spdlog Boost; do
  hidden+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON")
done
make_examples() {  # make_examples COMPONENTS FOLDER [OPTIONS]
  say cmake -S "$examples" -B "$2" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$prefix" -DCOMPONENTS="$1" "${hidden[@]}" "${@:3}" || return 1
  say cmake --build "$2"
}
version=$(sed -n 's/^CMAKE_PROJECT_VERSION:[A-Z]*=\([0-9]*\.[0-9]*\).*/\1/p' "$build/CMakeCache.txt")
make_examples engine "$work/engine" -DVERSION="$version" || fail "the example of the engine, version $version"
! make_examples engine "$work/older" -DVERSION="${version%.*}.$((${version#*.} - 1))" || fail "an older minor version was found"
say "$work/engine/thirty_lines" || fail "thirty_lines"
cat "$work/said.txt"
grep -q '^H7/g6: the peg stands at z = 5.000 mm$' "$work/said.txt" || fail "with H7/g6 the peg does not go in"
grep -qE '^H7/p6: the peg stands at z = 1[0-9]\.' "$work/said.txt" || fail "with H7/p6 the peg is not held"
! make_examples 'engine;client' "$work/early" || fail "a component that is not there was found"
grep -q 'install libmortise-client' "$work/said.txt" || fail "it is not said what to install"

# 2. all of it
install io client
make_examples 'engine;io;client' "$work/all" || fail "the examples"
export PATH=$build/bin:$PATH # the reader of meshes
mortise-generate plate_with_bore bore_mm=20 facets=32 -o "$work/plate.stl" >/dev/null
mortise-generate dowel diameter_mm=21 length_mm=40 facets=32 -o "$work/peg.stl" >/dev/null
code=0
say "$work/all/ten_lines" "$work/plate.stl" "$work/peg.stl" || code=$?
[ $code -eq 6 ] && grep -q 'real' "$work/said.txt" || fail "ten_lines: exit $code"
code=0
say "$work/all/ten_lines" "$work/none.stl" "$work/peg.stl" || code=$?
[ $code -eq 3 ] && grep -q 'no such file' "$work/said.txt" || fail "ten_lines, no file: exit $code"
echo "ten lines judge two files"
scenarios=$(dirname "$(readlink -f "$0")")/../../scenarios
domain=$((120 + $$ % 50))
mortise-server "$scenarios/gearbox.yaml" --session outside --domain $domain --log "$work/log.mcap" --quiet >"$work/server.txt" 2>&1 &
server=$!
say timeout 60 "$work/all/live_client" outside $domain || { cat "$work/server.txt"; fail "live_client"; }
grep -qx input_shaft "$work/said.txt" || fail "the live client does not see the parts"
echo "a live client sees $(grep -c . "$work/said.txt") parts"
kill -INT $server
wait $server || fail "the server"
server=
