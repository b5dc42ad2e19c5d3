# SPDX-License-Identifier: MIT
"""Sharp edges as a graph of lines, fields that run along them, and how long edges should be near them."""
from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy.typing as npt

from . import _alcap
from ._alcap import ConnectedSurface, Field, Surface
from ._controls import VertexConstraint
from ._types import Floats, Ints, Path, Progress


@dataclass(frozen=True)
class FeatureLine:
    """A chain of feature edges.

    Attributes
    ----------
    vertices : (k + 1,) array of int32
    edges : (k,) array of int32
    closed : bool
    """

    vertices: Ints
    edges: Ints
    closed: bool


@dataclass(frozen=True)
class FeatureGraph:
    """Feature edges, the vertices they meet at, and the lines they form.

    Attributes
    ----------
    edges : (k,) array of int32
    angles : (k,) array of float64
        Dihedral angles, radians, positive where the surface is convex.
    vertices : list of str
        Of every vertex: 'smooth', 'end', 'crease' or 'corner'.
    lines : list of FeatureLine
    """

    edges: Ints
    angles: Floats
    vertices: List[str]
    lines: List[FeatureLine]


def graph_of(d: Dict[str, Any]) -> FeatureGraph:
    """Of the compiled part's dict. For the functions of this package."""
    return FeatureGraph(d['edges'], d['angles'], d['vertices'], [FeatureLine(*line) for line in d['lines']])


def sharp_edges(surface: Surface, *, angle: float = math.radians(40), corner_angle: float = math.radians(40),
                boundary: bool = True, creases: bool = True, low_angle: float = 0.0, gap: float = 0.0,
                spur: float = 0.0) -> FeatureGraph:
    """The graph of edges at which the surface folds by at least `angle`, and of the boundary.

    Parameters
    ----------
    angle : float
        Radians, in (0, pi]: edges whose faces turn by at least this are sharp.
    corner_angle : float
        Radians, in (0, pi]: lines that turn by at least this break there.
    boundary : bool
        Boundary edges are features too.
    creases : bool
        False: the boundary alone.
    low_angle : float
        Radians, at most `angle`: edges that fold by this are sharp as well where they are joined to sharper ones; 0:
        off.
    gap : float
        In the unit of length of V: ends this close are joined; 0: off.
    spur : float
        In the unit of length of V: lines with an end that are shorter are removed; 0: off.

    Returns
    -------
    FeatureGraph
    """
    return graph_of(_alcap.sharp_edges(surface, {'angle': angle, 'corner_angle': corner_angle, 'boundary': boundary,
                                               'creases': creases, 'low_angle': low_angle, 'gap': gap, 'spur': spur}))


def edges_between(surface: Surface, pairs: npt.ArrayLike) -> Ints:
    """(k,) int32: the edges between pairs of vertices (k, 2), as read_sharp() gives them. Raises OptionError."""
    return _alcap.edges_between(surface, pairs)


def read_sharp(path: Path, F: npt.ArrayLike) -> Ints:
    """(k, 2) int32: the feature edges of a .sharp file on faces F, by their vertices, for edges_between().

    Raises
    ------
    FileError
        Missing, not such a file, no such face.
    """
    return _alcap.read_sharp(os.fspath(path), F)


def read_feature_edges(path: Path, F: npt.ArrayLike, vertices: int) -> Ints:
    """(k, 2) int32: the feature edges that a file names, by their vertices.

    Those of a .sharp file, or the lines of an OBJ or elements 'edge' of a PLY with as many vertices as the mesh.

    Raises
    ------
    FileError
        Missing, not such a file, no such face, without edges.
    """
    return _alcap.read_feature_edges(os.fspath(path), F, vertices)


def write_sharp(path: Path, surface: Surface, features: FeatureGraph) -> None:
    """Writes feature edges as QuadWild reads them: TYPE,FACE,EDGE, type 0 concave, 1 convex. Raises FileError."""
    _alcap.write_sharp(surface, features, os.fspath(path))


