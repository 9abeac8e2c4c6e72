#!/usr/bin/env bash
# Builds the last stage of the Dockerfile of packages that are there, on the root of clean_root_test, and plays a session in it:
# dockerfile_test.sh SOURCE PACKAGES CACHE. In long runs all stages, as a user builds it.
set -euo pipefail
source=$1 packages=$2 cache=$3 dockerfile=$1/server/packaging/Dockerfile
work=$(mktemp -d)
store() { buildah --root "$work/store" --runroot "$work/run" --storage-driver vfs "$@"; }
finish() {
  ! command -v buildah >/dev/null || store rm --all >/dev/null 2>&1 || true
  rm -rf "$work"
}
trap finish EXIT
fail() { echo "FAILED: $*"; exit 1; }
skip() { echo "SKIPPED: $*"; exit 77; }

# 1. what needs no container: sources are there, and what is installed is named in packages.txt alone
mapfile -t sources < <(awk '$1 == "COPY" && $2 !~ /^--from=/ {for (i = 2; i < NF; ++i) print $i}' "$dockerfile")
[ ${#sources[@]} -gt 0 ] || fail "nothing is copied"
for file in "${sources[@]}"; do
  [ -e "$source/$file" ] || fail "COPY $file: it is not there"
  ! grep -qxF "${file#./}" "$source/.dockerignore" || fail "COPY $file: .dockerignore leaves it out"
done
named=$(sed -e ':a' -e '/\\$/{N;s/\\\n//;ba}' "$dockerfile" | grep -oE '(apt|apt-get) (-[^ ]+ )*install [^&|;]*' | tr ' ' '\n' |
  grep -vE '^(apt|apt-get|install|-.*|/tmp/.*\.deb|)$' || true)
[ -z "$named" ] || fail "packages that packages.txt should name: $named"
grep -q '^RUN ./mortise setup' "$dockerfile" || fail "what mortise is built with comes by ./mortise setup"
echo "sources: ${#sources[@]} are there; packages: those of packages.txt"

# 2. the last stage
[ "$(id -u)" -eq 0 ] || skip "not root: only root may build one here"
command -v buildah >/dev/null || skip "program absent: buildah"
[ -e "$cache/root.tar" ] || skip "not root: there is no root to begin with"
compgen -G "$packages/*.deb" >/dev/null || skip "program absent: there are no packages to install"
base=$(store from scratch)
store add -q "$base" "$cache/root.tar" / >/dev/null
store commit -q "$base" docker.io/library/debian:bookworm >"$work/said.txt" 2>&1 || { cat "$work/said.txt"; skip "machine: buildah cannot keep an image"; }
store rm "$base" >/dev/null
store tag docker.io/library/debian:bookworm docker.io/library/debian:bookworm-slim
mkdir -p "$work/build/src/build/release/packages"
cp "$packages"/*.deb "$work/build/src/build/release/packages"
bud() {  # bud NAME [OPTIONS]: what has no network is skipped, all else that goes wrong is a fault
  local image=$1
  shift
  store bud --isolation chroot --network host --pull-never "$@" -f "$dockerfile" -t "$image" "$source" >"$work/said.txt" 2>&1 && return 0
  ! grep -qE 'Failed to fetch|Temporary failure|Could not connect' "$work/said.txt" || skip "no network: Debian's packages cannot be fetched"
  tail -n 30 "$work/said.txt"
  fail "the Dockerfile does not build: $image"
}
bud mortise --volume "$(realpath "$cache")/archives:/var/cache/apt/archives" --build-context "build=$work/build"

# 3. what the image says to be run is run, by whom it says
plays() {  # plays IMAGE
  local container command
  container=$(store from --pull-never "localhost/$1")
  said() { store inspect --format "{{$1}}" "$container"; }
  [ "$(said .OCIv1.Config.User)" = mortise ] || fail "$1: it runs as $(said .OCIv1.Config.User)"
  mapfile -t command < <(said 'range .OCIv1.Config.Entrypoint}}{{println .}}{{end}}{{range .OCIv1.Config.Cmd}}{{println .}}{{end')
  # A mapfile of what a template prints ends with an empty line.
  [ -n "${command[-1]}" ] || unset 'command[-1]'
  inside() { store run --isolation chroot "$container" -- "$@"; }
  inside sh -c '"$@" --domain 11 --duration 6 & sleep 1; mortise-bot --session demo --domain 11 --wait 10 --seconds 2 --quiet && wait $!' sh "${command[@]}" \
    >"$work/said.txt" 2>&1 || { cat "$work/said.txt"; fail "$1: no session in it: ${command[*]}"; }
  inside sh -c 'mortise-replay verify /var/lib/mortise/*.mcap' >"$work/said.txt" 2>&1 || { cat "$work/said.txt"; fail "$1: its log"; }
  store rm "$container" >/dev/null
  echo "played in $1: ${command[*]}"
}
plays mortise

# 4. all stages, as a user builds it: what mortise is built with is installed, and it is compiled there
if [ "${MORTISE_EFFORT:-1}" -gt 1 ]; then
  trust=()  # of a proxy between here and npm's registry, where this machine is told of one
  [ -z "${NODE_EXTRA_CA_CERTS:-}" ] || trust=(--volume "$NODE_EXTRA_CA_CERTS:/tmp/trust.crt:ro" --env NODE_EXTRA_CA_CERTS=/tmp/trust.crt)
  bud whole "${trust[@]}"
  plays whole
fi
