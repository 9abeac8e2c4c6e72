#!/usr/bin/env bash
# What is in the programs, as SPDX 2.3: sbom.sh BUILD VERSION OUT.json PROGRAMS…
# Shared libraries are those that the loader takes (ldd), headers those that the compiler read (ninja -t deps); dpkg says which package of which
# version each of these files came from. A file that no package owns is listed as such.
set -euo pipefail
build=$1 version=$2 out=$3
shift 3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

owners() {  # paths on stdin: the packages that own them; the rest into missing.txt
  # The loader names /lib, dpkg may know the file as /usr/lib or the other way about.
  while read -r path; do
    real=$(readlink -f "$path")
    found=$(dpkg-query -S "$real" 2>/dev/null || dpkg-query -S "${real#/usr}" 2>/dev/null || dpkg-query -S "/usr$real" 2>/dev/null || true)
    found=$(head -n 1 <<<"$found")
    if [ -n "$found" ]; then printf '%s\n' "${found%%: /*}" | cut -d, -f1; else printf '%s\n' "$path" >>"$work/missing.txt"; fi
  done
}

for program in "$@"; do ldd "$build/bin/$program"; done | sed -nE 's/.* => (\/[^ ]+) .*/\1/p; s/^[[:space:]]*(\/[^ ]+) .*/\1/p' | sort -u >"$work/libraries.txt"
owners <"$work/libraries.txt" | sort -u >"$work/linked.txt"
if [ -f "$build/build.ninja" ]; then
  # Of each folder of headers one is asked for: thousands of them are of a few packages.
  ninja -C "$build" -t deps 2>/dev/null | sed -nE 's/^ +(\/usr\/(include|lib)\/[^ ]+)$/\1/p' | sort -u | awk -F/ '{k=$0; sub(/\/[^\/]*$/, "", k); if (!(k in seen) || k == "/usr/include") {seen[k] = 1; print}}' >"$work/headers.txt"
  owners <"$work/headers.txt" | sort -u >"$work/read.txt"
else
  : >"$work/read.txt"
fi
comm -13 "$work/linked.txt" "$work/read.txt" >"$work/built_with.txt"

quoted() { sed -e 's/\\/\\\\/g; s/"/\\"/g' <<<"$1"; }
license_of() {  # of a package: what its copyright file names, as far as it is written to be read by machines
  local file=/usr/share/doc/${1%%:*}/copyright
  [ -r "$file" ] || { echo "no copyright file"; return; }
  sed -nE 's/^License: *([^ ].*)$/\1/p' "$file" | sort -u | head -n 8 | paste -sd';' | sed 's/;/; /g' | grep . || echo "see $file"
}
entry() {  # entry NAME VERSION ID PURL LICENSE
  printf '    {"SPDXID": "%s", "name": "%s", "versionInfo": "%s", "downloadLocation": "NOASSERTION", "filesAnalyzed": false,\n' "$3" "$(quoted "$1")" "$(quoted "$2")"
  printf '     "licenseConcluded": "NOASSERTION", "licenseDeclared": "NOASSERTION", "licenseComments": "%s", "copyrightText": "NOASSERTION",\n' "$(quoted "$5")"
  printf '     "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": "%s"}]}' "$4"
}
id_of() { printf 'SPDXRef-%s' "$(tr -c 'A-Za-z0-9.\n-' '-' <<<"$1")"; }

packages=() relations=('{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-mortise"}')
packages+=("$(entry mortise "$version" SPDXRef-mortise "pkg:generic/mortise@$version" "see LICENSE")")
while read -r kind list; do
  while read -r package; do
    of=$(dpkg-query -W -f '${Version} ${Architecture}' "$package")
    id=$(id_of "deb-$package")
    packages+=("$(entry "${package%%:*}" "${of% *}" "$id" "pkg:deb/debian/${package%%:*}@${of% *}?arch=${of#* }" "$(license_of "$package")")")
    relations+=("{\"spdxElementId\": \"SPDXRef-mortise\", \"relationshipType\": \"$kind\", \"relatedSpdxElement\": \"$id\"}")
  done <"$list"
done <<LISTS
DYNAMIC_LINK $work/linked.txt
STATIC_LINK $work/built_with.txt
LISTS
lock=$(cd "$(dirname "$0")/../../client/web/page" && pwd)/package-lock.json
three=$(sed -nE '/"node_modules\/three": \{/,/\}/s/.*"version": "([^"]+)".*/\1/p' "$lock")
packages+=("$(entry three "$three" SPDXRef-npm-three "pkg:npm/three@$three" MIT)")
relations+=('{"spdxElementId": "SPDXRef-mortise", "relationshipType": "CONTAINS", "relatedSpdxElement": "SPDXRef-npm-three"}')
number=0
if [ -s "$work/missing.txt" ]; then
  while read -r path; do
    number=$((number + 1))
    packages+=("$(entry "$path" unknown "SPDXRef-file-$number" "pkg:generic/unknown" "no Debian package owns this file")")
    relations+=("{\"spdxElementId\": \"SPDXRef-mortise\", \"relationshipType\": \"DEPENDS_ON\", \"relatedSpdxElement\": \"SPDXRef-file-$number\"}")
  done < <(sort -u "$work/missing.txt")
fi

joined() { local first=$1; shift; printf '%s' "$first"; [ $# -eq 0 ] || printf ',\n%s' "$@"; }
created=$(date -u ${SOURCE_DATE_EPOCH:+-d "@$SOURCE_DATE_EPOCH"} +%Y-%m-%dT%H:%M:%SZ)
key=$(cat "$work/linked.txt" "$work/built_with.txt" | sha256sum | cut -c1-16)
{
  printf '{"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": "mortise-%s",\n' "$version"
  printf ' "documentNamespace": "https://mortise.invalid/spdx/%s/%s",\n' "$version" "$key"
  printf ' "creationInfo": {"created": "%s", "creators": ["Tool: mortise-sbom"]},\n "packages": [\n' "$created"
  joined "${packages[@]}"
  printf '],\n "relationships": [\n    '
  joined "${relations[@]}"
  printf ']}\n'
} >"$out"