def target_edge_lengths(surface: Surface, features: Optional[FeatureGraph] = None, *, error: float = 0.001,
                        smallest: float = 0.001, largest: float = 0.1, growth: float = 0.3,
                        rings: int = 1) -> Floats:
    """How long the edges of a remesh should be at each vertex, by curvature and features.

    Parameters
    ----------
    features : FeatureGraph, optional
        None: sharp_edges(surface).
    error : float
        In diagonals of the box around the mesh: how far the middle of an edge may be from the surface.
    smallest, largest : float
        In diagonals: no shorter, no longer.
    growth : float
        Two lengths differ by at most this times their distance along edges; 0: one length everywhere.
    rings : int
        Curvature is the mean over so many rings of neighbours.

    Returns
    -------
    (#V,) array of float64
        In the unit of V. write_scalars() writes it.
    """
    graph = sharp_edges(surface) if features is None else features
    return _alcap.target_edge_lengths(surface, graph, {'error': error, 'smallest': smallest, 'largest': largest,
                                                       'growth': growth, 'rings': rings})


def feature_graph(surface: Surface, edges: npt.ArrayLike, *, corner_angle: float = math.radians(40),
                  gap: float = 0.0, spur: float = 0.0) -> FeatureGraph:
    """The graph of any edges (k,), with gaps closed and spurs removed as by sharp_edges()."""
    return graph_of(_alcap.feature_graph(surface, edges, corner_angle, gap, spur))


def feature_directions(surface: ConnectedSurface, features: FeatureGraph, n: int,
                       across: bool = False) -> Tuple[List[VertexConstraint], Ints]:
    """The direction of an n-field of even n at every vertex of features.

    Returns
    -------
    held : list of VertexConstraint
        With direction_only.
    free_corners : (k,) array of int32
        Feature vertices where no direction of an n-field is within 5 degrees of all features that meet.
    """
    vertices, values, corners = _alcap.feature_directions(surface, features, n, across)
    return [VertexConstraint(int(v), complex(u), True) for v, u in zip(vertices, values)], corners


def dihedral_angles(surface: Surface) -> Floats:
    """(#E,) float64: angle between the normals of the faces of every edge, radians, positive where convex."""
    return _alcap.dihedral_angles(surface)


@dataclass(frozen=True)
class AlignedField:
    """What aligned_field() returns.

    Attributes
    ----------
    field : Field
        |u| is 1 along held features.
    pieces : list of dict
        Per component: held, rows, lambda, steps (tau, energy, largest and rms change in degrees), settled, residual,
        solver, eigen (a piece without features gets its smoothest field: as smallest_eigenpair() reports; else None).
    free_corners : (k,) array of int32
        Feature vertices that no n-field can be held at.
    fixed_degrees : float
        Largest angle between a fixed vertex's direction and the field.
    """

    field: Field
    pieces: List[Dict[str, Any]]
    free_corners: Ints
    fixed_degrees: float


def aligned_field(surface: ConnectedSurface, features: FeatureGraph, n: int = 4, *, across: bool = False,
                  weight: float = 0.0, fixed: Sequence[VertexConstraint] = (), linear: bool = False,
                  max_steps: int = 1000, settled_degrees: float = 1.0, finest: float = 6.0, solver: str = 'auto',
                  progress: Progress = None, threads: int = 0) -> AlignedField:
    """The n-direction field that runs along features; everything else is free.

    Parameters
    ----------
    features : FeatureGraph
        From sharp_edges() or feature_graph().
    n : int
        Even where there are features.
    across : bool
        Across the features instead of along.
    weight : float
        0: directions are held at features; above 0: features draw softly.
    fixed : sequence of VertexConstraint
        Vertices whose direction is held; they win over features.
    linear : bool
        The harmonic field alone, without steps of renormalising and diffusing.
    max_steps : int
        The most steps.
    settled_degrees : float
        Steps end when over a time of 1 / lambda directions would change by no more, in degrees.
    finest : float
        The last step diffuses for this many squared edge lengths.

    Returns
    -------
    AlignedField
    """
    options = {'n': n, 'across': across, 'weight': weight, 'fixed': list(fixed), 'linear': linear,
               'max_steps': max_steps, 'settled_degrees': settled_degrees, 'finest': finest, 'solver': solver}
    return AlignedField(*_alcap.aligned_field(surface, features, options, progress, threads))


def measure_features(surface: ConnectedSurface, field: Field, features: FeatureGraph, *,
                     across: bool = False) -> Dict[str, Any]:
    """How well a field of even n follows features: dict of lines, all (angles in degrees), singularities_at_corners."""
    return _alcap.measure_features(surface, field, features, across)


__all__ = [
    'AlignedField', 'FeatureGraph', 'FeatureLine', 'aligned_field', 'dihedral_angles', 'feature_directions',
    'feature_graph', 'edges_between', 'measure_features', 'read_feature_edges', 'read_sharp', 'sharp_edges', 'target_edge_lengths', 'write_sharp',
]
