# SPDX-License-Identifier: MIT
"""Operators and energies of fields."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Sequence, Tuple

import scipy.sparse

from . import _alcap
from ._alcap import ConnectedSurface, Field
from ._sparse import csc, csr, parts
from ._types import Path


def energy_matrices(surface: ConnectedSurface, n: int, s: float = 0.0) \
        -> Tuple[scipy.sparse.csc_matrix, scipy.sparse.csc_matrix]:
    """Stiffness S and mass M of the n-fields of a connection.

    Parameters
    ----------
    surface : ConnectedSurface
    n : int
    s : float
        Energy family in [-1, 1]; 0 is the Dirichlet energy.

    Returns
    -------
    S, M : (#V, #V) csc_matrix of complex128
        Hermitian, no copy. 1/2 u* S u is the energy, u* M u the squared length. Rows of vertices that no face uses are
        zero.
    """
    S, M = _alcap.energy_matrices(surface, n, s)
    return csc(S), csc(M)


def curvature_and_boundary(surface: ConnectedSurface, n: int) -> scipy.sparse.csc_matrix:
    """(#V, #V) csc_matrix of complex128: C + B, u* (C + B) u = E_A(u) - E_H(u)."""
    return csc(_alcap.curvature_and_boundary(surface, n))


def first_order_operators(surface: ConnectedSurface, n: int = 1, kind: str = 'edge') \
        -> Tuple[scipy.sparse.csr_matrix, scipy.sparse.csr_matrix]:
    """P and Q of the n-fields of a connection.

    Parameters
    ----------
    kind : str
        'edge' (boundary integrals, sums over patches are exact) or 'triangle' (area integrals of the basis).

    Returns
    -------
    P, Q : (#F, #V) csr_matrix of complex128
        n = 1: P u is the integral of div + i curl over each face, Q u that of the reflected pair.
    """
    P, Q = _alcap.first_order_operators(surface, n, kind)
    return csr(P), csr(Q)


@dataclass(frozen=True)
class FieldEnergies:
    """E_D = (E_A + E_H) / 2, E_A (vanishes with div and curl), E_H (vanishes with the reflected pair)."""

    dirichlet: float
    antiholomorphic: float
    holomorphic: float


def field_energies(surface: ConnectedSurface, field: Field) -> FieldEnergies:
    """The energies of a field: exact integrals of the closed-form basis."""
    return FieldEnergies(*_alcap.field_energies(surface, field.n, field.u))


def field_value(surface: ConnectedSurface, field: Field, face: int,
                barycentric: Sequence[float]) -> Tuple[complex, complex, complex]:
    """u and its derivatives along the axes of the face's frame, at a point of a face."""
    return _alcap.field_value(surface, field.n, field.u, face, barycentric)


def edge_value(surface: ConnectedSurface, field: Field, h: int, s: float) -> Tuple[complex, complex]:
    """u and its derivative along halfedge h, at the fraction s of the way to its tip, in the frame of the halfedge."""
    return _alcap.edge_value(surface, field.n, field.u, h, s)


def write_matrix(path: Path, A: Any, format: str = '') -> None:
    """Writes a Hermitian matrix, both triangles stored, for programs that read matrices.

    Parameters
    ----------
    path : path
    A : (k, k) sparse matrix of complex128
    format : str
        'npz' (scipy.sparse.load_npz), 'mtx' (Matrix Market) or 'petsc' (MatLoad); empty: the extension.

    Raises
    ------
    FileError
    """
    name = os.fspath(path)
    _alcap.write_matrix(name, parts(A, 'A'), format or os.path.splitext(name)[1].lstrip('.'))


__all__ = [
    'FieldEnergies', 'curvature_and_boundary', 'edge_value', 'energy_matrices', 'field_energies', 'field_value',
    'first_order_operators', 'write_matrix',
]
