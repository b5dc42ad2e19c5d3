# SPDX-License-Identifier: MIT
"""Designs as JSON, with what became of every control."""
from __future__ import annotations

import json
import os
from typing import Any, Dict, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _alcap
from ._alcap import Surface
from ._controls import ControlTolerances
from ._field_run import RunFeatures, run_features
from ._run import Run
from ._types import Path, Progress


class DesignRun(Run):
    """A designed field with what became of every control, see design_field()."""

    @property
    def design(self) -> Dict[str, Any]:
        """The design that was solved: placed on this mesh, with the cones that balancing added."""
        return json.loads(self._run.design_json)

    @property
    def controls(self) -> List[Dict[str, Any]]:
        """What was asked and what came of it: path, name, type, asked, achieved, error_degrees,
        tolerance_degrees, met."""
        return self.report['controls']

    @property
    def controls_met(self) -> bool:
        """Whether every control was met."""
        return all(control['met'] for control in self.controls)

    @property
    def triangulation(self) -> Optional[Dict[str, Any]]:
        """The triangles that the field was solved on, where they are not those of the mesh, as of FieldRun; else None.

        Controls are judged on them.
        """
        return self._run.triangulation

    @property
    def features(self) -> Optional[RunFeatures]:
        """What the features of the design are, and how well the field follows them; None where it has none.

        Pieces are told where features are all that is asked for, and held or across.
        """
        return run_features(self._run.features)


_MIN_ANGLE = 15 * np.pi / 180


def _design_text(design: Any) -> Tuple[str, str]:
    """JSON of a design and the folder that its files are relative to."""
    if isinstance(design, Mapping):
        return json.dumps({'alcap_design': 1, **design}), ''
    path = os.fspath(design)
    with open(path, encoding='utf-8') as file:
        return file.read(), os.path.dirname(os.path.abspath(path))


def design_field(surface: Surface, design: Union[Mapping[str, Any], Path], *, solver: str = 'auto',
                 residual: float = 1e-8, tolerances: ControlTolerances = ControlTolerances(), normalise: bool = False,
                 triangulation: str = 'auto', min_angle: float = _MIN_ANGLE, progress: Progress = None,
                 threads: int = 0) -> DesignRun:
    """The field that has what a design asks for.

    Parameters
    ----------
    surface : Surface
    design : dict or path
        As docs/design.md describes; a path of its JSON file.
    residual : float
        Relative residual that the certificate accepts.
    tolerances : ControlTolerances
        How far off controls may be and still count as met.
    triangulation, min_angle
        Which triangles it is solved on, as of smoothest_field(). What the design gives per vertex is harmonic between
        the mesh's own vertices.

    Returns
    -------
    DesignRun

    Raises
    ------
    OptionError
        Its `field` is the JSON path of what is wrong.
    """
    text, folder = _design_text(design)
    how = {'solver': solver, 'residual': residual, 'tolerances': tolerances, 'normalise': normalise,
           'triangulation': triangulation, 'min_angle': min_angle}
    return DesignRun(_alcap.run_design(surface, text, folder, how, progress, threads))


class DesignSession:
    """Designs on one surface, one after the other; what an edit leaves as it was is kept.

    Parameters
    ----------
    surface : Surface
    solver, residual, tolerances, normalise, triangulation, min_angle, progress, threads
        As of design_field(), for every solve.
    """

    def __init__(self, surface: Surface, *, solver: str = 'auto', residual: float = 1e-8,
                 tolerances: ControlTolerances = ControlTolerances(), normalise: bool = False,
                 triangulation: str = 'auto', min_angle: float = _MIN_ANGLE, progress: Progress = None,
                 threads: int = 0) -> None:
        how = {'solver': solver, 'residual': residual, 'tolerances': tolerances, 'normalise': normalise,
               'triangulation': triangulation, 'min_angle': min_angle}
        self._session = _alcap.DesignSession(surface, how, progress, threads)

    def solve(self, design: Union[Mapping[str, Any], Path]) -> DesignRun:
        """As design_field(); after an exception the session can be used again."""
        return DesignRun(self._session.solve(*_design_text(design)))


def read_design(path: Path) -> Dict[str, Any]:
    """A design from its JSON file, checked. Raises FileError naming the line or the JSON path."""
    return json.loads(_alcap.read_design(os.fspath(path)))


def write_design(path: Path, design: Mapping[str, Any]) -> None:
    """Writes a design so that reading it gives the same design."""
    _alcap.write_design(os.fspath(path), _design_text(design)[0])


__all__ = [
    'DesignRun', 'DesignSession', 'design_field', 'read_design', 'write_design',
]
