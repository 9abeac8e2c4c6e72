#!/usr/bin/env bash
# What clean_root_test.sh does inside of the root: clean_root_steps.sh STEP [PACKAGE]. Says what it saw; 0 well, 1 not, 77 no network.
set -euo pipefail
here=/mortise-test
fail() { echo "FAILED: $*"; exit 1; }
# All that is there, but for the books of dpkg and apt, and what this test has laid down itself.
files() {
  find / -xdev \( -path $here -o -path /tmp -o -path /var/lib/dpkg -o -path /var/lib/apt -o -path /var/cache -o -path /var/log \) -prune -o -print | sort
}
version() { dpkg-deb -f "$here/$1"_*.deb Version; }

update() {
  ! dpkg-query -W 'mortise*' 'libmortise*' >/dev/null 2>&1 || fail "mortise is in this root already"
  apt-get update -q >/tmp/said.txt 2>&1 || { tail -n 3 /tmp/said.txt; echo "SKIPPED: no network: apt cannot read Debian's lists"; exit 77; }
  files >$here/before.txt
  dpkg-query -W -f '${Package} ${Status}\n' | sort >$here/packages-before.txt
}

apt() {  # apt WHAT NAMES…: without a network there is nothing to be said; all else that goes wrong is the packages' fault
  local what=$1
  shift
  apt-get install -y --no-install-recommends "$@" >/tmp/said.txt 2>&1 && return 0
  if grep -qE '^(E|Err).*(Failed to fetch|Temporary failure|Could not connect|Unable to fetch)' /tmp/said.txt; then
    grep -m 1 '^E' /tmp/said.txt
    echo "SKIPPED: no network: Debian's packages cannot be fetched"
    exit 77
  fi
  tail -n 20 /tmp/said.txt
  fail "$what"
}
install() {  # what a package says that it needs is enough, by Debian alone
  local package=$1 debs=("$here/$1"_*.deb)
  # One package of ours that needs another: it has to be at hand, as in a repository.
  [ "$package" != mortise-server ] || debs+=("$here"/mortise-tools_*.deb)
  apt "$package does not install, by what it depends on" "${debs[@]}"
  echo "installed: $(dpkg-query -W -f '${Package} ${Version}' "$package"), $(grep -c '^Setting up' /tmp/said.txt) packages in all"
}

programs() {  # each program of a package starts
  local package=$1 program name said count=0 wanted
  wanted=$(version "$package")
  for program in $(dpkg -L "$package" | grep '^/usr/bin/.'); do
    name=$(basename "$program")
    if [ "$name" = mortise-import ]; then # not for people: it reads what it is given by another
      said=$(ldd "$program" 2>&1) || fail "$name does not load: $said"
      ! grep -q 'not found' <<<"$said" || fail "$name does not load: $said"
      continue
    fi
    said=$("$name" --version 2>&1) || fail "$name does not start: $said"
    [[ "$said" == "$name $wanted, build "* ]] || fail "$name says of itself: $said"
    "$name" --help >/dev/null 2>&1 || fail "$name --help"
    count=$((count + 1))
  done
  echo "started: $count programs of $package"
}

