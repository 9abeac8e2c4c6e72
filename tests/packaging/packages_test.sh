#!/usr/bin/env bash
# Installs packages into a root of their own, this machine's below an overlay; uses and removes them: packages_test.sh SOURCE PACKAGES
set -euo pipefail
source=$1 packages=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
check() {  # check WHAT COMMAND…: says what failed, and goes on
  local what=$1
  shift
  if "$@" >"$work/said.txt" 2>&1; then echo "ok    $what"; else echo "FAILED $what"; sed 's/^/       /' "$work/said.txt" | head -n 20; failures=$((failures + 1)); fi
}
skip() { echo "SKIPPED: $*"; exit 77; }

for tool in dpkg-deb unshare; do command -v "$tool" >/dev/null || skip "program absent: $tool"; done
[ "$(id -u)" -eq 0 ] || skip "not root: only root may mount a root of its own"
compgen -G "$packages/*.deb" >/dev/null || skip "program absent: there are no packages to install"
mkdir "$work/mount"
unshare -m sh -c "mount -t tmpfs t '$work/mount' && mkdir '$work/mount/u' '$work/mount/w' '$work/mount/m' && mount -t overlay o -o lowerdir=/,upperdir='$work/mount/u',workdir='$work/mount/w' '$work/mount/m'" 2>/dev/null ||
  skip "machine: this kernel does not allow an overlay here"

# 1. papers
for deb in "$packages"/*.deb; do dpkg-deb -x "$deb" "$work/unpacked"; done
no_warnings() { local said; said=$(MANWIDTH=80 LC_ALL=C.UTF-8 man --warnings -l "$1" 2>&1 >/dev/null) || return 1; echo "$said"; [ -z "$said" ]; }
if command -v man >/dev/null && command -v help2man >/dev/null; then
  pages=("$work"/unpacked/usr/share/man/man1/*.gz)
  programs=$(find "$work/unpacked/usr/bin" -name 'mortise-*' ! -name 'mortise-import*' | wc -l)
  check "all of $programs programs have manual pages" test "${#pages[@]}" -eq "$programs" -a "$programs" -ge 13
  for page in "${pages[@]}"; do check "man has nothing to say of $(basename "$page")" no_warnings "$page"; done
else
  echo "note: man or help2man is not installed: manual pages are not checked"
fi
# shellcheck disable=SC2317
completes() {  # completes WORDS…: what the completion offers for the last word
  PATH="$work/unpacked/usr/bin:$PATH" LD_LIBRARY_PATH='' bash -c 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); _mortise; printf "%s\n" "${COMPREPLY[@]}"' _ "$work/unpacked/usr/share/bash-completion/completions/mortise-server" "$@"
}
offers() { local wanted=$1 said; shift; said=$(completes "$@"); grep -qx -- "$wanted" <<<"$said"; }
check "completion: options of the server" offers --metrics-port mortise-server --metr
check "completion: values of an option" offers slide mortise-server --policy s
check "completion: subcommands" offers verify mortise-replay ver
check "completion: options of a subcommand" offers --json mortise-replay verify --js
check "completion: what is done with keys" offers revoke mortise-keys rev
check "completion: roles of keys" offers observer mortise-keys issue anna --role ob
check "completion: nothing that is not there" bash -c "! (set -e; $(declare -f completes); work='$work'; completes mortise-server --no-such-option | grep -q .)"
if command -v systemd-analyze >/dev/null; then
  for unit in "$work"/unpacked/usr/lib/systemd/system/*.service; do
    name=$(basename "$unit")
    exposure=$(systemd-analyze security --offline=yes "$unit" 2>/dev/null | sed -nE 's/.*Overall exposure level for .*: ([0-9.]+) .*/\1/p')
    echo "note: systemd-analyze security $name: ${exposure:-no figure} (0 best, 10 worst)"
    check "$name is exposed by less than 2.5" awk -v e="${exposure:-10}" 'BEGIN {exit !(e < 2.5)}'
  done
fi

