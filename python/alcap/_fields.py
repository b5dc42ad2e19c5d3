# SPDX-License-Identifier: MIT
"""Fields: where they vanish, at faces and vertices, along curvature."""
from __future__ import annotations

from typing import Any, List, Optional, Tuple

import numpy.typing as npt

from . import _alcap
from ._alcap import ConnectedSurface, Field, Surface
from ._types import Floats, Ints


def find_singularities(surface: ConnectedSurface, field: Field) -> Any:
    """Structured array of the faces of non-zero index: face, barycentric, index, orientation, located."""
    return _alcap.find_singularities(surface, field)


def singularity_positions(surface: Surface, singularities: Any) -> Floats:
    """(k, 3) float64: where singularities lie in space."""
    return _alcap.singularity_positions(surface, singularities)


def face_indices(surface: ConnectedSurface, field: Field) -> Ints:
    """(#F,) int32: the index of every face, in n-ths."""
    return _alcap.face_indices(surface, field)


def vertex_indices(surface: Surface, face_field: Field) -> Ints:
    """(#V,) int32: the index of every vertex of a field given per face, in n-ths."""
    return _alcap.vertex_indices(surface, face_field)


def index_sums(surface: ConnectedSurface, field: Field) -> List[Tuple[int, int]]:
    """Per component: what the indices sum to, and what Poincare-Hopf demands, in n-ths."""
    return _alcap.index_sums(surface, field, _alcap.face_indices(surface, field))


def at_faces(surface: ConnectedSurface, field: Field) -> Field:
    """The field at the barycenters of the faces, in face frames."""
    return _alcap.at_faces(surface, field)


def at_vertices(surface: ConnectedSurface, face_field: Field) -> Field:
    """A field given per face as one at the vertices: means over the faces around each."""
    return _alcap.at_vertices(surface, face_field)


def curvature_field(surface: ConnectedSurface, n: int = 4, *, smallest: bool = False, by_magnitude: bool = False,
                    rings: int = 1) -> Field:
    """Directions of principal curvature; |u| is half the difference of the curvatures.

    Parameters
    ----------
    n : int
        Even: principal directions are lines; 4 asks for both.
    smallest : bool
        n = 2, 6, ...: along the direction of least curvature.
    by_magnitude : bool
        Largest and least by magnitude instead of by sign: the same whichever side is outside.
    rings : int
        Means over so many rings of neighbours; 0 is raw.

    Returns
    -------
    Field
    """
    return _alcap.curvature_field(surface, n, smallest, by_magnitude, rings)


def root_mean_square(surface: Surface, u: npt.ArrayLike) -> float:
    """Root mean square of |u| (#V,) over the surface."""
    return _alcap.root_mean_square(surface, u)


def singularities_of(surface: ConnectedSurface, field: Field, known: Optional[Any]) -> Any:
    """Those that are known, or found now. For the functions of this package."""
    return find_singularities(surface, field) if known is None else known


__all__ = [
    'at_faces', 'at_vertices', 'curvature_field', 'face_indices', 'find_singularities', 'index_sums',
    'root_mean_square', 'singularity_positions', 'vertex_indices',
]
