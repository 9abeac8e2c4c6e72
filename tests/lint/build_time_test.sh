#!/usr/bin/env bash
# The report of tests/bench/build_time.sh, with programs of its own in place of CMake, ninja and ctest: build_time_test.sh SOURCES
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/bin" "$work/tests/bench" "$work/common/depth"
cp "$1/tests/bench/build_time.sh" "$work/tests/bench/"
printf '#!/bin/sh\nmkdir -p somewhere\n' >"$work/bin/cmake"
printf '#!/bin/sh\nexit 0\n' >"$work/bin/ninja"
cp "$work/bin/ninja" "$work/bin/ctest"
chmod +x "$work/bin/"*
cd "$work"
PATH="$work/bin:$PATH" tests/bench/build_time.sh somewhere --json report.json >said
steps=$(grep -oE '"step":"[a-z]+","wall s":[0-9.]+,"CPU s":[0-9.]+,"build, MB":[0-9]+' report.json | cut -d'"' -f4 | xargs)
[ "$steps" = "demo test depth" ] || { echo "steps of the report: $steps" >&2; cat report.json >&2; exit 1; }
bars=$(grep -oE '"name":"[a-z]+, wall s","figure":[0-9.]+,"kind":"at most","bound":[0-9]+,"holds":true' report.json | grep -oE '"bound":[0-9]+' | cut -d: -f2 | xargs)
[ "$bars" = "240 900 60" ] || { echo "bars of the report: $bars" >&2; cat report.json >&2; exit 1; }
if command -v python3 >/dev/null; then python3 -c 'import json; json.load(open("report.json"))'; fi
echo "the report has three steps and their bars"
