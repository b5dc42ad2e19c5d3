# SPDX-License-Identifier: MIT
"""Fields and numbers of vertices to files, fields back, and files for other programs."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, List, Mapping, Optional

import numpy.typing as npt

from . import _alcap
from ._alcap import ConnectedSurface, Field
from ._features import FeatureGraph
from ._fields import singularities_of
from ._types import Floats, Ints, Path, Progress


def write_field(surface: ConnectedSurface, field: Field, *files: Path, singularities: Optional[Any] = None,
                face_scalars: Optional[Mapping[str, npt.ArrayLike]] = None, unit: bool = False,
                progress: Progress = None) -> List[str]:
    """Writes a field in the formats of the extensions and returns the files; see FieldRun.write().

    Parameters
    ----------
    *files : path
        Names that end with one of field_formats().
    singularities : structured array, optional
        None: find_singularities().
    face_scalars : dict of (#F,) arrays, optional
        Numbers per face that go into .vtp files by name.
    unit : bool
        Of a field of unit directions: what is written per face has length 1 as well.
    """
    return _alcap.write_field(surface, field, singularities_of(surface, field, singularities),
                              [os.fspath(f) for f in files], dict(face_scalars or {}), unit, progress)


@dataclass(frozen=True)
class FieldFile:
    """A field read back: V (#V, 3), F (#F, 3), the field bit for bit, the kind of its connection, and whether the file
    says all of it."""

    V: Floats
    F: Ints
    field: Field
    connection: str
    connection_known: bool


def read_field(path: Path) -> FieldFile:
    """Reads a .ply that write_field wrote. Raises FileError."""
    return FieldFile(*_alcap.read_field(os.fspath(path)))


def write_for(reader: str, surface: ConnectedSurface, field: Field, stem: Path, *,
              features: Optional[FeatureGraph] = None, singularities: Optional[Any] = None) -> List[str]:
    """Everything that another program needs to go on from a field, see docs/recipes/quads.md.

    Parameters
    ----------
    reader : str
        'quadwild' (n = 4: .obj, .rosy, .sharp, .txt) or 'directional' (.off, .rawfield, .sings).
    stem : path
        Of the files, without extension.
    features : FeatureGraph, optional
        Creases that QuadWild keeps.

    Returns
    -------
    list of str
        The files. Directions have length 1.
    """
    return _alcap.write_for(reader, surface, field, singularities_of(surface, field, singularities), features,
                            os.fspath(stem))


def write_scalars(path: Path, values: npt.ArrayLike, name: str = 'h') -> None:
    """Writes one number per vertex as .sol (Medit; the size map of mmg), .csv, .npy or .dmat. Raises FileError."""
    _alcap.write_scalars(os.fspath(path), values, name)


__all__ = [
    'FieldFile', 'read_field', 'write_field', 'write_for', 'write_scalars',
]
