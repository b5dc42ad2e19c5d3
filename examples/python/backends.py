# SPDX-License-Identifier: MIT
"""The linear backends compiled in, SciPy's splu as one of our own, and SciPy's eigsh from outside, on one problem."""
import time

import scipy.sparse.linalg

import alcap

surface = alcap.Surface(*alcap.shapes.bumpy_sphere(4, 0.3, 4.0))
with alcap.register_linear_solver('splu', scipy.sparse.linalg.splu):
    values = []
    for solver in alcap.linear_solvers():
        start = time.perf_counter()
        run = alcap.smoothest_field(surface, n=4, solver=solver)
        values.append(run.eigen[0]['lambda'])
        print(f'{solver:<12} {1e3 * (time.perf_counter() - start):7.1f} ms  {values[-1]:.12f}  {run.eigen[0]["solver"]}')
S, M = alcap.energy_matrices(run.connection, n=4)
start = time.perf_counter()
outside = scipy.sparse.linalg.eigsh(S, k=1, M=M, sigma=-1 / surface.area, return_eigenvectors=False)[0]
print(f'{"eigsh":<12} {1e3 * (time.perf_counter() - start):7.1f} ms  {outside:.12f}')
assert all(abs(value - outside) < 1e-7 * outside for value in values)
