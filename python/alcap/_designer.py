# SPDX-License-Identifier: MIT
"""Designs that are edited live, and smoothest ones."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

import numpy.typing as npt

from . import _alcap
from ._alcap import ConnectedSurface, Field
from ._controls import (Control, ControlTolerances, EigenStroke, FeatureAlignment, SingularityTarget, Stroke,
                        VertexConstraint)
from ._types import EIGEN_OPTIONS, Progress, given


@dataclass(frozen=True)
class DesignResult:
    """What Designer.solve() returns.

    Attributes
    ----------
    field : Field
    controls : list of dict
        In the order of their ids: id, met, index, error_degrees.
    report : dict
        rows, solves, residual (recomputed), solver, seconds.
    """

    field: Field
    controls: List[Dict[str, Any]]
    report: Dict[str, Any]


class Designer:
    """A design that is prepared once and edited cheaply (LTGD 2016, Sec. 7.1).

    Parameters
    ----------
    surface : ConnectedSurface
    n : int
    guidance_weight : float
        In units of twice the smallest eigenvalue of a round sphere of the same area; 0: no guidance.
    t : float, optional
        The guidance in the form of Knoeppel et al. 2013, instead of the weight.
    s : float
        Energy family in [-1, 1].
    kind : str
        How targets are integrated: 'triangle' or 'edge'.
    solver : str
        One of linear_solvers(), or 'auto'.
    tolerances : ControlTolerances
        How far off controls may be and still count as met.
    progress : callable(phase, fraction), optional
        Of every call.

    Raises
    ------
    OptionError
        Bad options; a system that is singular because nothing holds it.
    """

    def __init__(self, surface: ConnectedSurface, n: int = 1, *, guidance_weight: float = 0.0,
                 t: Optional[float] = None, s: float = 0.0, kind: str = 'triangle', solver: str = 'auto',
                 tolerances: ControlTolerances = ControlTolerances(), progress: Progress = None, threads: int = 0) -> None:
        options = {'n': n, 'guidance_weight': guidance_weight, 't': t, 's': s, 'kind': kind, 'solver': solver,
                   'tolerances': tolerances}
        self._designer = _alcap.Designer(surface, options, progress, threads)
        self._controls: Dict[int, Control] = {}

    @property
    def controls(self) -> Mapping[int, Control]:
        """The controls by id."""
        return dict(self._controls)

    def add(self, control: Control) -> int:
        """Adds a control and returns its id. Raises OptionError naming what is wrong with it."""
        number = self._designer.add(control)
        self._controls[number] = control
        return number

    def set(self, id: int, control: Control) -> None:
        """Replaces a control."""
        self._designer.set(id, control)
        self._controls[id] = control

    def remove(self, id: int) -> None:
        """Removes a control."""
        self._designer.remove(id)
        del self._controls[id]

    def _refresh(self) -> None:
        now: Dict[int, Control] = {number: c for number, c in self._controls.items()
                                   if not isinstance(c, SingularityTarget)}
        now.update({number: SingularityTarget(**members) for number, members in self._designer.controls()})
        self._controls = dict(sorted(now.items()))

    def move(self, id: int, face: int) -> None:
        """Moves a singularity to another face; its direction is carried along."""
        self._designer.move(id, face)
        self._refresh()

    def merge(self, id: int, other: int) -> Optional[int]:
        """Two singularities become one, whose indices add; None where they cancel."""
        left = self._designer.merge(id, other)
        self._refresh()
        return left

    def split(self, id: int, face: int, count: int = 1) -> int:
        """`count` n-ths of a singularity go to another face, as a new control, whose id is returned."""
        made = self._designer.split(id, face, count)
        self._refresh()
        return made

    def set_guidance(self, u0: npt.ArrayLike) -> None:
        """The field u0 (#V,) complex to stay close to; needs a guidance weight or t."""
        self._designer.set_guidance(u0)

    def set_guidance_weight(self, weight: float) -> None:
        """Another weight; a numeric factorisation."""
        self._designer.set_guidance_weight(weight)

    def set_guidance_weights(self, weights: npt.ArrayLike) -> None:
        """Weights per vertex (#V,), not negative, that multiply the guidance weight."""
        self._designer.set_guidance_weights(weights)

    def solve(self) -> DesignResult:
        """Solves the design. Raises OptionError when nothing is asked for."""
        return DesignResult(*self._designer.solve())


@dataclass(frozen=True)
class EigenDesign:
    """What eigen_design() returns.

    Attributes
    ----------
    field : Field
        Of square integral 1 on every component.
    components : list of dict
        As FieldRun.eigen.
    strokes : list of dict
        mean_degrees, largest_degrees, magnitude, met.
    singularities : list of dict
        id (position in the list), met, index, error_degrees.
    fixed : list of dict
        The same for fixed directions.
    features : list of dict
        The same for features; the mean deviation off their corners.
    assembly_seconds, eigen_seconds : float
        Wall clock.
    """

    field: Field
    components: List[Dict[str, Any]]
    strokes: List[Dict[str, Any]]
    singularities: List[Dict[str, Any]]
    fixed: List[Dict[str, Any]]
    features: List[Dict[str, Any]]
    assembly_seconds: float
    eigen_seconds: float


def eigen_design(surface: ConnectedSurface, n: int = 1, *, strokes: Sequence[Union[Stroke, EigenStroke]] = (),
                 singularities: Sequence[SingularityTarget] = (), fixed: Sequence[VertexConstraint] = (),
                 features: Sequence[FeatureAlignment] = (), guidance: Optional[npt.ArrayLike] = None, guidance_weight: float = 0.0,
                 guidance_weights: Optional[npt.ArrayLike] = None, s: float = 0.0, offset: float = 1.0, path: str = 'auto',
                 tolerances: ControlTolerances = ControlTolerances(), progress: Progress = None, threads: int = 0,
                 **options: Any) -> EigenDesign:
    """The smoothest field of a connection that follows strokes and has singularities (LTGD 2016, Sec. 7.2).

    Without controls it is the smoothest field of the connection.

    Parameters
    ----------
    strokes : sequence of EigenStroke or Stroke
    singularities : sequence of SingularityTarget
        Pins are exact.
    fixed : sequence of VertexConstraint
        Directions at vertices; lengths are the field's own.
    features : sequence of FeatureAlignment
        A stroke along every line; directions that are held are exact.
    guidance : (#V,) complex, optional
        A field of any length to stay close to. Without one a weight draws the field towards zero.
    guidance_weight : float
        In units of twice the smallest eigenvalue of a round sphere of the same area; 0: no guidance. 1 weighs closeness
        like smoothness.
    guidance_weights : (#V,), optional
        Not negative, at vertices; they multiply the weight.
    offset : float
        Removes what the paper leaves free across strokes; 0: as in the paper.
    path : str
        'auto', 'real_view' or 'low_rank'.
    tolerances : ControlTolerances
        How far off controls may be and still count as met.
    **options
        Of the eigensolver: tolerance, angle_tolerance, solver, method, max_iterations, seed, prove_smallest.

    Returns
    -------
    EigenDesign
    """
    for name in options:
        if name not in EIGEN_OPTIONS:
            raise TypeError(f'unexpected option {name!r}; known are {", ".join(EIGEN_OPTIONS)}')
    how = {'n': n, 's': s, 'offset': offset, 'path': path, 'tolerances': tolerances}
    controls: Dict[str, Any] = {'strokes': list(strokes), 'singularities': list(singularities), 'fixed': list(fixed),
                                'features': list(features),
                                'guidance': guidance, 'guidance_weight': guidance_weight, 'guidance_weights': guidance_weights}
    return EigenDesign(*_alcap.eigen_design(surface, controls, how, given(**options), progress, threads))


__all__ = [
    'DesignResult', 'Designer', 'EigenDesign', 'eigen_design',
]
