#!/bin/sh
# The manual page of a program, from its own --help: manual.sh PROGRAM VERSION OUT.1 (makes OUT.1.gz)
set -eu
program=$1 version=$2 out=$3
name=$(basename "$program")
# The first line of --help is "name: what it does", and the usage line has the path of this build.
spoken=$(mktemp)
trap 'rm -f "$spoken"' EXIT
cat >"$spoken" <<WRAP
#!/bin/sh
if [ "\${1:-}" = --version ]; then echo "$name (mortise) $version"; exit; fi
"$program" --help | sed -e 's|$program|$name|g' -e '1{/^$name: /d}' -e 's/^Positionals:/Arguments:/'
WRAP
chmod +x "$spoken"
what=$("$program" --help | sed -n "1s/^$name: //p")
help2man --no-info --section 1 --name "${what:-a program of mortise}" --include "$(dirname "$0")/manual.h2m" --output "$out" "$spoken"
# help2man names what it ran.
sed -i "s/$(basename "$spoken")/$name/g; s/$(basename "$spoken" | tr '[:lower:]' '[:upper:]')/$(echo "$name" | tr '[:lower:]' '[:upper:]')/g" "$out"
gzip -9nf "$out"
