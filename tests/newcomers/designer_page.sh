#!/usr/bin/env bash
# A designer with two STL files and a browser: from the command to the verdict on the page, without a line of YAML.
command -v node >/dev/null || skip "program absent: node"
# Stand-ins of files of one's own.
run ./mortise generate plate_with_bore bore_mm=20 facets=32 -o plate.stl
run ./mortise generate dowel diameter_mm=20 length_mm=40 chamfer_mm=1 facets=32 phase_rad=0.098 -o peg.stl
# By hand: ./mortise open, its address in a browser, both files dropped there.
[ "$(node "$SOURCE/tests/web/from_files.mjs" --why-not)" = "" ] || skip "program absent: a browser, or its modules (npm ci --prefix tests/web)"
run node "$SOURCE/tests/web/from_files.mjs" ./mortise plate.stl peg.stl
saw '^[0-9.]+ s after the command: potential, plate × peg, '