# 2. installed, used, removed, in a root of its own
cat >"$work/inside.sh" <<'INSIDE'
set -eu
inside=$1
files() { find /usr /etc /lib /opt -xdev \( -name mortise -o -name 'mortise*' -o -name 'libmortise*' \) 2>/dev/null | grep -v '^/etc/.*cache' | sort; }
[ -z "$(files)" ] || { echo "mortise is in this root already:"; files; exit 1; }
[ ! -e "$2/CMakeLists.txt" ] || { echo "the sources are to be seen"; exit 1; }
dpkg -i "$inside"/*.deb >/dev/null
echo "installed: $(dpkg-query -W -f '${Package} ${Version} ${db:Status-Status}; ' mortise-server mortise-tools mortise-web "libmortise*" python3-mortise 2>/dev/null || true)"
for program in server discovery bot directory web replay judge check lint inspect first-contact generate; do mortise-$program --help >/dev/null; done
if command -v systemd-analyze >/dev/null; then
  said=$(systemd-analyze verify --man=no mortise-server@demo.service mortise-web@demo.service mortise-discovery.service 2>&1 | grep mortise || true)
  [ -z "$said" ] || { echo "systemd: $said"; exit 1; }
fi
cd /
mortise-lint /usr/share/mortise/scenarios/peg_in_hole.yaml >/dev/null
mortise-generate dowel -o /tmp/dowel.stl >/dev/null
mortise-inspect /tmp/dowel.stl | grep -q cylinder || { echo "mortise-import reads no mesh"; exit 1; }
domain=$((180 + $$ % 40))
mortise-server /usr/share/mortise/scenarios/gearbox.yaml --session packed --domain $domain --log /tmp/packed.mcap --quiet >/tmp/server.txt 2>&1 &
server=$!
mortise-web --session packed --domain $domain --http-port 0 --addresses /tmp/web.txt --quiet >/dev/null 2>&1 &
web=$!
# Small roots leave documents out: the example is taken from the package itself.
dpkg-deb -x "$inside"/libmortise-dev_*.deb /tmp/unpacked
cp -r /tmp/unpacked/usr/share/doc/libmortise-dev/examples /tmp/example
command -v make >/dev/null || export CMAKE_GENERATOR=Ninja
cmake -S /tmp/example -B /tmp/example/build -DCMAKE_BUILD_TYPE=Release >/tmp/cmake.txt 2>&1 || { cat /tmp/cmake.txt; exit 1; }
cmake --build /tmp/example/build >/tmp/cmake.txt 2>&1 || { tail -n 30 /tmp/cmake.txt; exit 1; }
/tmp/example/build/live_client packed $domain >/tmp/parts.txt || { cat /tmp/server.txt; exit 1; }
grep -qx input_shaft /tmp/parts.txt || { echo "the example did not see the parts"; cat /tmp/parts.txt; exit 1; }
echo "the example outside of the tree sees $(wc -l </tmp/parts.txt) parts"
! /tmp/example/build/live_client no-such-session $domain 2>/tmp/none.txt || { echo "a session that is not there was seen"; exit 1; }
port=$(sed -nE 's|^designer http://127.0.0.1:([0-9]+)/.*|\1|p' /tmp/web.txt)
get() { exec 3<>/dev/tcp/127.0.0.1/"$port"; printf 'GET %s HTTP/1.1\r\nHost: 127.0.0.1:%s\r\nConnection: close\r\n\r\n' "$1" "$port" >&3; cat <&3; exec 3>&-; }
get / >/tmp/page.txt; grep -q '<title>mortise' /tmp/page.txt || { echo "no page"; head -n 5 /tmp/page.txt; exit 1; }
get /healthz >/tmp/health.txt; grep -q '200 OK' /tmp/health.txt || { echo "gateway not healthy"; cat /tmp/health.txt; exit 1; }
if [ -e /usr/share/mortise/page/node_modules ]; then get /three/build/three.module.js >/tmp/three.txt; grep -q '200 OK' /tmp/three.txt || { echo "no three.js"; exit 1; }; else echo "note: without three.js"; fi
kill -INT $web $server; wait $server $web
mortise-replay verify /tmp/packed.mcap >/tmp/verify.txt || { cat /tmp/verify.txt; exit 1; }
echo "a session ran from what is installed, its log verifies"
if dpkg-query -W python3-mortise >/dev/null 2>&1; then
  mortise-generate dowel -o /tmp/a.stl >/dev/null
  python3 -c 'import mortise; print("python: judged as", mortise.judge("/tmp/a.stl", "/tmp/dowel.stl").worst)' || exit 1
fi
dpkg-query -W -f '${Package}\n' 'mortise*' 'libmortise*' 'python3-mortise*' 2>/dev/null | xargs dpkg -P >/dev/null
[ -z "$(files)" ] || { echo "left behind:"; files; exit 1; }
echo "removed, nothing is left"
INSIDE
cat >"$work/mount.sh" <<'MOUNT'
set -eu
mount -t tmpfs t "$1/mount"
mkdir "$1/mount/u" "$1/mount/w" "$1/mount/m"
mount -t overlay o -o lowerdir=/,upperdir="$1/mount/u",workdir="$1/mount/w" "$1/mount/m"
root=$1/mount/m
mount -t tmpfs t "$root/tmp"
mkdir "$root/tmp/packages"
cp "$3"/*.deb "$1/inside.sh" "$root/tmp/packages/"
if [ -d "$root$2" ]; then mount -t tmpfs t "$root$2"; fi
mount -t proc p "$root/proc"
mount --bind /dev "$root/dev"
ip link set lo up 2>/dev/null || true
exec chroot "$root" /usr/bin/env -i HOME=/tmp PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive bash /tmp/packages/inside.sh /tmp/packages "$2"
MOUNT
namespaces=(-m -p -f)
check "installed, used and removed in a root of their own" timeout 300 unshare "${namespaces[@]}" sh "$work/mount.sh" "$work" "$source" "$packages"
sed 's/^/       /' "$work/said.txt"
exit $((failures > 0))
