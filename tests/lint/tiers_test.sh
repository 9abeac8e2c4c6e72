#!/usr/bin/env bash
# tests/tiers.sh on a run of four tests, with a ctest of its own: tiers_test.sh SOURCES
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/ctest" <<'FAKE'
#!/bin/sh
echo '  Test   #1: io.Log.IsRead'
echo '  Test  #12: io.Names."q".AreKept'
echo '  Test #123: web.Page.Opens'
case "$*" in *'-C Soak') echo '  Test #124: io.Log.SoakIsRead' ;; esac
FAKE
chmod +x "$work/ctest"
results() {  # results STATUS
  printf '<testsuite name="(empty)"\n\ttests="4"\n\ttime="7"\n\t>\n'
  printf '\t<testcase name="io.Log.IsRead" classname="x" time="1.25" status="run">\n\t</testcase>\n'
  printf '\t<testcase name="io.Names.&quot;q&quot;.AreKept" classname="x" time="0.5" status="%s">\n\t</testcase>\n' "$1"
  printf '\t<testcase name="io.Log.SoakIsRead" classname="x" time="3" status="run">\n\t</testcase>\n</testsuite>\n'
}
told() {  # told WORDS: the report says so
  grep -qF "$1" "$work/report" || { echo "the report does not say $1:"; cat "$work/report"; exit 1; } >&2
}
report() { PATH="$work:$PATH" "$sources/tests/tiers.sh" "$work" >"$work/report"; }
sources=$1
results run >"$work/tests.xml"
report
told '{"room":"io","default tier, tests":2,"default tier, s":1.8,"soak tier adds, tests":1,"soak tier adds, s":3.0},'
told '{"room":"web","default tier, tests":1,"default tier, s":null,"soak tier adds, tests":0,"soak tier adds, s":null},'
told '{"room":"all","default tier, tests":3,"default tier, s":1.8,"soak tier adds, tests":1,"soak tier adds, s":3.0}'
told '"rows":[{"test":"io.Log.SoakIsRead","s":3.0},'
told '{"test":"io.Names.\"q\".AreKept","s":0.5}]'
told 'this run of 3 took 7 s of wall time'
told '"figure":0,"kind":"at most","bound":0,"holds":true'
results fail >"$work/tests.xml"
report
told '"figure":1,"kind":"at most","bound":0,"holds":false'
rm "$work/tests.xml"
if report 2>"$work/said"; then echo "a run that is not there is taken" >&2; exit 1; fi
grep -q 'run ./mortise test first' "$work/said"
echo "tests are counted by room and tier"
