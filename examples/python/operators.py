# SPDX-License-Identifier: MIT
"""Divergence and curl of vectors of your own: rotation about the z axis of the sphere has no divergence."""
import numpy as np

import alcap

surface = alcap.connect(alcap.Surface(*alcap.shapes.icosphere(4)))
vectors = np.cross([0.0, 0.0, 1.0], surface.V)
field = alcap.Field.from_vectors(1, vectors, surface.frames)
P, _ = alcap.first_order_operators(surface, n=1)
div, curl = np.real(P @ field.u) / surface.areas, np.imag(P @ field.u) / surface.areas
z = surface.V[surface.F].mean(axis=1)[:, 2]
print(f'largest divergence {np.abs(div).max():.2e}; curl is 2 z within {np.abs(curl - 2 * z).max():.2e}')
assert np.sqrt(np.mean(div**2)) < 0.02 and np.sqrt(np.mean((curl - 2 * z)**2)) < 0.02
