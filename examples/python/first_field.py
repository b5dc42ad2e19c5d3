# SPDX-License-Identifier: MIT
"""A cross field, its singularities, and a picture: python3 first_field.py [MESH [PICTURE]]"""
import sys

import alcap

if len(sys.argv) > 1:
    mesh = alcap.read_mesh(sys.argv[1])
    V, F = mesh.V, mesh.F
else:
    V, F = alcap.shapes.bumpy_sphere(4, 0.3, 4.0)
run = alcap.smoothest_field(alcap.Surface(V, F), n=4)
print(run)
for s in run.singularities:
    print(f'face {s["face"]}: index {s["index"]}/4')
assert run.holds
if len(sys.argv) > 2:
    run.plot().savefig(sys.argv[2], dpi=150)
