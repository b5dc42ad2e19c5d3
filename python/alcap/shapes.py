# SPDX-License-Identifier: MIT
"""Generated meshes to try things on. Each function returns V (#V, 3) float64 and F (#F, 3) int32."""
from __future__ import annotations

from typing import Tuple

import numpy as np
import numpy.typing as npt

from . import _alcap

Mesh = Tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]


def tetrahedron() -> Mesh:
    """Regular, on the unit sphere."""
    return _alcap.tetrahedron()


def cube() -> Mesh:
    """[-1, 1]^3 of 12 triangles."""
    return _alcap.cube()


def icosphere(level: int) -> Mesh:
    """The unit sphere: an icosahedron subdivided `level` times; 20 4^level faces."""
    return _alcap.icosphere(level)


def single_triangle() -> Mesh:
    """(0, 0, 0), (1, 0, 0), (0, 1, 0)."""
    return _alcap.single_triangle()


def fan(count: int) -> Mesh:
    """A vertex of valence `count` in a ring of faces on the unit disk."""
    return _alcap.fan(count)


def jittered_sphere(level: int, amount: float = 0.2, seed: int = 1) -> Mesh:
    """An icosphere whose vertices are moved along it, by up to `amount` mean edge lengths."""
    return _alcap.jittered_sphere(level, amount, seed)


def torus_random_diagonals(nu: int, nv: int, R: float = 1.0, r: float = 0.4, seed: int = 1) -> Mesh:
    """The torus with each quad split along a random one of its diagonals: valences 4 to 8."""
    return _alcap.torus_random_diagonals(nu, nv, R, r, seed)


def bumpy_sphere(level: int, amplitude: float, frequency: float) -> Mesh:
    """An icosphere with waves."""
    return _alcap.bumpy_sphere(level, amplitude, frequency)


def noisy_scan(level: int, noise: float = 0.2, seed: int = 1) -> Mesh:
    """A bumpy sphere as a scanner leaves it, with five holes."""
    return _alcap.noisy_scan(level, noise, seed)


def torus(nu: int, nv: int, R: float = 1.0, r: float = 0.4) -> Mesh:
    """Torus of radii R > r around the z axis."""
    return _alcap.torus(nu, nv, R, r)


def genus_surface(genus: int, resolution: int) -> Mesh:
    """A slab with holes."""
    return _alcap.genus_surface(genus, resolution)


def grid(nx: int, ny: int, width: float = 1.0, height: float = 1.0) -> Mesh:
    """A flat rectangle."""
    return _alcap.grid(nx, ny, width, height)


def disk(rings: int) -> Mesh:
    """The flat unit disk."""
    return _alcap.disk(rings)


def cylinder(nu: int, nv: int, radius: float = 1.0, height: float = 2.0) -> Mesh:
    """An open cylinder around the z axis."""
    return _alcap.cylinder(nu, nv, radius, height)


def cad_like(segments: int, steps: int) -> Mesh:
    """A stepped shaft as a CAD kernel tessellates it."""
    return _alcap.cad_like(segments, steps)
