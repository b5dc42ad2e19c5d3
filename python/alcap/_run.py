# SPDX-License-Identifier: MIT
"""What whole runs of fields and of designs have in common: results, report, files, pictures."""
from __future__ import annotations

import html
import json
import os
import tempfile
import webbrowser
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _alcap
from ._alcap import ConnectedSurface, Field, Frames
from ._errors import Error, OptionError, in_python, report_in_python
from ._features import graph_of

if TYPE_CHECKING:  # pragma: no cover
    from matplotlib.figure import Figure


class Run:
    """What runs of fields and of designs have in common."""

    def __init__(self, run: Any) -> None:
        self._run = run
        self._report: Optional[Dict[str, Any]] = None

    @property
    def connection(self) -> ConnectedSurface:
        """The surface with the connection that the field was made with."""
        return self._run.connection

    @property
    def surface(self) -> ConnectedSurface:
        """The same as `connection`."""
        return self.connection

    @property
    def field(self) -> Field:
        """The field."""
        return self._run.field

    @property
    def n(self) -> int:
        """Degree: 1 vectors, 2 lines, 4 crosses."""
        return self.field.n

    @property
    def u(self) -> npt.NDArray[np.complex128]:
        """(#V,) complex128: the n-th power of any branch, in vertex frames."""
        return self.field.u

    @property
    def frames(self) -> Optional[Frames]:
        """Frames of the vertices; None on a surface that lies in no space."""
        return self.field.frames

    def vectors(self, k: int = 0) -> npt.NDArray[np.float64]:
        """Branch k as vectors in space.

        Parameters
        ----------
        k : int
            0 <= k < n.

        Returns
        -------
        (#V, 3) array of float64
            Tangent vectors. Of n-vector fields their length is |u|^(1/n).
        """
        return self.field.vectors(k)

    @property
    def indices(self) -> npt.NDArray[np.int32]:
        """(#F,) int32: the index of every face, in n-ths of a turn."""
        return self._run.indices

    @property
    def index_sums(self) -> List[Tuple[int, int]]:
        """Per component: what the indices sum to, and what Poincare-Hopf demands, in n-ths."""
        return self._run.index_sums

    @property
    def singularities(self) -> npt.NDArray[Any]:
        """Structured array: face, barycentric (3,), index (n-ths), orientation (radians), located."""
        return self._run.singularities

    @property
    def holds(self) -> bool:
        """Whether the certificate holds: everything in `report['certificate']` is true, and no smaller eigenvalue is
        known. What was asked of a design is told by its `controls`."""
        return self._run.holds

    @property
    def eigen(self) -> List[Dict[str, Any]]:
        """Per component what smallest_eigenpair() reports: lambda, next, residual, smallest and more."""
        return [report_in_python(report) for report in self._run.eigen]

    @property
    def remarks(self) -> List[Dict[str, Any]]:
        """What deserves mention: code, warning, message, count, first."""
        return [{**r, 'message': in_python(r['message'])} for r in self._run.remarks]

    @property
    def report(self) -> Dict[str, Any]:
        """The report that the command line writes, see docs/report.md; `input` is None."""
        if self._report is None:
            report = json.loads(self._run.report_json())
            for key, warning in (('warnings', True), ('notes', False)):
                report[key] = [{k: v for k, v in r.items() if k != 'warning'} for r in self.remarks
                               if r['warning'] == warning]
            self._report = report
        return self._report

    def write(self, *files: Union[str, 'os.PathLike[str]'],
              face_scalars: Optional[Mapping[str, npt.ArrayLike]] = None, unit: bool = False) -> List[str]:
        """Writes the field, in the formats of the extensions.

        Parameters
        ----------
        *files : path
            Names that end with one of field_formats().
        face_scalars : dict of (#F,) arrays, optional
            Numbers per face that go into .vtp files by name.
        unit : bool
            Of a run with normalise=True: what is written per face has length 1 as well.

        Returns
        -------
        list of str
            The files written. All of them appear, or none.

        Raises
        ------
        FileError
        """
        return _alcap.write_field(self.connection, self.field, self.singularities, [os.fspath(f) for f in files],
                                  dict(face_scalars or {}), unit, None)

    def write_for(self, reader: str, stem: Union[str, 'os.PathLike[str]']) -> List[str]:
        """Everything that `reader`, 'quadwild' or 'directional', goes on from, as STEM.obj, ...; see write_for()."""
        return _alcap.write_for(reader, self.connection, self.field, self.singularities, self._feature_graph(),
                                os.fspath(stem))

    def _feature_graph(self) -> Any:
        found = self._run.features
        return None if found is None else graph_of(found['graph'])

    def page(self, title: str = 'field') -> str:
        """The page that shows the field in any browser: one HTML text that needs no network.

        Raises
        ------
        Error
            This build has no page (it is made with npm).
        """
        return self._run.page(title).decode()

    def show(self, title: str = 'field') -> str:
        """Opens the page in a browser and returns its file."""
        page = self.page(title)
        with tempfile.NamedTemporaryFile('w', suffix='.html', delete=False, encoding='utf-8') as file:
            file.write(page)
        webbrowser.open('file://' + file.name)
        return file.name

    def _repr_html_(self) -> str:
        """What notebooks show: the page in a frame, or the figures where this build has no page."""
        try:
            page = self.page()
        except Error as error:
            rows = ''.join(f'<tr><td>{html.escape(k)}</td><td>{html.escape(v)}</td></tr>' for k, v in self._figures())
            return f'<table>{rows}</table><p>{html.escape(str(error))}</p>'
        return (f'<iframe srcdoc="{html.escape(page)}" style="width:100%;height:520px;border:0" '
                'title="alcap field"></iframe>')

    def _figures(self) -> List[Tuple[str, str]]:
        counts = self.singularities['index']
        figures = [('field', f'n = {self.n}, {len(self.u)} vertices'),
                   ('singularities', f'{int((counts > 0).sum())} positive, {int((counts < 0).sum())} negative')]
        if self.eigen:
            figures.append(('smallest eigenvalue', f'{self.eigen[0]["lambda"]:.6g}'))
        figures.append(('certificate', 'holds' if self.holds else 'does not hold'))
        return figures

    def __repr__(self) -> str:
        return f'<alcap.{type(self).__name__}: ' + ', '.join(f'{k} {v}' for k, v in self._figures()) + '>'

    def plot(self, ax: Any = None, *, view: Sequence[float] = (1.0, 0.6, 0.4), arrows: int = 4000,
             length: Optional[float] = None) -> 'Figure':
        """A picture of the field with matplotlib; needs no display.

        Parameters
        ----------
        ax : matplotlib axes, optional
            Where to draw; None: a new figure.
        view : (float, float, float)
            Direction from the surface to the eye.
        arrows : int
            The most vertices at which branches are drawn.
        length : float, optional
            Length of the longest branch in the unit of V; None: 0.8 mean edge lengths.

        Returns
        -------
        matplotlib Figure
        """
        from ._plot import draw
        return draw(self, ax, view, arrows, length)

    def to_trimesh(self) -> Any:
        """A trimesh.Trimesh with `u` and the branches as vertex attributes."""
        trimesh = _optional('trimesh')
        mesh = trimesh.Trimesh(self.surface.V, self.surface.F, process=False)
        mesh.vertex_attributes['u'] = self.u
        for k in range(self.n):
            mesh.vertex_attributes[f'branch{k}'] = self.vectors(k)
        return mesh

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData with the branches as point data and the indices as cell data."""
        pyvista = _optional('pyvista')
        faces = np.hstack([np.full((self.surface.n_faces, 1), 3), self.surface.F]).ravel()
        mesh = pyvista.PolyData(np.array(self.surface.V), faces)
        for k in range(self.n):
            mesh.point_data[f'branch{k}'] = self.vectors(k)
        mesh.cell_data['index'] = self.indices
        return mesh

    def to_polyscope(self, name: str = 'alcap') -> Any:
        """Registers the surface with polyscope, with the field as tangent vectors, and returns the structure."""
        polyscope = _optional('polyscope')
        frames = self.frames
        if frames is None:
            raise OptionError('the surface lies in no space', 'surface', 'intrinsic', 'must lie in space')
        polyscope.init()
        mesh = polyscope.register_surface_mesh(name, self.surface.V, self.surface.F)
        root = self.field.u ** (1.0 / self.n)
        Y = np.cross(frames.N, frames.X)
        mesh.add_tangent_vector_quantity('field', np.stack([root.real, root.imag], axis=1), frames.X, Y,
                                         n_sym=self.n, enabled=True)
        positions = _alcap.singularity_positions(self.surface, self.singularities)
        cloud = polyscope.register_point_cloud(name + ' singularities', positions)
        cloud.add_scalar_quantity('index', self.singularities['index'], enabled=True)
        return mesh


def _optional(name: str) -> Any:
    import importlib
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f'this needs {name}: pip install {name}') from error
