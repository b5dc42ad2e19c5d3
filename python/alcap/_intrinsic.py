# SPDX-License-Identifier: MIT
"""Other triangles on the same surface, and how good triangles are."""
from __future__ import annotations

from typing import Any, Dict, Optional

import numpy.typing as npt

from . import _alcap
from ._alcap import IntrinsicTriangulation, Surface
from ._types import Progress


def intrinsic_delaunay(surface: Surface, *, keep: Optional[npt.ArrayLike] = None, min_angle: float = 0.0,
                       max_radius: float = 0.0, most_flips: float = 100.0, most_vertices: float = 10.0,
                       progress: Progress = None, threads: int = 0) -> IntrinsicTriangulation:
    """The intrinsic Delaunay triangulation of a surface, refined if asked for.

    Slivers are bad for matrices, not for the surface: an edge that is straight in the surface need not be straight in
    space. run_field() solves on such triangles where they pay.

    Parameters
    ----------
    surface : Surface
    keep : (k,) array of int, optional
        Edges that stay as they are, such as features; boundary edges always do.
    min_angle : float
        Radians, in [0, pi/6]. Above 0: vertices are added until no corner is smaller, where none of the surface's own
        is. Below 20 degrees it is known to end. 0: no vertex is added.
    max_radius : float
        In the unit of length of V: with min_angle, also until no circumcircle is larger. 0: no bound.
    most_flips : float
        Per edge; a few are usual.
    most_vertices : float
        Added, at most so many times the vertices that there are.

    Returns
    -------
    IntrinsicTriangulation

    Raises
    ------
    OptionError
    """
    edges: npt.ArrayLike = [] if keep is None else keep
    options = {'keep': edges, 'min_angle': min_angle, 'max_radius': max_radius, 'most_flips': most_flips,
               'most_vertices': most_vertices}
    return _alcap.intrinsic_delaunay(surface, options, progress, threads)


def triangle_quality(surface: Surface) -> Dict[str, Any]:
    """How good the triangles of a surface are.

    Returns
    -------
    dict
        angle_min and angle_max of all corners (radians), cotangent_min (the smallest sum of the cotangents opposite an
        inner edge), not_delaunay (inner edges where that is negative), slivers (faces with a corner below 1 degree).
    """
    return _alcap.triangle_quality(surface)


__all__ = [
    'intrinsic_delaunay', 'triangle_quality',
]
