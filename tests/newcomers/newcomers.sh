#!/usr/bin/env bash
# Runs what newcomers do, each in a folder of its own, with the commands of the READMEs: newcomers.sh SOURCE BUILD [--write] [NAMES…]
# Says the time of each command and what was seen. --write: keeps the times in TIMES.md; with NAMES, other rows there stay. In a soak one may take two minutes.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
export SOURCE=$1 BUILD=$2
shift 2
write=
[ "${1:-}" != --write ] || { write=yes; shift; }
all=(designer_stl designer_page designer_step python_user cpp_engineer test_engineer analyst)
names=("$@")
[ ${#names[@]} -gt 0 ] || names=("${all[@]}")
MORTISE_PRESET=$(basename "$BUILD")
export LC_ALL=C.UTF-8 MORTISE_PRESET DOMAIN=$((100 + $$ % 100)) PYTHONPATH=$BUILD/python PATH=$BUILD/bin:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
most_s=120

# What the scripts are written with.
run() {  # run COMMAND…: as a newcomer types it; output goes to `said`, a code other than 0 is of interest only when it is asked for
  local start code=0
  start=$(date +%s%N)
  echo "\$ $*"
  bash -c "$*" >said 2>errors || code=$?
  [ "$code" -eq "${wanted:-0}" ] || { cat said errors; echo "FAILED: exit $code"; exit 1; }
  echo "    $((($(date +%s%N) - start) / 1000000)) ms"
}
saw() {  # saw PATTERN [FILE]: a line of what was said
  local line
  line=$(grep -m 1 -aE -- "$1" "${2:-said}") || { cat said errors; echo "FAILED: nobody said $1"; exit 1; }
  echo "    $(sed -E 's/^ +//; s/ +/ /g; s/^(.{150}).+/\1…/' <<<"$line")"
}
made() { local file; for file; do [ -s "$file" ] || { echo "FAILED: there is no $file"; exit 1; }; echo "    $file, $(($(stat -c %s "$file") / 1024)) kB"; done; }
skip() { echo "SKIPPED: $*"; exit 77; }
export -f run saw made skip

declare -A rows
code=0
for name in "${names[@]}"; do
  mkdir "$work/$name"
  ln -s "$SOURCE/mortise" "$SOURCE/scenarios" "$work/$name"
  echo "== $(sed -n '2s/^# //p' "$here/$name.sh")"
  start=$(date +%s%N) done=0
  (cd "$work/$name" && bash -euo pipefail "$here/$name.sh") | tee "$work/$name.txt" || done=${PIPESTATUS[0]}
  took_ms=$((($(date +%s%N) - start) / 1000000))
  if [ $done -eq 77 ]; then [ $code -ne 0 ] || code=77; continue; fi
  [ $done -eq 0 ] || { code=1; continue; }
  echo "== $name: $((took_ms / 1000)).$((took_ms % 1000 / 100)) s"
  [ "${MORTISE_EFFORT:-1}" -le 1 ] || [ $took_ms -le $((most_s * 1000)) ] || { echo "FAILED: more than $most_s s"; code=1; }
  seen=$(grep '^    ' "$work/$name.txt" | grep -vE ' (ms|kB)$' | tail -n 1 | sed -E 's/^ +//; s/[|]//g; s/^(.{60}).+/\1…/')
  rows[$name]="| $(sed -n '2s/^# \([^:]*\):.*/\1/p' "$here/$name.sh") | \`$name\` | $(grep -c '^\$ ' "$work/$name.txt") | $((took_ms / 1000)).$((took_ms % 1000 / 100)) | \`$seen\` |"
done
if [ -n "$write" ] && [ $code -eq 0 ]; then
  {
    echo "# Times of newcomers"
    echo "Written by \`newcomers.sh --write\`, last on $(date -u +%Y-%m-%d), $(nproc) cores, $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $("$SOURCE/mortise" --version)."
    printf '\n| audience | script | commands | time, s | seen last |\n|---|---|---|---|---|\n'
    for name in "${all[@]}"; do
      if [ -n "${rows[$name]:-}" ]; then echo "${rows[$name]}"; else grep -F "| \`$name\` |" "$here/TIMES.md" || true; fi
    done
  } >"$work/times"
  mv "$work/times" "$here/TIMES.md"
fi
exit $code
