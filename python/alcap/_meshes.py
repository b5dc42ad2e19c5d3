# SPDX-License-Identifier: MIT
"""Meshes from and to files, what is wrong with them, repairs, paths of edges."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence

import numpy as np
import numpy.typing as npt

from . import _alcap
from ._alcap import Surface
from ._errors import in_python
from ._types import Floats, Ints, Path, Progress


@dataclass(frozen=True)
class MeshFile:
    """What a mesh file held.

    Attributes
    ----------
    V : (#V, 3) array of float64
    F : (#F, 3) array of int32
    format : str
        'obj', 'off', 'ply' or 'stl'.
    polygon_of : (#F,) array of int32
        The file's polygon of each face; empty when all were triangles.
    ignored : dict
        Lines or elements that carry no surface: kind to count.
    bytes : int
        Size of the file.
    """

    V: Floats
    F: Ints
    format: str
    polygon_of: Ints
    ignored: Dict[str, int]
    bytes: int


def read_mesh(path: Path, *, polygons: str = 'triangulate', format: str = '', progress: Progress = None) -> MeshFile:
    """Reads OBJ, OFF, PLY or STL.

    Parameters
    ----------
    path : path
    polygons : str
        What becomes of faces with more than three corners: 'triangulate' or 'refuse'.
    format : str
        One of mesh_formats(); empty: by content, then by extension.

    Returns
    -------
    MeshFile

    Raises
    ------
    FileError
        Missing, cut, malformed; names the line.
    """
    return MeshFile(*_alcap.read_mesh(os.fspath(path), polygons, format, progress))


def read_mesh_from_memory(data: bytes, format: str = '', *, polygons: str = 'triangulate') -> MeshFile:
    """read_mesh() of bytes."""
    return MeshFile(*_alcap.read_mesh_from_memory(data, polygons, format))


def read_edge_lengths(path: Path, F: npt.ArrayLike, n_vertices: Optional[int] = None) -> Floats:
    """(#E,) float64: lengths of a text file, three numbers a face, for Surface.from_lengths(). Raises FileError."""
    count = int(np.max(F)) + 1 if n_vertices is None else n_vertices
    return _alcap.read_edge_lengths(os.fspath(path), F, count)


def write_mesh(path: Path, V: npt.ArrayLike, F: npt.ArrayLike) -> None:
    """Writes .off, .obj or .ply. The file appears complete or not at all. Raises FileError, MeshError."""
    _alcap.write_mesh(os.fspath(path), V, F)


def find_defects(V: npt.ArrayLike, F: npt.ArrayLike) -> List[Dict[str, Any]]:
    """All that is wrong with a mesh: defect, element, count, first, message; what to repair first in front."""
    return _alcap.find_defects(V, F)


def repair_weld(V: npt.ArrayLike, F: npt.ArrayLike) -> Ints:
    """(#F, 3) int32: faces that use the first vertex at every position; welds triangle soups."""
    return _alcap.repair_weld(V, F)


def repair_orientation(F: npt.ArrayLike, n_vertices: Optional[int] = None) -> Ints:
    """(#F, 3) int32: faces turned so that neighbours agree; that of the smallest face wins. Raises MeshError."""
    count = int(np.max(F)) + 1 if n_vertices is None else n_vertices
    return _alcap.repair_orientation(F, count)


@dataclass(frozen=True)
class RepairedMesh:
    """A mesh and what was done to it.

    Attributes
    ----------
    V : (#V, 3) array of float64
        The given points, then the copies.
    F : (#F, 3) array of int32
        The faces that are left, in order.
    copies_of : (k,) array of int32
        The given vertex that each appended one is a copy of.
    face_of : array of int32
        The given number of each face; empty where all are kept.
    steps : list of dict
        code, count, first, message.
    """

    V: Floats
    F: Ints
    copies_of: Ints
    face_of: Ints
    steps: List[Dict[str, Any]]


def repair_mesh(V: npt.ArrayLike, F: npt.ArrayLike, repairs: Sequence[str] = (), *, weld_tolerance: float = 0.0,
                bow_ties: bool = True) -> RepairedMesh:
    """Repairs as asked. None moves a vertex or gives one another number.

    Parameters
    ----------
    repairs : sequence of str
        'weld', 'degenerate', 'duplicates', 'split', 'orient', or 'auto': what of these a surface needs.
    weld_tolerance : float
        Of 'weld', in diagonals of the box around all points, in [0, 0.1]; 0: exactly the same position.
    bow_ties : bool
        Vertices where parts only touch are split.

    Returns
    -------
    RepairedMesh
        What cannot be repaired is left, and Surface refuses it by name.
    """
    V, F, copies_of, face_of, steps = _alcap.repair_mesh(V, F, list(repairs), weld_tolerance, bow_ties)
    return RepairedMesh(V, F, copies_of, face_of, [{**s, 'message': in_python(s['message'])} for s in steps])


@dataclass(frozen=True)
class RepairedSurface:
    """A surface of a repaired mesh, and what was done to it.

    Attributes
    ----------
    surface : Surface
    copies_of : (k,) array of int32
        The given vertex that each appended one is a copy of.
    face_of : array of int32
        The given number of each face; empty where all are kept.
    remarks : list of dict
        One per step: code, warning, message, count, first.
    """

    surface: Surface
    copies_of: Ints
    face_of: Ints
    remarks: List[Dict[str, Any]]


def repaired_surface(V: npt.ArrayLike, F: npt.ArrayLike, repairs: Sequence[str] = (), *, weld_tolerance: float = 0.0,
                     bow_ties: bool = True) -> RepairedSurface:
    """repair_mesh(), and a surface of the result.

    Parameters
    ----------
    repairs : sequence of str
        As of repair_mesh(), and 'mollify': edges are taken a little longer, so that every face has an area. Points stay
        where they are.
    weld_tolerance, bow_ties
        As of repair_mesh().

    Returns
    -------
    RepairedSurface

    Raises
    ------
    MeshError
        The mesh cannot be used; names the elements.
    """
    surface, copies_of, face_of, remarks = _alcap.repaired_surface(V, F, list(repairs), weld_tolerance, bow_ties)
    return RepairedSurface(surface, copies_of, face_of, [{**r, 'message': in_python(r['message'])} for r in remarks])


def shortest_path(surface: Surface, start: int, end: int) -> Ints:
    """(k,) int32: the vertices of a shortest path of edges; empty when there is none."""
    return _alcap.shortest_path(surface, start, end)


__all__ = [
    'MeshFile', 'RepairedMesh', 'RepairedSurface', 'find_defects', 'read_edge_lengths', 'read_mesh',
    'read_mesh_from_memory', 'repair_mesh', 'repair_orientation', 'repair_weld', 'repaired_surface', 'shortest_path',
    'write_mesh',
]