# The package of each library, by its path without /usr.
owners() { grep -H '\.so' /var/lib/dpkg/info/*.list | sed -E 's#^.*/info/([^:]+)(:[a-z0-9]+)?\.list:(/usr)?#\1 #'; }
# closure PACKAGE [MOST]: what is installed of all that it depends on, itself or by MOST others at most, under its real name.
closure() {
  dpkg-query -W -f '${Package}\t${Provides}\t${Pre-Depends}, ${Depends}\n' | awk -F'\t' -v from="$1" -v most="${2:-1000}" '
    function bare(s) { sub(/[ (:].*/, "", s); return s }
    {
      n = split($2, p, /, */); provided[$1] = provided[$1] " " $1
      for (i = 1; i <= n; ++i) if (p[i] != "") provided[bare(p[i])] = provided[bare(p[i])] " " $1
      n = split($3, d, / *[,|] */)
      for (i = 1; i <= n; ++i) if (d[i] != "") depends[$1] = depends[$1] " " bare(d[i])
    }
    END {
      open[last = 1] = from; by[from] = 0
      for (at = 1; at <= last && by[open[at]] <= most; ++at) {
        n = split(depends[open[at]], d, " ")
        for (i = 1; i <= n; ++i) {
          m = split(provided[d[i]], p, " ")
          for (j = 1; j <= m; ++j) if (!(p[j] in by)) { by[p[j]] = by[open[at]] + 1; open[++last] = p[j]; print p[j] }
        }
      }
    }'
}
linked() {  # each library that a program links comes with what its package depends on
  local package=$1 name program needed soname path owner checked=0
  declare -A owner_of=() reached=() named=()
  while read -r owner path; do owner_of[$path]=$owner; done < <(owners)
  for name in $(closure "$package"); do reached[$name]=1; done
  for name in $(closure "$package" 0); do named[$name]=1; done
  while read -r _ program needed; do
    declare -A loads=()
    while read -r soname _ path _; do
      [ "$path" != not ] || fail "$program: $soname is not here"
      [[ "$path" == /* ]] || continue
      loads[$soname]=$path
    done < <(ldd "$program" | grep '=>')
    for soname in "${!loads[@]}"; do
      path=${loads[$soname]#/usr}
      owner=${owner_of[$path]:-}
      [ -n "$owner" ] || owner=${owner_of[$(readlink -f "${loads[$soname]}" | sed 's|^/usr||')]:-}
      [ -n "$owner" ] || fail "$program loads ${loads[$soname]}, which no package has"
      [ -n "${reached[$owner]:-}" ] || fail "$program loads $soname of $owner, which $package does not depend on"
      # What it names itself is named by the package itself: what others need may change.
      if [[ " $needed " == *" $soname "* ]] && [ -z "${named[$owner]:-}" ]; then fail "$program links $soname of $owner, which the Depends of $package do not name"; fi
      checked=$((checked + 1))
    done
    unset loads
  done < <(grep "^$package " $here/needed.txt)
  [ "$checked" -gt 0 ] || fail "no library of $package was looked at"
  echo "linked: $checked libraries of the programs of $package, each of a package that it depends on"
}

wait_for() { local end=$((SECONDS + 20)); until eval "$1"; do [ $SECONDS -lt $end ] || return 1; sleep 0.1; done; }
session() {  # what the packages are for, with keys and without
  local keys server web said port
  cd /tmp
  mortise-generate dowel -o dowel.stl >/dev/null
  mortise-inspect dowel.stl | grep -q cylinder || fail "mortise-import reads no mesh"
  mortise-lint /usr/share/mortise/scenarios/gearbox.yaml >/dev/null || fail "mortise-lint"
  mortise-keys init --keys site >said.txt 2>&1 || { cat said.txt; fail "mortise-keys init"; }
  for keys in 'hall --role server' 'mill --role bot' 'anna --role designer'; do
    # shellcheck disable=SC2086
    mortise-keys issue $keys --keys site >said.txt 2>&1 || { cat said.txt; fail "mortise-keys issue $keys"; }
  done
  mortise-discovery --quiet >discovery.txt 2>&1 &
  local discovery=$!
  for keys in no yes; do
    with() { [ $keys = no ] || echo "--keys site/$1"; }
    # shellcheck disable=SC2046
    mortise-server /usr/share/mortise/scenarios/gearbox.yaml --session $keys --domain 7 --log $keys.mcap --discovery-server localhost --quiet $(with hall) >server.txt 2>&1 &
    server=$!
    # shellcheck disable=SC2046
    said=$(mortise-bot --session $keys --domain 7 --discovery-server localhost --names mill --wait 20 --seconds 2 --quiet $(with mill) 2>&1) || { cat server.txt; fail "mortise-bot, keys: $keys: $said"; }
    # shellcheck disable=SC2046
    said=$(mortise-directory --domain 7 --discovery-server localhost --wait 2 $(with anna) 2>&1) || fail "mortise-directory, keys: $keys: $said"
    grep -qw "$keys" <<<"$said" || fail "mortise-directory does not see the session: $said"
    if [ $keys = no ]; then
      if [ -x example/build/live_client ]; then
        { example/build/live_client no 7 >said.txt && grep -qx input_shaft said.txt; } || { cat said.txt; fail "the example does not see the parts"; }
        echo "the example sees $(wc -l <said.txt) parts"
      fi
      mortise-web --session no --domain 7 --http-port 0 --addresses web.txt --quiet >web.log 2>&1 &
      web=$!
      wait_for '[ -s web.txt ]' || { cat web.log; fail "mortise-web says no addresses"; }
      port=$(sed -nE 's|^designer http://127.0.0.1:([0-9]+)/.*|\1|p' web.txt)
      exec 3<>/dev/tcp/127.0.0.1/"$port"
      printf 'GET / HTTP/1.1\r\nHost: 127.0.0.1:%s\r\nConnection: close\r\n\r\n' "$port" >&3
      grep -q '<title>mortise' <&3 || fail "mortise-web serves no page"
      exec 3>&-
      kill -INT $web
      wait $web || { cat web.log; fail "mortise-web"; }
    fi
    kill -INT $server
    wait $server || { cat server.txt; fail "mortise-server, keys: $keys"; }
    mortise-replay verify $keys.mcap >said.txt || { cat said.txt; fail "the log of the session, keys: $keys"; }
  done
  kill -INT $discovery
  wait $discovery || { cat discovery.txt; fail "mortise-discovery"; }
  echo "a session ran from what is installed, found by a discovery server, with keys and without; its logs verify"
}

library() {  # the package of the library brings what its users compile with: Eigen alone for the engine; examples are built and run
  apt "libmortise-dev does not install" g++ cmake make "$here"/libmortise-dev_*.deb "$here"/libmortise-engine_*.deb
  local extra
  # dpkg also knows packages that others only mention.
  extra=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' 'lib*-dev' |
    grep -E '^installed lib(fcl|fastrtps|fastcdr|yaml-cpp|assimp|ssl|sqlite3|fmt|zstd|cairo2|boost)' | xargs) || true
  [ -z "$extra" ] || fail "the engine brought $extra"
  cp -r /usr/share/doc/libmortise-dev/examples /tmp/example
  cmake -S /tmp/example -B /tmp/example/engine -DCOMPONENTS=engine >/tmp/said.txt 2>&1 || { cat /tmp/said.txt; fail "find_package(mortise COMPONENTS engine)"; }
  cmake --build /tmp/example/engine >/tmp/said.txt 2>&1 || { tail -n 30 /tmp/said.txt; fail "the example of the engine"; }
  /tmp/example/engine/thirty_lines | grep -q 'H7/g6: the peg stands at z = 5.000 mm' || fail "the example of the engine"
  apt "libmortise-io and -client do not install" "$here"/libmortise-{io,client}_*.deb
  cmake -S /tmp/example -B /tmp/example/build -DCMAKE_BUILD_TYPE=Release >/tmp/said.txt 2>&1 || { cat /tmp/said.txt; fail "find_package(mortise)"; }
  cmake --build /tmp/example/build >/tmp/said.txt 2>&1 || { tail -n 30 /tmp/said.txt; fail "the example"; }
  echo "built: the example, with libmortise-dev, g++, cmake and make"
}

python() {  # the package of Python checks what it is given
  apt "python3-mortise does not install" "$here"/python3-mortise_*.deb "$here"/mortise-tools_*.deb "$here"/mortise-step_*.deb
  python3 -c 'import mortise, sys; r = mortise.check(sys.argv[1]); print("python:", mortise.version(), r.counts); sys.exit(r.counts["unexplained_real"] != 1)' \
    $here/tensioner.step || fail "import mortise"
  compgen -G '/usr/lib/python3/dist-packages/mortise/__pycache__/*.pyc' >/dev/null || fail "the package of Python is not compiled: root's first import would be"
}

resolves() {  # a package could be installed beside the others; what it brings is not fetched
  apt-get install -s --no-install-recommends "$here/$1"_*.deb >/tmp/said.txt 2>&1 || { cat /tmp/said.txt; fail "$1: what it depends on is not to be had of Debian"; }
  echo "resolved: $1, with $(grep -c '^Inst' /tmp/said.txt) packages"
}

purge() {  # nothing of it is left, nor of what came with it; what people have put beside it stays
  local installed left own=/etc/mortise/own.yaml kept=no
  mapfile -t installed < <(dpkg-query -W -f '${Package} ${db:Status-Status}\n' 'mortise*' 'libmortise*' 'python3-mortise*' 'g++' cmake make 2>/dev/null | awk '$2 == "installed" {print $1}')
  [ ${#installed[@]} -gt 0 ] || fail "nothing is installed"
  if [ -d /etc/mortise ]; then echo 'a: 1' >$own; kept=yes; fi
  apt-get remove -y --auto-remove "${installed[@]}" >/tmp/said.txt 2>&1 || { cat /tmp/said.txt; fail "remove"; }
  left=$(compgen -G '/usr/bin/mortise*' || true)
  [ -z "$left" ] || fail "removed, and still there: $left"
  # What Debian calls required, as tzdata that came with Python, apt does not take away by itself.
  dpkg-query -W -f '${Package} ${Status} ${Priority}\n' | awk '$5 == "required" {print $1, $2, $3, $4}' | sort | comm -13 $here/packages-before.txt - |
    cut -d' ' -f1 | xargs -r dpkg -P >/tmp/said.txt 2>&1 || { cat /tmp/said.txt; fail "purge of required packages"; }
  dpkg-query -W -f '${Package} ${db:Status-Status}\n' | awk '$2 == "config-files" {print $1}' | xargs -r dpkg -P >/tmp/said.txt 2>&1 || { cat /tmp/said.txt; fail "purge"; }
  if [ $kept = yes ]; then
    [ -e $own ] || fail "$own was taken away"
    rm -r /etc/mortise
  fi
  left=$(dpkg-query -W -f '${Package} ${Status}\n' | sort | diff $here/packages-before.txt - || true)
  [ -z "$left" ] || fail "packages are not those of before: $left"
  left=$(files | comm -13 $here/before.txt -)
  [ -z "$left" ] || fail "left behind: $left"
  echo "purged: ${installed[*]}; nothing is left"
}

"$@"
