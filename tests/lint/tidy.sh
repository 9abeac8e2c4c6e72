#!/usr/bin/env bash
# clang-tidy over all programs and the library, with .clang-tidy; exit 1: it found something. tidy.sh SOURCE BUILD [REGEX of files]
set -euo pipefail
source=$1 build=$2 only=${3:-}
tidy=$(command -v clang-tidy || command -v clang-tidy-14) || { echo "[  SKIPPED ] program absent: clang-tidy (packages-tests.txt)"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Without what clang does not know, and without the headers that another compiler has precompiled.
python3 - "$source" "$build" "$only" "$work/compile_commands.json" >"$work/files" <<'PY'
import json, re, sys
source, build, only, out = sys.argv[1:]
mine, commands = re.compile(r"^(%s/|%s/)(common|server|client|idl)/" % (re.escape(source), re.escape(build))), {}
for entry in json.load(open(build + "/compile_commands.json")):
    file = entry["file"]
    if not mine.match(file) or "wire_types" in file or file.endswith((".hxx", "/nothing.cpp")) or not re.search(only, file):
        continue
    entry["command"] = re.sub(r"-Winvalid-pch|-include \S+cmake_pch\.hxx|-fno-semantic-interposition|-Wno-stringop-\S+|-Wno-restrict|-Werror", "",
                              entry["command"])
    commands.setdefault(file, entry)
json.dump(list(commands.values()), open(out, "w"))
print("\n".join(commands))
PY
echo "$(wc -l <"$work/files") files"
# Findings go to stdout; what it says of its own work, to a file.
xargs -P "$(nproc)" -I{} nice "$tidy" --quiet -p "$work" {} <"$work/files" 2>"$work/said" || { grep -E ' error: ' "$work/said" || true; exit 1; }
