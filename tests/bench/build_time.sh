#!/usr/bin/env bash
# How long mortise takes to build, without ccache, by two jobs, in a folder of its own: tests/bench/build_time.sh [FOLDER] [--json REPORT]
#   demo    configure, and build what ./mortise demo runs               bar 240 s
#   test    the rest of ./mortise test: build what is missing, run all  bar 900 s with demo's build
#   depth   one source of common/depth changed, to the end of its tests bar  60 s
# Tests run with three places a core, as ./mortise test runs them (tests/cases.cmake says who takes how many).
# REPORT is what bench_figures keeps: ./mortise bench build_time.
# Wall time is right on a machine that does nothing else; CPU / 2 is what two cores need at least. Exit code 5: a bar is not
# met; 1: a build or a test failed.
set -euo pipefail
build= report=
while [ $# -gt 0 ]; do
  case $1 in
    --json) report=$(realpath -m "${2:?--json wants a file}"); shift 2 ;;
    -*) echo "unknown option $1; there is --json REPORT" >&2; exit 2 ;;
    *) build=$1; shift ;;
  esac
done
cd "$(dirname "$0")/../.."
build=${build:-build/time}
[ ! -e "$build" ] || { echo "$build is there already: remove it first" >&2; exit 2; }
export CCACHE_DISABLE=1 MORTISE_DATA=${MORTISE_DATA:-$PWD/../shared/data}
log=$(mktemp)
trap 'rm -f "$log"' EXIT
missed=0 before=0 rows= bars=

measure() {  # measure NAME BAR_S STEP: seconds of `before` count as well
  local name=$1 bar=$2 code=0 wall user sys times
  shift 2
  times=$( { TIMEFORMAT='%R %U %S'; time "$@" >"$log" 2>&1; } 2>&1) || code=$?
  read -r wall user sys <<<"$times"
  [ "$code" -eq 0 ] || { tail -n 40 "$log" >&2; echo "$name: exit code $code" >&2; exit 1; }
  awk -v name="$name" -v wall="$wall" -v cpu="$(awk "BEGIN { print $user + $sys }")" -v bar="$bar" -v before="$before" 'BEGIN {
    met = before + wall <= bar
    printf "%-6s %7.1f s wall  %7.1f s CPU  %7.1f s CPU / 2  bar %4d s  %s\n", name, wall, cpu, cpu / 2, bar, met ? "met" : "NOT MET"
    exit !met
  }' || missed=1
  before=$(awk "BEGIN { print $before + $wall }")
  tell "$name" "$wall" "$(awk "BEGIN { print $user + $sys }")" "$bar"
}

tell() {  # tell NAME WALL_S CPU_S BAR_S: for the report, with the size of the build so far
  local megabytes
  megabytes=$(du -sm "$build" | cut -f1)
  rows+=${rows:+,}$(printf '{"step":"%s","wall s":%s,"CPU s":%s,"build, MB":%d}' "$1" "$2" "$3" "$megabytes")
  bars+=${bars:+,}$(awk -v name="$1" -v s="$before" -v bar="$4" 'BEGIN {
    printf "{\"name\":\"%s, wall s\",\"figure\":%.1f,\"kind\":\"at most\",\"bound\":%d,\"holds\":%s}", name, s, bar, s <= bar ? "true" : "false" }')
}

write_report() {
  [ -n "$report" ] || return 0
  printf '{"tables":[{"title":"Build without ccache, by two jobs","rows":[%s]}],"notes":["%s"],"bars":[%s]}\n' "$rows" \
    "Cold, with $(c++ --version | head -n 1), load $(cut -d' ' -f1 /proc/loadavg) at the end. The bar of test counts the build of demo as well." "$bars" >"$report"
}

# Steps are joined by &&, because set -e does not act in what is followed by ||.
demo() {
  cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DMORTISE_TESTS=OFF &&
    ninja -C "$build" -j 2 mortise-server mortise-bot
}
tests() {
  cmake -S . -B "$build" -DMORTISE_TESTS=ON &&
    ninja -C "$build" -j 2 &&
    ctest --test-dir "$build" --output-on-failure -j 6 --resource-spec-file "$PWD/tests/resources.json" --output-junit tests.xml
}
depth() {
  touch common/depth/patch.cpp &&
    ninja -C "$build" -j 2 test_depth &&
    ctest --test-dir "$build" --output-on-failure -j 6 -L '^depth$'
}

echo "$(nproc) cores, load $(cut -d' ' -f1 /proc/loadavg), $(c++ --version | head -n 1)"
measure demo 240 demo
measure test 900 tests
before=0
measure depth 60 depth
write_report
[ "$missed" -eq 0 ] || exit 5
