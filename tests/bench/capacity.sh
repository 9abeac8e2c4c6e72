#!/usr/bin/env bash
# What a session costs its server, by what is in it: capacity.sh [BIN [SECONDS]]. One table on stdout; the formulas that read it
# stand in server/README.md. Processor time is that of the server's process, of one core, while all act; bytes are those on lo, in
# a network namespace of its own where that is permitted, or of the whole machine.
set -euo pipefail
if [ -z "${CAPACITY_ALONE:-}" ] && unshare -n true 2>/dev/null; then CAPACITY_ALONE=1 exec unshare -n "$0" "$@"; fi
[ -z "${CAPACITY_ALONE:-}" ] || ip link set lo up
bin=${1:-build/release/bin} seconds=${2:-6} scenarios=$(dirname "$0")/../../scenarios
work=$(mktemp -d)
started=()
finish() { for pid in "${started[@]}"; do kill -INT "$pid" 2>/dev/null || true; done; wait; rm -rf "$work"; }
trap finish EXIT
ticks_per_s=$(getconf CLK_TCK)
cpu() { awk -v t="$ticks_per_s" '{sub(/.*\) /, ""); print ($12 + $13) / t}' "/proc/$1/stat"; }
sent() { awk '/^ *lo:/ {print $10}' /proc/net/dev; }

# row NAME SCENARIO DOMAIN KEYS STANDBY PROCESSES USERS BEHAVIOUR
row() {
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
    "$bin/mortise-bot" "${words[@]}" --users "$users" --names "$names" --behaviour "$behaviour" --rate 60 --first-part $((i * users)) \
      --seconds $((seconds + 5)) ${keys:+--keys "$keys/mill"} >"$work/$domain.bot$i" 2>&1 &
    bots+=($!)
    started+=($!)
  done
  sleep 3
  local at before_cpu before_bytes bots_cpu=0 pid
  at=$(date +%s.%N) before_cpu=$(cpu "$server") before_bytes=$(sent)
  for pid in "${bots[@]}"; do bots_cpu=$(awk "BEGIN {print $bots_cpu - $(cpu "$pid")}"); done
  sleep "$seconds"
  local took after_cpu after_bytes
  took=$(awk "BEGIN {print $(date +%s.%N) - $at}") after_cpu=$(cpu "$server") after_bytes=$(sent)
  for pid in "${bots[@]}"; do bots_cpu=$(awk "BEGIN {print $bots_cpu + $(cpu "$pid")}"); done
  awk -v n="$name" -v c="$(awk "BEGIN {print 100 * ($after_cpu - $before_cpu) / $took}")" -v b="$(awk "BEGIN {print ($after_bytes - $before_bytes) / $took / 1000}")" \
    -v k="$(awk "BEGIN {print 100 * $bots_cpu / $took}")" -v m="$(awk '/VmRSS/ {print $2 / 1000}' "/proc/$server/status")" -v u=$((processes * users)) \
    'BEGIN {printf "| %s | %d | %.1f | %.1f | %.0f | %.0f |\n", n, u, c, k, b, m}'
  for pid in "${bots[@]}"; do wait "$pid" || true; done
  [ -z "$other" ] || { kill -INT "$other"; wait "$other" || true; }
  kill -INT "$server"
  wait "$server" || true
}

"$bin/mortise-keys" --help >/dev/null 2>&1 && keys_program=$bin/mortise-keys || keys_program=$(dirname "$0")/../../client/tools/keys/mortise-keys
"$keys_program" init --keys "$work/keys" >/dev/null 2>&1
"$keys_program" issue hall --role server --keys "$work/keys" >/dev/null 2>&1
"$keys_program" issue mill --role bot --keys "$work/keys" >/dev/null 2>&1
echo "load average $(cut -d' ' -f1 /proc/loadavg), $(nproc) processors, $seconds s each"
echo "| session | users | server, % of a core | clients, % of a core | on the wire, kB/s | server, MB |"
echo "|--|--|--|--|--|--|"
row "nobody" gearbox.yaml 201 '' no 0 0 shake
row "one process, hands free of contact" gearbox.yaml 202 '' no 1 4 shake
row "four processes, hands free of contact" gearbox.yaml 203 '' no 4 2 shake
row "the same with keys" gearbox.yaml 204 "$work/keys" no 4 2 shake
row "the same with a second server" gearbox.yaml 205 '' yes 4 2 shake
row "mixed: insertions, pushes, hand-overs" gearbox.yaml 206 '' no 4 2 mixed
