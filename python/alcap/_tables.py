# SPDX-License-Identifier: MIT
"""The accuracy tables of the paper measured here, and what a run would take."""
from __future__ import annotations

import json
from typing import Any, Dict, Optional, Sequence

import numpy.typing as npt

from . import _alcap
from ._types import Progress


def tables(levels: Sequence[int] = (2, 3, 4, 5), *, fields: int = 100, jitter: float = 0.2, seed: int = 1,
           mesh: Optional[Sequence[npt.ArrayLike]] = None, more: bool = False,
           progress: Progress = None) -> Dict[str, Any]:
    """The accuracy tables of LTGD 2016 measured anew, beside the published numbers, as `alcap tables` does.

    Parameters
    ----------
    levels : sequence of int
        Icospheres of 10 4^l + 2 vertices, coarse to fine. All four take minutes.
    fields : int
        Random fields to average over.
    jitter : float
        Of the irregular spheres, in mean edge lengths.
    seed : int
        Of the random fields and the jitter.
    mesh : (V, F), optional
        Rows of the second table for this closed mesh as well.
    more : bool
        Also noise, random points, an ellipsoid, a generic body, and other methods.

    Returns
    -------
    dict
        operators, stiffness, euler, baselines: lists of rows as of docs/report.md; text: the tables as aligned text.
    """
    V: npt.ArrayLike = [] if mesh is None else mesh[0]
    F: npt.ArrayLike = [] if mesh is None else mesh[1]
    return json.loads(_alcap.tables({'levels': list(levels), 'fields': fields, 'jitter': jitter, 'seed': seed,
                                     'more': more}, V, F, progress))


def plan_field(faces: int, *, vertices: int = 0, n: int = 4, threads: int = 0, formats: Sequence[str] = ('ply',),
               speed: float = 1.0, memory: int = 0) -> Dict[str, Any]:
    """Memory, time and disk of run_field() and write_field() before they run, by the model of docs/scale.md.

    Parameters
    ----------
    faces : int
    vertices : int
        0: those of a closed surface, faces / 2 + 2.
    n : int
    threads : int
        0: all.
    formats : sequence of str
        Of the output: 'ply', 'vtp', 'rosy', 'rawfield'.
    speed : float
        Of a core, see relative_speed().
    memory : int
        Bytes to be had; 0: those that are free now.

    Returns
    -------
    dict
        fits, refusals, halfedges, edges, matrix_entries (of S, both triangles), phases (name, seconds, bytes, disk),
        seconds, bytes, disk, most_bytes (of the hardest case measured), factor_bytes (on top, where it comes to a
        factorisation), factor_fits, memory, largest (faces that fit here).
    """
    return _alcap.plan_field({'faces': faces, 'vertices': vertices, 'n': n, 'threads': threads,
                              'formats': list(formats), 'speed': speed, 'memory': memory})


def relative_speed() -> float:
    """How quick a core is here against that of the model's constants; takes about 0.2 s."""
    return _alcap.relative_speed()


__all__ = ['plan_field', 'relative_speed', 'tables']
