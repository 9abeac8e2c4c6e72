#!/usr/bin/env bash
# Installs the packages, one after another, into a Debian that has nothing but apt, where what they say they depend on is all that
# comes with them; starts every program, purges them, and looks for what is left: clean_root_test.sh PACKAGES CACHE
# CACHE keeps the root, and what apt fetched, for the next run. MORTISE_SUITE names another Debian than this machine's.
set -euo pipefail
packages=$(realpath "$1") cache=$2 steps=$(dirname "$(readlink -f "$0")")/clean_root_steps.sh
if [ "${IN_NAMESPACE:-}" != yes ]; then
  skip() { echo "SKIPPED: $*"; exit 77; }
  [ "$(id -u)" -eq 0 ] || skip "not root: only root may make one"
  compgen -G "$packages/*.deb" >/dev/null || skip "program absent: there are no packages to install"
  for tool in mmdebstrap unshare objdump ip; do command -v "$tool" >/dev/null || skip "program absent: $tool"; done
  unshare -m mount -t tmpfs t /mnt 2>/dev/null || skip "machine: this kernel does not allow a mount"
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  mkdir -p "$cache/archives/partial" "$cache/lists/partial"
  if [ ! -e "$cache/root.tar" ]; then
    # What this machine itself has from Debian; nothing of others, whose packages might stand in for Debian's.
    # shellcheck disable=SC2016
    mapfile -t sources < <(apt-get indextargets --format 'deb $(REPO_URI) $(CODENAME) $(COMPONENT)' 'Created-By: Packages' 'Origin: Debian' | sort -u)
    [ ${#sources[@]} -gt 0 ] || skip "no network: apt has no lists of Debian here"
    # shellcheck disable=SC1091
    suite=${MORTISE_SUITE:-$(. /etc/os-release && echo "$VERSION_CODENAME")}
    began=$SECONDS
    TMPDIR=$(if [ -w /dev/shm ]; then echo /dev/shm; else echo /tmp; fi) timeout 600 mmdebstrap --quiet --variant=apt \
      --aptopt='Acquire::Languages "none"' "$suite" "$cache/root.new.tar" "${sources[@]}" 2>"$work/said.txt" ||
      skip "no network: mmdebstrap: $(grep -m 1 -E '^(E|Err)' "$work/said.txt" || tail -n 1 "$work/said.txt")"
    mv "$cache/root.new.tar" "$cache/root.tar"
    echo "a root was made in $((SECONDS - began)) s"
  fi
  # -p: what still runs in there ends with it.
  IN_NAMESPACE=yes unshare -m -p -f --mount-proc "$0" "$packages" "$cache" "$work"
  exit
fi

root=$3/root
mkdir "$root"
mount -t tmpfs t "$root"
tar -C "$root" -xf "$cache/root.tar"
# Directories of libraries that each program names: what it links itself, without what those link in turn.
mkdir "$root/mortise-test"
cp "$packages"/*.deb "$steps" "$(dirname "$steps")/../../scenarios/tensioner.step" "$root/mortise-test/"
for deb in "$packages"/mortise-*.deb; do
  dpkg-deb -x "$deb" "$root/mortise-test/unpacked"
  for program in "$root"/mortise-test/unpacked/usr/bin/*; do
    needed=$({ objdump -p "$program" 2>/dev/null || true; } | awk '$1 == "NEEDED" {print $2}' | xargs)
    [ -z "$needed" ] || echo "$(dpkg-deb -f "$deb" Package) /usr/bin/$(basename "$program") $needed"
  done
  rm -rf "$root/mortise-test/unpacked"
done >"$root/mortise-test/needed.txt"
mount -t proc p "$root/proc"
mount --rbind /dev "$root/dev"
mount --bind "$cache/archives" "$root/var/cache/apt/archives"
mount --bind "$cache/lists" "$root/var/lib/apt/lists"
cp /etc/resolv.conf /etc/hosts "$root/etc/"
step() {  # step NETWORK NAME [ARGUMENT]: inside, with or without the world
  local network=$1 inside=(chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash /mortise-test/clean_root_steps.sh)
  shift
  if [ "$network" = world ]; then "${inside[@]}" "$@"; else unshare -n sh -c 'ip link set lo up && exec "$@"' sh "${inside[@]}" "$@"; fi
}
step world update
for package in mortise-web mortise-tools; do
  step world install "$package"
  step alone programs "$package"
  step alone linked "$package"
  [ "$package" = mortise-tools ] || step world purge
done
for package in mortise-server mortise-web; do
  step world install "$package"
  step alone programs "$package"
  step alone linked "$package"
done
# The compiler and all that the library is compiled with are many: fetched in long runs only.
if [ "${MORTISE_EFFORT:-1}" -gt 1 ]; then step world library; else step world resolves libmortise-engine; fi
if compgen -G "$root/mortise-test/python3-mortise_*.deb" >/dev/null && compgen -G "$root/mortise-test/mortise-step_*.deb" >/dev/null; then step world python; fi
step alone session
step world purge
