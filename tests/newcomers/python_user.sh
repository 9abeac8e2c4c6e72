#!/usr/bin/env bash
# A user of Python, whose shapes come from a script: check a file, judge arrays, turn a dimension until it fits.
command -v /usr/bin/python3 >/dev/null && /usr/bin/python3 -c 'import mortise' 2>/dev/null || skip "program absent: pybind11 or numpy"
[ -x "$BUILD/bin/mortise-import-step" ] || skip "program absent: OpenCASCADE"
cat >clashes.py <<'PYTHON'
import mortise
for pair in mortise.check("scenarios/tensioner.step").clashes:
    print(pair.collision_class, pair.part_a, pair.part_b, pair.places[0].depth_mm)
PYTHON
run /usr/bin/python3 clashes.py
saw '^real cover bracket'
cat >shapes.py <<'PYTHON'
import numpy as np
import mortise

def tube(inner, outer, height, facets=64):  # as a script of CAD makes it: points and triangles
    turn = 2 * np.pi * np.arange(facets) / facets
    ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    up = np.array([0, 0, height])
    points = np.concatenate([outer * ring, inner * ring, outer * ring + up, inner * ring + up])
    triangles = []
    for i in range(facets):
        j = (i + 1) % facets
        o, n, O, N = (k * facets + i for k in range(4))
        p, m, P, M = (k * facets + j for k in range(4))
        triangles += [(o, p, P), (o, P, O), (n, N, M), (n, M, m), (o, n, m), (o, m, p), (O, P, M), (O, M, N)]
    return points, triangles

scene = mortise.Scene()
scene.add(tube(10.0, 20.0, 10.0), name="bush", fixed=True)
for diameter in (20.1, 20.0, 19.9):
    pin = scene.add(tube(2.0, diameter / 2, 30.0), name=f"pin {diameter}", pose=[0, 0, -10])
    for clash in scene.judge():
        print(pin, clash.collision_class, clash.depth_mm, clash.explanation)
    scene.place(pin, [1000 * diameter, 0, 0])
PYTHON
run /usr/bin/python3 shapes.py
saw '^pin 20.1 real'
