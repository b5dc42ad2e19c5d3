# SPDX-License-Identifier: MIT
"""Strokes on a surface, and integral curves of fields."""
from __future__ import annotations

import os
from typing import Any, Optional

import numpy as np
import numpy.typing as npt

from . import _alcap
from ._alcap import ConnectedSurface, CurveSet, Field, Polyline, Surface
from ._fields import singularities_of
from ._types import Path, Progress


def stroke_through_points(surface: Surface, faces: npt.ArrayLike, barycentric: npt.ArrayLike) -> Polyline:
    """A line through points of the surface: faces (k,), barycentric coordinates (k, 3)."""
    return _alcap.stroke_through_points(surface, faces, barycentric)


def polyline_through(surface: Surface, faces: npt.ArrayLike, barycentric: npt.ArrayLike) -> Polyline:
    """A line through points, each of which lies in a face with the next one; needs no positions."""
    return _alcap.polyline_through(surface, faces, barycentric)


def stroke_along_vertices(surface: Surface, vertices: npt.ArrayLike) -> Polyline:
    """A line along edges; vertices (k,) that no edge joins are joined by a shortest path."""
    return _alcap.stroke_along_vertices(surface, vertices)


def stroke_from_space(surface: Surface, points: npt.ArrayLike) -> Polyline:
    """A line through the points of the surface closest to points (k, 3)."""
    return _alcap.stroke_from_space(surface, points)


def streamlines(surface: ConnectedSurface, field: Field, *, earlier: Optional[CurveSet] = None,
                progress: Progress = None, **options: Any) -> CurveSet:
    """Evenly spaced integral curves of all families.

    Parameters
    ----------
    earlier : CurveSet, optional
        Curves of the field before it changed, or further apart: what still follows this one, to within drift (0.5)
        degrees, is kept, and only the room that is left is filled.
    **options
        In diagonals of the box around the mesh: spacing (0.01), min_length (0.02), max_length (5). separation (0.5, a
        fraction of spacing), tolerance (1e-6), singularity_radius (0.01), max_curves, max_points.

    Returns
    -------
    CurveSet
    """
    return _alcap.streamlines(surface, field, options, progress, earlier)


def trace_curves(surface: ConnectedSurface, field: Field, faces: npt.ArrayLike, barycentric: npt.ArrayLike,
                 angles: Optional[npt.ArrayLike] = None, *, progress: Progress = None, **options: Any) -> CurveSet:
    """One integral curve per seed: faces (k,), barycentric (k, 3), direction angles (k,) in the face's frame, radians.

    `options` as of streamlines(), and sides: 'both', 'forward' or 'backward'.
    """
    given = np.zeros(np.shape(faces)) if angles is None else angles
    return _alcap.trace_curves(surface, field, faces, barycentric, given, options, progress)


def separatrices(surface: ConnectedSurface, field: Field, singularities: Optional[Any] = None, *,
                 progress: Progress = None, **options: Any) -> CurveSet:
    """The curves that leave singularities straight; `options` as of streamlines()."""
    return _alcap.separatrices(surface, field, singularities_of(surface, field, singularities), options, progress)


def write_curves(curves: CurveSet, n: int, path: Path) -> None:
    """Writes curves of an n-field as .vtp, .obj or .json. Raises FileError."""
    _alcap.write_curves(curves, n, os.fspath(path))


__all__ = [
    'polyline_through', 'separatrices', 'streamlines', 'stroke_along_vertices', 'stroke_from_space',
    'stroke_through_points', 'trace_curves', 'write_curves',
]
