#!/usr/bin/env bash
# What a session costs its server, by what is in it: capacity.sh [BIN [SECONDS [ROWS]]] [--json FILE]. One table on stdout, and in FILE as
# other benchmarks write it; the formulas that read it are in server/packaging/OPERATING.md. Processor time is that of the server's process, of one core, while all act; bytes are those on lo, in
# a network namespace of its own where that is permitted, or of the whole machine. ROWS: those whose name has this regular expression
# in it. CAPACITY_WARM_S: what goes before each measurement. 1 when a program fails, 2 when there is nothing to measure.
set -euo pipefail
if [ -z "${CAPACITY_ALONE:-}" ] && unshare -n true 2>/dev/null; then CAPACITY_ALONE=1 exec unshare -n "$0" "$@"; fi
[ -z "${CAPACITY_ALONE:-}" ] || ip link set lo up
json='' words=()
while [ $# -gt 0 ]; do
  if [ "$1" = --json ]; then json=${2:?a file}; shift 2; else words+=("$1"); shift; fi
done
set -- "${words[@]}"
bin=${1:-build/release/bin} seconds=${2:-6} rows=${3:-.} warm=${CAPACITY_WARM_S:-3} scenarios=$(dirname "$0")/../../scenarios
usage() { echo "capacity.sh: $*" >&2; exit 2; }
for number in "$seconds" "$warm"; do [[ "$number" =~ ^[1-9][0-9]*$ ]] || usage "'$number' is no number of seconds"; done
for program in server bot; do [ -x "$bin/mortise-$program" ] || usage "there is no mortise-$program in $bin"; done
work=$(mktemp -d)
started=()
finish() { for pid in "${started[@]}"; do kill -INT "$pid" 2>/dev/null || true; done; wait; rm -rf "$work"; }
trap finish EXIT
fail() { echo "capacity.sh: $1" >&2; tail -n 5 "$2" >&2; exit 1; }
measured=0
patience=30
ticks_per_s=$(getconf CLK_TCK)
cpu() { awk -v t="$ticks_per_s" '{sub(/.*\) /, ""); print ($12 + $13) / t}' "/proc/$1/stat"; }
sent() { awk '/^ *lo:/ {print $10}' /proc/net/dev; }

# row NAME SCENARIO DOMAIN KEYS STANDBY PROCESSES USERS BEHAVIOUR
row() {
  grep -qE -- "$rows" <<<"$1" || return 0
  measured=$((measured + 1))
  local name=$1 scenario=$scenarios/$2 domain=$3 keys=$4 standby=$5 processes=$6 users=$7 behaviour=$8 server bots=() other=''
  mkdir -p "$work/$domain"
  local words=(--domain "$domain" --quiet)
  "$bin/mortise-server" "$scenario" "${words[@]}" --log "$work/$domain" ${keys:+--keys "$keys/hall"} >"$work/$domain.out" 2>&1 &
  server=$!
  started+=("$server")
  sleep 1
  if [ "$standby" = yes ]; then
    "$bin/mortise-server" --standby-of default --restore "$work/$domain" "${words[@]}" --log "$work/$domain" >"$work/$domain.standby" 2>&1 &
    other=$!
    started+=("$other")
    sleep 4
  fi
  for ((i = 0; i < processes; ++i)); do
    local names='' u
    for ((u = 0; u < users; ++u)); do names+=${names:+,}mill-$i-$u; done
    "$bin/mortise-bot" --domain "$domain" --wait "$patience" --users "$users" --names "$names" --behaviour "$behaviour" --rate 60 --first-part $((i * users)) \
      --seconds 3600 ${keys:+--keys "$keys/mill"} >"$work/$domain.bot$i" 2>&1 &
    bots+=($!)
    started+=($!)
  done
  local end=$((SECONDS + patience))
  for i in "${!bots[@]}"; do
    until grep -q 'joined session' "$work/$domain.bot$i"; do
      { [ "$SECONDS" -lt "$end" ] && kill -0 "${bots[i]}" 2>/dev/null; } || fail "$name: a bot did not join" "$work/$domain.bot$i"
      sleep 0.1
    done
  done
  sleep "$warm"
  kill -0 "$server" 2>/dev/null || fail "$name: the server has ended" "$work/$domain.out"
  for i in "${!bots[@]}"; do kill -0 "${bots[i]}" 2>/dev/null || fail "$name: a bot has ended" "$work/$domain.bot$i"; done
  local at before_cpu before_bytes bots_cpu=0 pid
  at=$(date +%s.%N) before_cpu=$(cpu "$server") before_bytes=$(sent)
  for pid in "${bots[@]}"; do bots_cpu=$(awk "BEGIN {print $bots_cpu - $(cpu "$pid")}"); done
  sleep "$seconds"
  local took after_cpu after_bytes
  took=$(awk "BEGIN {print $(date +%s.%N) - $at}") after_cpu=$(cpu "$server") after_bytes=$(sent)
  for pid in "${bots[@]}"; do bots_cpu=$(awk "BEGIN {print $bots_cpu + $(cpu "$pid")}"); done
  awk -v n="$name" -v c="$(awk "BEGIN {print 100 * ($after_cpu - $before_cpu) / $took}")" -v b="$(awk "BEGIN {print ($after_bytes - $before_bytes) / $took / 1000}")" \
    -v k="$(awk "BEGIN {print 100 * $bots_cpu / $took}")" -v m="$(awk '/VmRSS/ {print $2 / 1000}' "/proc/$server/status")" -v u=$((processes * users)) \
    'BEGIN {printf "| %s | %d | %.1f | %.1f | %.0f | %.0f |\n", n, u, c, k, b, m}' | tee -a "$work/rows"
  for i in "${!bots[@]}"; do { kill -INT "${bots[i]}" && wait "${bots[i]}"; } || fail "$name: a bot failed" "$work/$domain.bot$i"; done
  if [ -n "$other" ]; then
    { kill -INT "$other" && wait "$other"; } || fail "$name: the second server failed" "$work/$domain.standby"
  fi
  { kill -INT "$server" && wait "$server"; } || fail "$name: the server failed" "$work/$domain.out"
}

"$bin/mortise-keys" --help >/dev/null 2>&1 && keys_program=$bin/mortise-keys || keys_program=$(dirname "$0")/../../client/tools/keys/mortise-keys
{ "$keys_program" init --keys "$work/keys" && "$keys_program" issue hall --role server --keys "$work/keys" &&
  "$keys_program" issue mill --role bot --keys "$work/keys"; } >"$work/keys.out" 2>&1 || fail "no keys" "$work/keys.out"
note="load average $(cut -d' ' -f1 /proc/loadavg), $(nproc) processors, $seconds s each"
echo "$note"
echo "| session | users | server, % of a core | clients, % of a core | on the wire, kB/s | server, MB |"
echo "|--|--|--|--|--|--|"
row "nobody" gearbox.yaml 201 '' no 0 0 shake
row "one process, hands free of contact" gearbox.yaml 202 '' no 1 4 shake
row "four processes, hands free of contact" gearbox.yaml 203 '' no 4 2 shake
row "the same with keys" gearbox.yaml 204 "$work/keys" no 4 2 shake
row "the same with a second server" gearbox.yaml 205 '' yes 4 2 shake
row "mixed: insertions, pushes, hand-overs" gearbox.yaml 206 '' no 4 2 mixed
[ "$measured" -gt 0 ] || usage "no row is called '$rows'"
[ -n "$json" ] || exit 0
awk -F' *[|] *' -v note="$note" '
  BEGIN { printf "{\"tables\": [{\"title\": \"What a session costs its server\", \"rows\": [" }
  { printf "%s\n{\"session\": \"%s\", \"users\": %s, \"server, %% of a core\": %s, \"clients, %% of a core\": %s, \"on the wire, kB/s\": %s, \"server, MB\": %s}",
      (NR > 1 ? "," : ""), $2, $3, $4, $5, $6, $7 }
  END { printf "]}],\n\"notes\": [\"%s\"],\n\"bars\": []}\n", note }' "$work/rows" >"$json"
