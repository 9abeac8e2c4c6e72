#!/usr/bin/env bash
# The script `mortise` in a folder of its own, where cmake, ninja, ctest, apt-get and npm only write down that they were called:
# mortise_script_test.sh SOURCE
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$1/mortise" "$1"/packages*.txt "$1/CMakeLists.txt" "$work"
mkdir -p "$work/bin" "$work/tests/bench" "$work/tests/unit/io/mcap_check/node_modules" "$work/client/tools/keys"
cp "$1/tests/summary.awk" "$work/tests"
touch "$work/tests/bench/session_bench.cpp"
for stub in cmake ninja ctest apt-get npm node chromium dpkg-query sudo; do
  printf '#!/bin/sh\necho "%s $*" >>%s/called\n' "$stub" "$work" >"$work/bin/$stub"
done
cat >>"$work/bin/cmake" <<'TXT'
[ "$1" = --preset ] || exit 0
mkdir -p "build/$2/bin"
touch "build/$2/build.ninja"
for option; do case $option in -D*) echo "$option" | sed 's/-D\(.*\)=/\1:BOOL=/' >>"build/$2/CMakeCache.txt" ;; esac; done
TXT
# Nothing to do where `fresh` is; otherwise a program is made that says its name and what it is given. The server of the demo ends
# once its bots have said theirs.
cat >>"$work/bin/ninja" <<'TXT'
folder=$2 # absolute
[ "$3" != -n ] || { [ ! -e "$folder/fresh" ] || echo 'ninja: no work to do.'; exit 0; }
shift 2
for target; do printf '#!/bin/sh\necho "ran %s $* in $PWD"\n' "$target" >"$folder/bin/$target"; chmod +x "$folder/bin/$target"; done
[ ! -e "$folder/bin/mortise-server" ] ||
  echo 'case $* in *" demo "*) until grep -qs ran sessions/*.bots.txt; do sleep 0.02; done ;; esac' >>"$folder/bin/mortise-server"
TXT
# Every package is there.
echo 'shift 2; for package; do echo "$package installed"; done' >>"$work/bin/dpkg-query"
echo 'echo 12' >>"$work/bin/node"
chmod +x "$work"/bin/*
export PATH=$work/bin:$PATH
cd "$work"

fail() { echo "FAILED: $*"; cat called 2>/dev/null; exit 1; }
exits() {  # exits CODE ARGUMENTS
  local wanted=$1 code=0
  shift
  rm -f called
  ./mortise "$@" >said 2>&1 || code=$?
  [ "$code" -eq "$wanted" ] || fail "./mortise $*: exit $code, not $wanted: $(cat said)"
}
called() { grep -qE -- "$1" called || fail "not called: $1"; }
not_called() { ! grep -qsE -- "$1" called || fail "called: $1"; }

# 1. what is wrong is said before anything is installed or built
for wrong in 'demo --bogus' 'demo --seconds' 'demo --seconds x' 'test --sanitize' 'test --sanitize memory' 'bench nosuch' nosuch; do
  # shellcheck disable=SC2086
  exits 2 $wrong
  [ ! -e called ] || fail "./mortise $wrong called something"
done

exits 0 help
for code in 0 1 2 3 4 5 6 7; do
  sed -n '/^Exit codes/,$p' said | tr '\n' ' ' | grep -qE "[ ,]$code [a-z]" || fail "help does not say what exit code $code is"
done

# 2. a program builds itself alone, without tests, and is not called stale
exits 0 lint some.yaml
grep -q 'ran mortise-lint some.yaml' said || fail "lint: $(cat said)"
called 'cmake --preset release -DMORTISE_TESTS=OFF'
called "^ninja -C $work/build/release mortise-lint\$"
exits 0 lint some.yaml
called "^ninja -C $work/build/release mortise-lint\$"
not_called '^cmake'
touch build/release/fresh
exits 0 lint some.yaml
not_called "^ninja -C $work/build/release mortise-lint\$"
grep -qx "ran mortise-lint some.yaml in $work" said || fail "more than the program is heard: $(cat said)"
rm build/release/fresh

# 3. the demo builds what it runs
exits 0 demo --seconds 3
called "^ninja -C $work/build/release mortise-server mortise-bot\$"

# a session that was saved goes on, the last one of a folder as well
touch saved.mcap
exits 0 open saved.mcap --seconds 3
grep -q "^ran mortise-server --restore saved.mcap --session assembly .* --log sessions/saved-.*[.]mcap" said || fail "open a saved session: $(cat said)"
mkdir kept
exits 1 open kept
touch -d '2 hours ago' kept/b.mcap
touch -d '1 hour ago' kept/a.mcap
exits 0 open kept --seconds 3
grep -q "^ran mortise-server --restore kept/a.mcap --session assembly " said || fail "open a folder: $(cat said)"
rm -r saved.mcap kept
# and so does a scenario that was saved as an archive, from the folder that it is unpacked to
touch saved.zip
exits 0 open saved.zip --seconds 3
grep -q "^ran mortise-replay unpack saved.zip --out sessions/saved-[0-9-]* in" said || fail "unpack a saved scenario: $(cat said)"
grep -q "^ran mortise-server sessions/saved-[0-9-]*/scenario.yaml --session assembly " said || fail "open a saved scenario: $(cat said)"
rm saved.zip

