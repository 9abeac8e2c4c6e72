#!/usr/bin/env bash
# tests/tiers.sh BUILD [RESULTS.xml]: how many tests of each room are in which tier, and how long they took in a run that ctest wrote by
# --output-junit (default: BUILD/tests.xml), as a report that tests/bench/figures keeps. Tiers are what ctest lists without and with -C Soak.
set -euo pipefail
[ $# -ge 1 ] && [ $# -le 2 ] || { echo "usage: $0 BUILD [RESULTS.xml]" >&2; exit 2; }
build=$1 results=${2:-$1/tests.xml}
[ -r "$results" ] || { echo "$results: there is none; run ./mortise test first" >&2; exit 1; }
listed() { ctest --test-dir "$build" -N "$@" | sed -n 's/^ *Test *#[0-9]*: \(.*\)$/\1/p'; }
awk '
  function attribute(key) { return match($0, " " key "=\"[^\"]*\"") ? substr($0, RSTART + length(key) + 3, RLENGTH - length(key) - 4) : "" }
  function room_of(test) { sub(/[.].*/, "", test); return test }
  function add(test, tier,   room) {
    if (test in tier_of) return
    tier_of[test] = tier
    room = room_of(test)
    if (!(room in known)) { known[room] = 1; rooms[++count] = room }
    ++tests[room, tier]; ++tests["all", tier]
  }
  function cell(room, tier) { return (room, tier) in ran ? sprintf("%.1f", seconds[room, tier]) : "null" }
  function row(room) {
    return sprintf("{\"room\":\"%s\",\"default tier, tests\":%d,\"default tier, s\":%s,\"soak tier adds, tests\":%d,\"soak tier adds, s\":%s}", room,
                   tests[room, "default"], cell(room, "default"), tests[room, "soak"], cell(room, "soak"))
  }
  FILENAME == ARGV[1] { add($0, "default"); next }
  FILENAME == ARGV[2] { add($0, "soak"); next }
  /^\ttime="/ { wall = $0; gsub(/[^0-9.]/, "", wall) }
  /^\t<testcase / {
    test = attribute("name"); time = attribute("time")
    gsub(/&quot;/, "\"", test); gsub(/&lt;/, "<", test); gsub(/&gt;/, ">", test); gsub(/&amp;/, "\\&", test)
    room = room_of(test); tier = tier_of[test]
    if (tier == "") { ++unlisted; next }
    if (attribute("status") == "fail") ++failed
    ++ran[room, tier]; ++ran["all", tier]; ++all
    seconds[room, tier] += time; seconds["all", tier] += time
    # The slowest ten, kept in order.
    for (at = slow < 10 ? ++slow : 11; at > 1 && time + 0 > slow_s[at - 1]; --at) { slow_s[at] = slow_s[at - 1]; slow_test[at] = slow_test[at - 1] }
    if (at <= 10) { slow_s[at] = time + 0; slow_test[at] = test }
  }
  END {
    printf "{\"tables\":[{\"title\":\"Tests by room and tier\",\"rows\":["
    for (i = 1; i <= count; ++i) printf "%s,\n", row(rooms[i])
    printf "%s]},\n{\"title\":\"The slowest of this run\",\"rows\":[", row("all")
    for (i = 1; i <= slow; ++i) {
      gsub(/["\\]/, "\\\\&", slow_test[i])
      printf "%s{\"test\":\"%s\",\"s\":%.1f}", (i > 1 ? ",\n" : ""), slow_test[i], slow_s[i]
    }
    printf "]}],\n\"notes\":[\"Seconds are those of the tests, which run beside each other: this run of %d took %d s of wall time. ", all, wall
    printf "A dash: not in this run.%s\"],\n", unlisted ? sprintf(" %d tests of it are in no tier: they are of another build.", unlisted) : ""
    printf "\"bars\":[{\"name\":\"tests that failed\",\"figure\":%d,\"kind\":\"at most\",\"bound\":0,\"holds\":%s}]}\n", failed, failed ? "false" : "true"
  }' <(listed) <(listed -C Soak) "$results"
