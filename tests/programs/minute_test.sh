#!/usr/bin/env bash
# The first minute of a newcomer: a folder of programs, unpacked anywhere, two STL files and one command give a verdict and its picture:
# minute_test.sh BIN. The seconds that it took are said, and held to their bound in a soak alone (MORTISE_EFFORT).
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/release" "$work/my parts"
cp "$1"/mortise-{judge,import,inspect,generate} "$work/release"
export PATH=$work/release:$PATH
cd "$work/my parts"
mortise-generate plate_with_bore bore_mm=20 facets=32 -o plate.stl
mortise-generate dowel diameter_mm=20 length_mm=40 chamfer_mm=1 facets=32 phase_rad=0.098 -o peg.stl
fail() { echo "FAILED: $*"; cat said 2>/dev/null; exit 1; }

start=$(date +%s%N)
mortise-judge plate.stl peg.stl --fit H7/p6 --picture verdict.png >said 2>&1 || fail "exit $?"
took_ms=$((($(date +%s%N) - start) / 1000000))
grep -q '^REAL  *plate × peg .*H7/p6' said || fail "the fit is not named"
grep -q 'real' said || fail "no verdict"
[ "$(head -c 4 verdict.png | tail -c 3)" = PNG ] || fail "no picture"
[ "$(ls)" = "$(printf '%s\n' peg.stl plate.stl said verdict.png)" ] || fail "left behind: $(ls)"
[ "${MORTISE_EFFORT:-1}" -le 1 ] || [ "$took_ms" -le 10000 ] || fail "it took $took_ms ms, more than 10 s"

# To go on with: a scenario of the same, which judges as it stands.
mortise-inspect plate.stl peg.stl >scene.yaml 2>said || fail "inspect: exit $?"
mortise-judge scene.yaml --fail-on real >said 2>&1 || fail "scene.yaml: exit $?"
echo "verdict and picture after $took_ms ms"