# files open a session with its page: server and gateway are of one session and log, and the server, which keeps the addresses at the
# bottom of the terminal, reads them where the gateway writes them, which is quiet
one_session() {  # one_session SCENARIO SESSION SECONDS
  local served
  served=$(grep -E "^ran mortise-server $1 --session $2 " said) || fail "no server of $1: $(cat said)"
  [[ $served =~ \ --domain\ ([0-9]+)\ --live\ --duration\ $3\ --log\ (sessions/[^ ]+)\.mcap\ --addresses\ ([^ ]+)\ in ]] || fail "how it serves: $served"
  [ "${BASH_REMATCH[3]}" = "${BASH_REMATCH[2]}.web.txt" ] || fail "where the server reads addresses: $served"
  grep -qx "ran mortise-web --session $2 --domain ${BASH_REMATCH[1]} --http-port 0 --read-log ${BASH_REMATCH[2]}.mcap --addresses ${BASH_REMATCH[3]} --quiet in $work" said ||
    fail "no gateway beside $served: $(cat said)"
}
touch A.stl B.stl x.step
exits 0 open A.stl B.stl --unit cm --seconds 3
called "^ninja -C $work/build/release mortise-server mortise-web mortise-import mortise-inspect\$"
one_session 'sessions/A-[0-9-]*[.]yaml' assembly 3
grep -qx "ran mortise-inspect --unit cm $work/A.stl $work/B.stl in $work" sessions/A-*.yaml || fail "the scenario of two meshes: $(cat sessions/A-*.yaml)"
exits 1 open A.stl none.stl
grep -q 'none.stl: there is no such file' said || fail "open a file that is not there: $(cat said)"
exits 0 open x.step --fix frame/base --seconds 3
called "^ninja -C $work/build/release mortise-import-step\$"
called "^ninja -C $work/build/release mortise-server mortise-web mortise-import mortise-check\$"
one_session 'sessions/x-[0-9-]*[.]yaml' assembly 3
grep -q "^ran mortise-check x.step --session sessions/x-[0-9-]*[.]yaml --fix frame/base in" said || fail "open a STEP assembly: $(cat said)"
exits 2 open x.step A.stl
rm -r A.stl B.stl x.step sessions
exits 0 demo --web --seconds 9
called "^ninja -C $work/build/release mortise-server mortise-bot mortise-web\$"
one_session "$work/scenarios/gearbox.yaml" demo 9
grep -qE "^ran mortise-bot --session demo .* --play $work/scenarios/gearbox.play.yaml --quiet --duration 7 --for-people in" sessions/gearbox-*.bots.txt ||
  fail "the bots of the demo wait for people, and their report is in a file: $(cat sessions/*.bots.txt)"
rm -r sessions

# packages are made with all that they may contain: STEP and Python as well
mkdir -p build/release/packages
touch build/release/packages/some.deb
exits 0 packages
called ' libocct-data-exchange-dev'
called ' pybind11-dev'
called "^ninja -C $work/build/release packages\$"

# 4. tests are configured when they are asked for; the long ones with --soak; then not again
exits 0 test -R some_name
called '^cmake --preset release -DMORTISE_TESTS=ON -DMORTISE_SOAK=OFF$'
called "^ninja -C $work/build/release all\$"
called "^ctest --test-dir $work/build/release .* -R some_name\$"
exits 0 test
not_called '^cmake'
exits 0 test --soak
called '^cmake --preset release -DMORTISE_SOAK=ON$'
called '^ctest .* -C Soak$'
exits 0 test --sanitize thread
called '^cmake --preset tsan '
called "^ninja -C $work/build/tsan sanitize-thread\$"
called '^ctest --test-dir .*/build/tsan .* -L \^sanitize-thread\$$'

