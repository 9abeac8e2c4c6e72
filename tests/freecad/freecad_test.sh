#!/usr/bin/env bash
# The add-on of FreeCAD, by freecadcmd: freecad_test.sh SOURCE BIN
set -euo pipefail
source=$1 bin=$2
command -v freecadcmd >/dev/null || { echo "[  SKIPPED ] program absent: freecadcmd (packages-bench.txt)"; exit 77; }
[ -x "$bin/mortise-import-step" ] || { echo "[  SKIPPED ] program absent: OpenCASCADE (packages-step.txt)"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Its settings lie in a home of its own. A session is only started: a program of this name writes down how.
printf '#!/bin/sh\necho "$@" >started.txt\n' >"$work/mortise"
chmod 755 "$work/mortise"
ln -s "$bin"/mortise-{check,import-step} "$work"
HOME=$work MORTISE_BIN=$work MORTISE_SOURCE=$source timeout 250 freecadcmd "$source/tests/freecad/freecad_test.py" >"$work/said.txt" 2>&1 || true
grep -E '^(ok|FAILED)' "$work/said.txt" || true
grep -q '^ALL DONE$' "$work/said.txt" || { tail -n 40 "$work/said.txt"; exit 1; }
