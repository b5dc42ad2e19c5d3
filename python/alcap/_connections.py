# SPDX-License-Identifier: MIT
"""Connections of all kinds, cones, frames of faces, parallel transport."""
from __future__ import annotations

from dataclasses import dataclass
from typing import List, Mapping, Optional, Sequence, Tuple, Union

import numpy.typing as npt

from . import _alcap
from ._alcap import ConnectedSurface, CurveSet, Frames, Polyline, Surface
from ._types import Progress, given


def connect(surface: Surface, connection: str = 'global', *, detail: Optional[float] = None,
            length_factor: Optional[str] = None, tan_cap: Optional[float] = None,
            cones: Optional[Sequence[Tuple[int, float]]] = None, balance_cones: Optional[bool] = None,
            generator_holonomy: Optional[Sequence[float]] = None, loop_index: Optional[Sequence[float]] = None,
            target: Optional[Mapping[str, npt.ArrayLike]] = None, spread: Optional[bool] = None,
            connection_tolerance: Optional[float] = None, connection_iterations: Optional[int] = None, n: int = 1,
            progress: Progress = None, threads: int = 0) -> ConnectedSurface:
    """A surface with a connection on it.

    Parameters
    ----------
    surface : Surface
    connection : str
        'global' (as Levi-Civita as possible), 'local', 'polar', 'polar-barycenter', 'trivial' with cones that are
        multiples of 1/n, or 'metric': with cones of any size, or nearest to a target.
    detail : float
        Smaller spreads the curvature of a vertex over more faces: fields ignore small bumps. 1 by default.
    length_factor : str
        'mean_edge' (default), 'metric' or 'per_edge'.
    cones : sequence of (vertex, index)
        Of a trivial or metric connection; indices in turns. They must sum to the Euler characteristic.
    balance_cones : bool
        Add cones until they do.
    generator_holonomy, loop_index : sequence of float
        In turns, of surface.homology_generators() and surface.boundary_loops.
    target : dict with one array
        Of a metric connection: rotation (3 #F,), adjustment (3 #F,), vertex_curvature (#V,) or face_curvature (#F,),
        radians.
    spread : bool
        With a target: whether the curvature of vertices may spread over faces; True by default.
    connection_tolerance : float
        Relative residual of the global connection; 1e-6 by default.
    connection_iterations : int
        When it is given up; 5000 by default.
    n : int
        Of a trivial connection: cones and holonomies are multiples of 1/n turn.

    Returns
    -------
    ConnectedSurface
        It is a Surface as well.

    Raises
    ------
    OptionError
    """
    options = given(connection=connection, detail=detail, length_factor=length_factor, tan_cap=tan_cap, cones=cones,
                     balance_cones=balance_cones, generator_holonomy=generator_holonomy, loop_index=loop_index,
                     target=None if target is None else dict(target), spread=spread,
                    connection_tolerance=connection_tolerance, connection_iterations=connection_iterations, n=n)
    return _alcap.connect(surface, options, progress, threads)


def balance_cones(surface: Surface, cones: Sequence[Tuple[int, float]], n: int = 1) -> List[Tuple[int, float]]:
    """The cones (vertex, index in turns) and behind them those that closed components lack, in steps of 1/n."""
    return _alcap.balance_cones(surface, cones, n)


def face_frames(surface: Surface) -> Frames:
    """Frames of the faces: X along the first edge, N the normal."""
    return _alcap.face_frames(surface)


@dataclass(frozen=True)
class Transported:
    """What became of a vector on its way.

    Attributes
    ----------
    z : complex
        The component in the frame at the end.
    turn : float
        How far it has turned against the frames on the way, radians, for n = 1.
    turn_from_path : float
        How far it has turned against the direction of the path, radians, for n = 1.
    """

    z: complex
    turn: float
    turn_from_path: float


def transport(surface: ConnectedSurface, path: Union[Polyline, npt.ArrayLike], z: complex, n: int = 1) -> Transported:
    """Parallel transport of an n-vector along vertices (k,) that edges join, or along a Polyline.

    Parameters
    ----------
    path : (k,) array of int, or Polyline
        Closed where its end is its start.
    z : complex
        In the frame of the first vertex, or of the face of the first segment; z = w^n for a vector w.
    n : int
        The degree of the field that z is a value of.

    Returns
    -------
    Transported
    """
    if isinstance(path, Polyline):
        return Transported(*_alcap.transport_along_line(surface, path, z, n))
    return Transported(*_alcap.transport_along_vertices(surface, path, z, n))


def transport_along_curve(surface: ConnectedSurface, curves: CurveSet, k: int, z: complex, n: int = 1) -> Transported:
    """The same along curve k of a CurveSet; z is in the frame of the face that its first point names."""
    return Transported(*_alcap.transport_along_curve(surface, curves, k, z, n))


def transport_along_points(surface: ConnectedSurface, faces: npt.ArrayLike, barycentric: npt.ArrayLike, z: complex,
                           n: int = 1) -> Transported:
    """The same along points, faces (k,) and barycentric (k, 3), each of which lies in a face with the next one."""
    return Transported(*_alcap.transport_along_points(surface, faces, barycentric, z, n))


__all__ = [
    'Transported', 'balance_cones', 'connect', 'face_frames', 'transport', 'transport_along_curve', 'transport_along_points',
]
