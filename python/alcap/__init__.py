# SPDX-License-Identifier: MIT
"""Smooth n-vector fields on triangle meshes: vectors, lines, crosses, as Levi-Civita as possible.

>>> import alcap
>>> surface = alcap.Surface(*alcap.shapes.icosphere(3))
>>> run = alcap.smoothest_field(surface, n=4)
>>> int(run.singularities['index'].sum())
8

The method is that of Liu, Tong, de Goes, Desbrun, ACM Transactions on Graphics 35(3), 2016. See docs/python.md.
"""
from . import _api, shapes
from ._alcap import (ConnectedSurface, CurveSet, Field, Frames, Polyline, Registration, Surface, SurfaceLocator,
                     __version__, curve_formats, eigen_solvers, field_formats, linear_solvers, mesh_formats,
                     peak_memory_bytes)
from ._api import *  # noqa: F401,F403
from ._controls import BoundaryAlignment, Control, SingularityTarget, Stroke, VertexConstraint
from ._errors import Cancelled, Error, FileError, MeshError, OptionError, SolveError
from ._run import (DesignRun, DesignSession, FieldRun, design_field, read_design, run_batch, run_field, smoothest_field,
                   write_design)

__all__ = [
    'BoundaryAlignment', 'Cancelled', 'ConnectedSurface', 'Control', 'CurveSet', 'DesignRun', 'DesignSession', 'Error',
    'Field', 'FieldRun', 'FileError', 'Frames', 'MeshError', 'OptionError', 'Polyline', 'Registration',
    'SingularityTarget', 'SolveError', 'Stroke', 'Surface', 'SurfaceLocator', 'VertexConstraint', '__version__',
    'curve_formats', 'design_field', 'eigen_solvers', 'field_formats', 'linear_solvers', 'mesh_formats',
    'peak_memory_bytes', 'read_design', 'run_batch', 'run_field', 'shapes', 'smoothest_field', 'write_design',
]
__all__ += _api.__all__
