# SPDX-License-Identifier: MIT
"""Smoothest and aligned fields of one mesh or of many, with their certificates."""
from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _alcap
from ._alcap import ConnectedSurface, Surface
from ._errors import OptionError
from ._features import FeatureGraph, graph_of
from ._run import Run
from ._types import CONNECTION_OPTIONS, EIGEN_OPTIONS, Ints, Progress


#: None, True (the defaults) or an Alignment.
Align = Union[None, bool, 'Alignment']


def _split(options: Mapping[str, Any]) -> Tuple[Dict[str, Any], Dict[str, Any]]:
    """Options of the connection, options of the eigensolver."""
    for name in options:
        if name not in CONNECTION_OPTIONS + EIGEN_OPTIONS:
            raise TypeError(f'unexpected option {name!r}; known are {", ".join(CONNECTION_OPTIONS + EIGEN_OPTIONS)}')
    return ({k: v for k, v in options.items() if k in CONNECTION_OPTIONS and v is not None},
            {k: v for k, v in options.items() if k in EIGEN_OPTIONS and v is not None})


@dataclass(frozen=True)
class Alignment:
    """Which features a field runs along, and how.

    Parameters
    ----------
    angle, corner_angle, boundary, creases, low_angle, gap, spur
        Which edges are features, as of sharp_edges().
    edges : (k, 2) array of int, optional
        Feature edges by their vertices, as read_sharp() gives them, instead of those that fold.
    across : bool
        Across the features instead of along.
    weight : float
        0: held exactly; above 0: drawn as by a stroke of this weight.
    max_steps : int
        Of renormalising and diffusing; 0: the harmonic field alone.
    """

    angle: float = math.radians(40)
    corner_angle: float = math.radians(40)
    boundary: bool = True
    creases: bool = True
    low_angle: float = 0.0
    gap: float = 0.0
    spur: float = 0.0
    edges: Optional[npt.ArrayLike] = None
    across: bool = False
    weight: float = 0.0
    max_steps: int = 1000


@dataclass(frozen=True)
class RunFeatures:
    """What a field was aligned with, and how well.

    Attributes
    ----------
    graph : FeatureGraph
    pieces : list of dict
        How each component was solved, as of aligned_field().
    free_corners : (k,) array of int32
        Feature vertices that no n-field can be held at.
    report : dict
        As measure_features(): deviation of every line and of all, in degrees, singularities at corners.
    followed : bool
        Along every line, off its corners, within 10 degrees on average.
    """

    graph: FeatureGraph
    pieces: List[Dict[str, Any]]
    free_corners: Ints
    report: Dict[str, Any]
    followed: bool


def run_features(found: Any) -> Optional[RunFeatures]:
    """RunFeatures of what the module found; None where there are no features."""
    return None if found is None else RunFeatures(graph_of(found['graph']), found['pieces'],
                                                  found['free_corners'], found['report'], found['followed'])


class FieldRun(Run):
    """A smoothest or aligned field with everything that was computed on the way, see smoothest_field()."""

    @property
    def features(self) -> Optional[RunFeatures]:
        """What the field was aligned with; None where it was not."""
        return run_features(self._run.features)

    @property
    def triangulation(self) -> Optional[Dict[str, Any]]:
        """The triangles that the field was solved on, where they are not those of the mesh; else None.

        before and after (see triangle_quality()), flips, added (vertices), faces, barred, complete, seconds, connection
        (the report of the one made there), and of it, where it has cones, cones, generator_holonomy and loop_index, and
        parallel (False: it has cones or holonomies that no field of this n is parallel to); singularities (how many
        there are on those triangles).
        """
        return self._run.triangulation

    @property
    def modes(self) -> Tuple[npt.NDArray[Any], npt.NDArray[Any], Dict[str, Any]]:
        """Eigenvalues, U (#V, modes) and report, as of eigenpairs(); empty where one mode was asked for."""
        return self._run.modes

    @property
    def copies_of(self) -> Ints:
        """(k,) int32: of the vertices behind the given ones, the one that each is a copy of (split bow-ties)."""
        return self._run.copies_of

    @property
    def face_of(self) -> Ints:
        """The given number of each face; empty where all are kept."""
        return self._run.face_of


_MIN_ANGLE = 15 * np.pi / 180


def _how(n: int, s: float, normalise: bool, align: Align, modes: int = 1, repairs: Sequence[str] = (),
         weld_tolerance: float = 0.0, triangulation: str = 'auto', min_angle: float = _MIN_ANGLE) -> Dict[str, Any]:
    chosen = Alignment() if align is True else None if align is False else align
    if chosen is not None and chosen.edges is not None:
        chosen = replace(chosen, edges=np.asarray(chosen.edges))
    return {'n': n, 's': s, 'normalise': normalise, 'modes': modes, 'repairs': list(repairs),
            'weld_tolerance': weld_tolerance, 'triangulation': triangulation, 'min_angle': min_angle,
            'align': None if chosen is None else vars(chosen)}