# 5. the folder of the caller stays his: programs run there, with his paths, and only builds write into the checkout
his=$work/his
mkdir "$his"
before=$(cd "$work" && find . -path ./his -prune -o -path ./build -prune -o -print | sort)
(cd "$his" && exits_there() { "$work/mortise" "$@" >said 2>&1 || fail "mortise $* elsewhere: $(cat said)"; }
  exits_there judge scene.yaml --picture out.png
  grep -qx "ran mortise-judge scene.yaml --picture out.png in $his" said || fail "judge elsewhere: $(cat said)"
  exits_there demo --seconds 3
  grep -q "ran mortise-server $work/scenarios/gearbox.yaml .* --log sessions/.* in $his" said || fail "demo elsewhere: $(cat said)"
  [ -d sessions ] || fail "the demo's logs are not in the folder of its caller")
after=$(cd "$work" && find . -path ./his -prune -o -path ./build -prune -o -print | sort)
[ "$before" = "$after" ] || fail "written into the checkout: $(diff <(echo "$before") <(echo "$after"))"
called "^ninja -C $work/build/release mortise-server mortise-bot$"
ln -s "$work/mortise" "$his/link"
(cd "$his" && ./link lint a.yaml) | grep -q "ran mortise-lint a.yaml in $his" || fail "through a link"
exits 0 --version
grep -qx 'mortise [0-9.]*' said || fail "version: $(cat said)"

# 6. a command that there is not: the one that was meant
while read -r typed meant; do
  exits 2 $typed x
  grep -q "no such command: $typed; did you mean $meant?" said || fail "$typed: $(cat said)"
  [ "$(wc -l <said)" -eq 1 ] || fail "$typed: more than one line"
done <<'TXT'
clash judge
judg judge
lnit lint
sevrer server
a.stl judge
inspekt inspect
TXT

# 7. the last line of what was tested
cat >results.xml <<'TXT'
	<testcase name="a" classname="a" time="0.1" status="run">
	</testcase>
	<testcase name="b" classname="b" time="0.1" status="notrun">
		<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
		<system-out>[ RUN      ] B.B
/b.cpp:12: Skipped
data &lt;absent&gt;: set MORTISE_DATA
	</testcase>
	<testcase name="c" classname="c" time="0.1" status="notrun">
		<skipped message="SKIP_RETURN_CODE=77"/>
		<system-out>SKIPPED: not root: no network namespaces
	</testcase>
	<testcase name="d" classname="d" time="0.1" status="fail">
		<failure message="Subprocess aborted"/>
		<system-out>[ RUN      ] D.D
d.cpp:3: check failed: 1 &lt; 0: numbers
		</system-out>
	</testcase>
	<testcase name="e" classname="e" time="0" status="notrun">
		<skipped message="Unable to find executable"/>
	</testcase>
TXT
said=$(awk -f tests/summary.awk results.xml)
case $said in
  'mortise: 1 passed, 2 failed, 2 skipped: 1 data <absent>, 1 not root' | 'mortise: 1 passed, 2 failed, 2 skipped: 1 not root, 1 data <absent>') ;;
  *) fail "summary: $said" ;;
esac
awk -v tails=2 -f tests/summary.awk results.xml >said
grep -q '^failed: d, and printed' said && grep -q '^  d.cpp:3: check failed: 1 < 0: numbers' said || fail "ends of failed tests: $(cat said)"
! grep -q 'aborted' said || fail "more than two lines of a failed test"
awk -v report='Tests under a sanitizer' -f tests/summary.awk results.xml results.xml >report.json
for part in '{"room":"b","tests":2,"passed":0,"skipped":2,"failed":0,"seconds":0.2}' '"tests":10,"passed":2,"skipped":4,"failed":4,"seconds":0.8}' \
  '"notes":\["failed: d",' '"figure":4,"kind":"at most","bound":0,"holds":false'; do
  grep -q "$part" report.json || fail "report: no $part in $(cat report.json)"
done
echo "the script calls what it should"
