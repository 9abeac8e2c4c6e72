#!/usr/bin/env bash
# What the load model is read from: a short run of capacity.sh has the table that it promises, and what cannot be is refused:
# capacity_test.sh BIN. Figures are looked at for whether they can be, not for how good they are.
set -euo pipefail
bin=$1 script=$(dirname "$0")/capacity.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CAPACITY_WARM_S=1
fail() { echo "FAILED: $*"; cat "$work"/*.txt; exit 1; }

# table ROWS FILE: a line of six cells for each row, with as many users as it says, whose figures can be
table() {
  awk -F' *[|] *' -v rows="$1" '
    /^load average [0-9.]+, [0-9]+ processors, 1 s each$/ { ++heads; next }
    $2 == "session" || /^[|]--/ { ++heads; next }
    NF != 8 { print "not a row: " $0; bad = 1; next }
    {
      ++seen
      for (i = 3; i <= 7; ++i) if ($i !~ /^[0-9]+([.][0-9])?$/) { print "no figure: " $i; bad = 1 }
      if ($3 != ($2 == "nobody" ? 0 : $2 ~ /^one process/ ? 4 : 8)) { print "users: " $0; bad = 1 }
      if ($7 < 5) { print "a server without memory: " $0; bad = 1 }
      if ($4 > 400) { print "more than its cores: " $0; bad = 1 }
      if ($3 > 0 && ($5 == 0 || $6 < 20)) { print "users who do nothing: " $0; bad = 1 }
    }
    END { if (heads != 3 || seen != rows) { print heads " lines above, " seen " rows"; bad = 1 } exit bad }' "$2"
}
"$script" "$bin" 1 'nobody|one process|with keys' >"$work/table.txt" 2>"$work/errors.txt" || fail "capacity.sh"
table 3 "$work/table.txt" || fail "the table"
cat "$work/table.txt"

# What reads the table sees what is wrong with one.
for broken in '/keys/d' 's/ [0-9.]* |$/ |/' 's/| 4 |/| 5 |/' 's/ [0-9]* |$/ 0 |/' 's/^load.*/load/'; do
  sed "$broken" "$work/table.txt" >"$work/broken.txt"
  ! table 3 "$work/broken.txt" >/dev/null || fail "not seen: $broken"
done

refuses() {  # refuses CODE WORDS ARGUMENTS…
  local wanted=$1 words=$2 code=0
  shift 2
  "$script" "$@" >"$work/refused.txt" 2>&1 || code=$?
  { [ "$code" -eq "$wanted" ] && grep -q -- "$words" "$work/refused.txt"; } || fail "exit code $code instead of $wanted: capacity.sh $*"
}
refuses 2 'is no number of seconds' "$bin" 0
refuses 2 'is no number of seconds' "$bin" soon
refuses 2 'there is no mortise-server' "$work" 1
refuses 2 'no row is called' "$bin" 1 'ten thousand users'
# Programs that fail measure nothing.
mkdir "$work/bin"
ln -s "$(realpath "$bin")"/mortise-* "$work/bin/"
ln -sf "$(type -P false)" "$work/bin/mortise-bot"
refuses 1 'a bot did not join' "$work/bin" 1 'one process'
ln -sf "$(realpath "$bin/mortise-bot")" "$work/bin/mortise-bot"
ln -sf "$(type -P false)" "$work/bin/mortise-server"
refuses 1 'the server has ended' "$work/bin" 1 nobody
