# SPDX-License-Identifier: MIT
"""Designs as JSON, with what became of every control."""
from __future__ import annotations

import json
import os
from typing import Any, Dict, List, Mapping, Tuple, Union

from . import _alcap
from ._alcap import Surface
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
        """What was asked and what came of it: path, name, type, asked, achieved, error_degrees, met."""
        return self.report['controls']

    @property
    def controls_met(self) -> bool:
        """Whether every control was met."""
        return all(control['met'] for control in self.controls)


def _design_text(design: Any) -> Tuple[str, str]:
    """JSON of a design and the folder that its files are relative to."""
    if isinstance(design, Mapping):
        return json.dumps({'alcap_design': 1, **design}), ''
    path = os.fspath(design)
    with open(path, encoding='utf-8') as file:
        return file.read(), os.path.dirname(os.path.abspath(path))


def design_field(surface: Surface, design: Union[Mapping[str, Any], Path], *, solver: str = 'auto',
                 residual: float = 1e-8, normalise: bool = False, progress: Progress = None,
                 threads: int = 0) -> DesignRun:
    """The field that has what a design asks for.

    Parameters
    ----------
    surface : Surface
    design : dict or path
        As docs/design.md describes; a path of its JSON file.
    residual : float
        Relative residual that the certificate accepts.

    Returns
    -------
    DesignRun

    Raises
    ------
    OptionError
        Its `field` is the JSON path of what is wrong.
    """
    text, folder = _design_text(design)
    return DesignRun(_alcap.run_design(surface, text, folder, solver, residual, normalise, progress, threads))


class DesignSession:
    """Designs on one surface, one after the other; what an edit leaves as it was is kept.

    Parameters
    ----------
    surface : Surface
    solver, residual, normalise, progress, threads
        As of design_field(), for every solve.
    """

    def __init__(self, surface: Surface, *, solver: str = 'auto', residual: float = 1e-8, normalise: bool = False,
                 progress: Progress = None, threads: int = 0) -> None:
        self._session = _alcap.DesignSession(surface, solver, residual, normalise, progress, threads)

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
