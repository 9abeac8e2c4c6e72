#!/usr/bin/env bash
# A designer with two STL files: does the peg fit into the plate?
# Stand-ins of files of one's own.
run ./mortise generate plate_with_bore bore_mm=20 facets=32 -o plate.stl
run ./mortise generate dowel diameter_mm=20 length_mm=40 chamfer_mm=1 facets=32 phase_rad=0.098 -o peg.stl
run ./mortise judge plate.stl peg.stl --fit H7/g6 --picture verdict.png
saw '^FAKE +plate × peg .*H7/g6'
made verdict.png
run ./mortise judge plate.stl peg.stl --fit H7/p6
saw '^REAL +plate × peg .*H7/p6'
run './mortise inspect plate.stl peg.stl >my.yaml'
saw 'bore_1' my.yaml
run ./mortise judge my.yaml -v
saw 'plate × peg'
run ./mortise open plate.stl peg.stl --seconds 3
saw 'POTENTIAL +plate × peg'
