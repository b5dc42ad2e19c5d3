# SPDX-License-Identifier: MIT
"""Smooth n-vector fields on triangle meshes: vectors, lines, crosses, as Levi-Civita as possible.

>>> import alcap
>>> surface = alcap.Surface(*alcap.shapes.icosphere(3))
>>> run = alcap.smoothest_field(surface, n=4)
>>> int(run.singularities['index'].sum())
8

The method is that of Liu, Tong, de Goes, Desbrun, ACM Transactions on Graphics 35(3), 2016. See docs/python.md.
"""
from . import (_connections, _curves, _design_run, _designer, _features, _field_run, _fields, _files, _intrinsic,
               _meshes, _operators, _progress, _solvers, _tables, shapes)
from ._alcap import (ConnectedSurface, CurveSet, Field, Frames, IntrinsicTriangulation, Polyline, Registration, Surface,
                     SurfaceLocator, __version__, curve_formats, eigen_solvers, field_formats, linear_solvers, mesh_formats,
                     peak_memory_bytes, scalar_formats, usual_field_formats)
from ._connections import *  # noqa: F401,F403
from ._controls import (BoundaryAlignment, Control, ControlTolerances, EigenStroke, FeatureAlignment,
                        SingularityTarget, Stroke, VertexConstraint)
from ._curves import *  # noqa: F401,F403
from ._design_run import *  # noqa: F401,F403
from ._designer import *  # noqa: F401,F403
from ._errors import Cancelled, Error, FileError, MeshError, OptionError, SolveError
from ._features import *  # noqa: F401,F403
from ._field_run import *  # noqa: F401,F403
from ._fields import *  # noqa: F401,F403
from ._files import *  # noqa: F401,F403
from ._intrinsic import *  # noqa: F401,F403
from ._meshes import *  # noqa: F401,F403
from ._operators import *  # noqa: F401,F403
from ._progress import *  # noqa: F401,F403
from ._solvers import *  # noqa: F401,F403
from ._tables import *  # noqa: F401,F403

__all__ = [
    'BoundaryAlignment', 'Cancelled', 'ConnectedSurface', 'Control', 'ControlTolerances', 'CurveSet', 'EigenStroke',
    'Error', 'FeatureAlignment', 'Field', 'FileError', 'Frames', 'IntrinsicTriangulation', 'MeshError', 'OptionError', 'Polyline', 'Registration', 'SingularityTarget',
    'SolveError', 'Stroke', 'Surface', 'SurfaceLocator', 'VertexConstraint', '__version__', 'curve_formats', 'eigen_solvers', 'field_formats',
    'linear_solvers', 'mesh_formats', 'peak_memory_bytes', 'scalar_formats', 'shapes', 'usual_field_formats',
]
for _part in (_connections, _curves, _design_run, _designer, _features, _field_run, _fields, _files, _intrinsic,
              _meshes, _operators, _progress, _solvers, _tables):
    __all__ += _part.__all__