def smoothest_field(surface: Surface, n: int = 4, *, s: float = 0.0, normalise: bool = False, align: Align = None,
                    modes: int = 1, triangulation: str = 'auto', min_angle: float = _MIN_ANGLE,
                    progress: Progress = None, threads: int = 0, **options: Any) -> FieldRun:
    """The smoothest n-vector field of a surface, with singularities and certificate.

    Parameters
    ----------
    surface : Surface
        A connection is made for it, as `options` say.
    n : int
        1 vectors, 2 lines, 4 crosses, 6 hexagons.
    s : float
        Energy family in [-1, 1] (Knoeppel et al. 2013); 0 is the Dirichlet energy.
    normalise : bool
        Divide by |u| afterwards.
    align : bool or Alignment
        True: a field of even n along creases and boundary instead of the smoothest one; or an Alignment.
    modes : int
        More than 1: `run.modes` holds so many of the smoothest fields.
    triangulation : str
        'extrinsic': solved on the mesh's own triangles; 'intrinsic': on better ones of the same surface; 'auto': on
        those where one face in a hundred has a corner below 1 degree.
    min_angle : float
        The least corner of the better triangles, in radians, at most pi/6; 0 adds no vertices to them.
    progress : callable(phase, fraction), optional
        Called on this thread; what it raises ends the call. See progress_bar().
    threads : int
        The most threads; 0: all. Results do not depend on it.
    **options
        Of the connection: connection, detail, length_factor, tan_cap, cones, balance_cones, generator_holonomy,
        loop_index, target, spread, connection_tolerance, connection_iterations, see connect(). Of the eigensolver:
        angle_tolerance (0.01 degrees), tolerance (a residual, instead), solver, method, max_iterations (1000), seed,
        prove_smallest.

    Returns
    -------
    FieldRun

    Raises
    ------
    OptionError, SolveError
    KeyboardInterrupt
        Ctrl-C; within a tenth of a second, but for a factorisation that has begun.
    """
    connection, eigen = _split(options)
    if isinstance(surface, ConnectedSurface):
        raise TypeError('smoothest_field makes the connection itself: pass the Surface and connection=..., or use '
                        'eigen_design for the smoothest field of a ConnectedSurface')
    how = _how(n, s, normalise, align, modes, (), 0.0, triangulation, min_angle)
    return FieldRun(_alcap.run_field(surface, how, connection, eigen, progress, threads))


def run_field(V: npt.ArrayLike, F: npt.ArrayLike, n: int = 4, *, repairs: Sequence[str] = (),
              weld_tolerance: float = 0.0, s: float = 0.0, normalise: bool = False, align: Align = None,
              modes: int = 1, triangulation: str = 'auto', min_angle: float = _MIN_ANGLE, progress: Progress = None,
              threads: int = 0, **options: Any) -> FieldRun:
    """smoothest_field() of arrays, after repairs.

    Parameters
    ----------
    V : (#V, 3) array of float64 or float32
    F : (#F, 3) array of integers
    repairs : sequence of str
        As of repair_mesh(), and 'mollify': edges are taken a little longer, so that every face has an area. Vertices
        keep their numbers; copies come behind them, see `run.copies_of`.
    weld_tolerance : float
        Of 'weld', in diagonals of the box around all points.
    align, modes, triangulation, min_angle
        As of smoothest_field().

    Returns
    -------
    FieldRun

    Raises
    ------
    MeshError
        The mesh cannot be used; names the elements.
    """
    connection, eigen = _split(options)
    how = _how(n, s, normalise, align, modes, repairs, weld_tolerance, triangulation, min_angle)
    return FieldRun(_alcap.run_field_arrays(V, F, how, connection, eigen, progress, threads))


def run_batch(meshes: Sequence[Any], n: int = 4, *, jobs: int = 0, repairs: Sequence[str] = (),
              weld_tolerance: float = 0.0, s: float = 0.0, normalise: bool = False, align: Align = None,
              modes: int = 1, triangulation: str = 'auto', min_angle: float = _MIN_ANGLE,
              progress: Progress = None, errors: str = 'raise',
              **options: Any) -> List[Union[FieldRun, Exception]]:
    """The smoothest fields of many meshes, each on one thread, on all cores.

    Parameters
    ----------
    meshes : sequence of Surface or (V, F)
    jobs : int
        Meshes at a time; 0: one per core.
    repairs, weld_tolerance, align, modes, triangulation, min_angle
        As of run_field(), for every mesh.
    errors : str
        'raise' raises the first error when all meshes are done; 'return' puts it in the place of the run.

    Returns
    -------
    list of FieldRun
        In the order of the meshes, the same to the last bit as one after the other.
    """
    if errors not in ('raise', 'return'):
        raise OptionError(f"option 'errors' = {errors}: must be 'raise' or 'return'", 'errors', errors,
                          "must be 'raise' or 'return'")
    connection, eigen = _split(options)
    how = _how(n, s, normalise, align, modes, repairs, weld_tolerance, triangulation, min_angle)
    out: List[Union[FieldRun, Exception]] = []
    for run in _alcap.run_batch(list(meshes), how, connection, eigen, jobs, progress):
        if callable(run):
            try:
                run()
            except Exception as error:
                if errors == 'raise':
                    raise
                out.append(error)
        else:
            out.append(FieldRun(run))
    return out


__all__ = [
    'Alignment', 'FieldRun', 'RunFeatures', 'run_batch', 'run_field', 'smoothest_field',
]
