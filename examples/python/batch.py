# SPDX-License-Identifier: MIT
"""The cross fields of many meshes, each on one thread, on all cores: python3 batch.py [HOW MANY]"""
import sys
import time

import numpy as np

import alcap

count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
V, F = alcap.shapes.icosphere(2)
random = np.random.default_rng(1)
meshes = [(V * random.uniform(0.5, 2.0, 3), F) for _ in range(count)]
start = time.perf_counter()
runs = alcap.run_batch(meshes, n=4)
print(f'{count} meshes in {time.perf_counter() - start:.2f} s; '
      f'{np.mean([len(run.singularities) for run in runs]):.1f} singularities on average')
assert all(run.holds for run in runs)
