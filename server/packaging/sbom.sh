#!/usr/bin/env bash
# What is in the packages, as SPDX 2.3: sbom.sh BUILD VERSION OUT.json PACKAGE=FILE,FILE… …  (a FILE deb:NAME is a package that it runs with)
# Shared libraries are those that the loader takes (ldd), headers those that the compiler read (ninja -t deps); dpkg says which package of which
# version each of these files came from. A file that no package owns is listed as such.
set -euo pipefail
build=$1 version=$2 out=$3
shift 3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# All of dpkg's lists at once: asked for each file, dpkg-query reads them anew.
awk '/\/(include|lib[0-9a-z]*)\// {name = FILENAME; sub(/.*\//, "", name); sub(/(:[a-z0-9]+)?\.list$/, "", name); path = $0; sub(/^\/usr/, "", path); print path "\t" name}' \
  /var/lib/dpkg/info/*.list >"$work/owners.txt"
owners() {  # paths on stdin: the packages that own them; the rest into missing.txt
  # The loader names /lib, dpkg may know the file as /usr/lib or the other way about.
  while read -r path; do printf '%s\t%s\n' "$path" "$(readlink -f "$path")"; done | awk -F'\t' -v missing="$work/missing.txt" '
    NR == FNR {owner[$1] = $2; next}
    {path = $2; sub(/^\/usr/, "", path); if (path in owner) print owner[path]; else print $1 >>missing}' "$work/owners.txt" - | sort -u
}

quoted() { sed -e 's/\\/\\\\/g; s/"/\\"/g' <<<"$1"; }
license_of() {  # of a package: what its copyright file names, as far as it is written to be read by machines
  local file=/usr/share/doc/$1/copyright
  [ -r "$file" ] || { echo "no copyright file"; return; }
  sed -nE 's/^License: *([^ ].*)$/\1/p' "$file" | sort -u | head -n 8 | paste -sd';' | sed 's/;/; /g' | grep . || echo "see $file"
}
entry() {  # entry NAME VERSION ID PURL LICENSE
  printf '    {"SPDXID": "%s", "name": "%s", "versionInfo": "%s", "downloadLocation": "NOASSERTION", "filesAnalyzed": false,\n' "$3" "$(quoted "$1")" "$(quoted "$2")"
  printf '     "licenseConcluded": "NOASSERTION", "licenseDeclared": "NOASSERTION", "licenseComments": "%s", "copyrightText": "NOASSERTION",\n' "$(quoted "$5")"
  printf '     "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": "%s"}]}' "$4"
}
id_of() { printf 'SPDXRef-%s' "$(tr -c 'A-Za-z0-9.\n-' '-' <<<"$1")"; }

packages=() relations=()
relation() { relations+=("{\"spdxElementId\": \"$1\", \"relationshipType\": \"$2\", \"relatedSpdxElement\": \"$3\"}"); }
relations_to_debs() { while read -r name; do relation "$1" "$2" "$(id_of "deb-$name")"; done; }
relation SPDXRef-DOCUMENT DESCRIBES SPDXRef-mortise
packages+=("$(entry mortise "$version" SPDXRef-mortise "pkg:generic/mortise@$version" "see LICENSE")")
: >"$work/debs.txt"
# 1. our packages: what each of them links, of Debian and of ours
for word; do
  ours=${word%%=*} id=$(id_of "${word%%=*}")
  packages+=("$(entry "$ours" "$version" "$id" "pkg:deb/mortise/$ours@$version" "see LICENSE")")
  relation SPDXRef-mortise CONTAINS "$id"
  IFS=, read -ra files <<<"${word#*=}"
  : >"$work/loaded.txt"
  for file in "${files[@]}"; do
    case $file in
      deb:*) echo "${file#deb:}" | tee -a "$work/debs.txt" >"$work/one.txt"; relations_to_debs "$id" DEPENDS_ON <"$work/one.txt" ;;
      *) ldd "$file" | sed -nE 's/.* => (\/[^ ]+) .*/\1/p; s/^[[:space:]]*(\/[^ ]+) .*/\1/p' >>"$work/loaded.txt" ;;
    esac
  done
  for library in $(sed -nE "s#^$(readlink -f "$build")/lib/(libmortise-[a-z]+)\.so.*#\1#p" "$work/loaded.txt" | sort -u); do
    [ "$library" = "$ours" ] || relation "$id" DYNAMIC_LINK "$(id_of "$library")"
  done
  grep -vF "$(readlink -f "$build")/" "$work/loaded.txt" | owners >"$work/linked.txt" || true
  relations_to_debs "$id" DYNAMIC_LINK <"$work/linked.txt"
  cat "$work/linked.txt" >>"$work/debs.txt"
done
sort -u -o "$work/debs.txt" "$work/debs.txt"
# 2. what they are compiled with. Of each folder of headers one is asked for: thousands of them are of a few packages.
ninja -C "$build" -t deps 2>/dev/null | sed -nE 's/^ +(\/usr\/(include|lib)\/[^ ]+)$/\1/p' | sort -u |
  awk -F/ '{k=$0; sub(/\/[^\/]*$/, "", k); if (!(k in seen) || k == "/usr/include") {seen[k] = 1; print}}' | owners | comm -13 "$work/debs.txt" - >"$work/built_with.txt"
relations_to_debs SPDXRef-mortise STATIC_LINK <"$work/built_with.txt"
# 3. all of these packages
sort -u "$work/debs.txt" "$work/built_with.txt" >"$work/all.txt"
while read -r name of architecture; do
  packages+=("$(entry "$name" "$of" "$(id_of "deb-$name")" "pkg:deb/debian/$name@$of?arch=$architecture" "$(license_of "$name")")")
done < <(xargs dpkg-query -W -f '${Package} ${Version} ${Architecture}\n' <"$work/all.txt" | sort -u -k1,1)
lock=$(cd "$(dirname "$0")/../../client/web/page" && pwd)/package-lock.json
three=$(sed -nE '/"node_modules\/three": \{/,/\}/s/.*"version": "([^"]+)".*/\1/p' "$lock")
packages+=("$(entry three "$three" SPDXRef-npm-three "pkg:npm/three@$three" MIT)")
relation SPDXRef-mortise-web CONTAINS SPDXRef-npm-three
number=0
if [ -s "$work/missing.txt" ]; then
  while read -r path; do
    number=$((number + 1))
    packages+=("$(entry "$path" unknown "SPDXRef-file-$number" "pkg:generic/unknown" "no Debian package owns this file")")
    relation SPDXRef-mortise DEPENDS_ON "SPDXRef-file-$number"
  done < <(sort -u "$work/missing.txt")
fi

joined() { local first=$1; shift; printf '%s' "$first"; [ $# -eq 0 ] || printf ',\n%s' "$@"; }
created=$(date -u ${SOURCE_DATE_EPOCH:+-d "@$SOURCE_DATE_EPOCH"} +%Y-%m-%dT%H:%M:%SZ)
key=$(sha256sum <"$work/all.txt" | cut -c1-16)
{
  printf '{"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": "mortise-%s",\n' "$version"
  printf ' "documentNamespace": "https://mortise.invalid/spdx/%s/%s",\n' "$version" "$key"
  printf ' "creationInfo": {"created": "%s", "creators": ["Tool: mortise-sbom"]},\n "packages": [\n' "$created"
  joined "${packages[@]}"
  printf '],\n "relationships": [\n    '
  joined "${relations[@]}"
  printf ']}\n'
} >"$out"
