# SPDX-License-Identifier: MIT
"""Whole runs: fields and designs with their certificates, and how they are looked at."""
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
from ._alcap import ConnectedSurface, Field, Frames, Surface
from ._errors import Error, OptionError, in_python
from ._types import Progress

if TYPE_CHECKING:  # pragma: no cover
    from matplotlib.figure import Figure

_CONNECTION = ('connection', 'detail', 'length_factor', 'tan_cap', 'cones', 'balance_cones', 'generator_holonomy',
               'loop_index', 'target', 'spread')
_EIGEN = ('tolerance', 'solver', 'method', 'max_iterations', 'seed', 'prove_smallest')


def _given(**options: Any) -> Dict[str, Any]:
    """The options that are not None."""
    return {name: value for name, value in options.items() if value is not None}


def _split(options: Mapping[str, Any]) -> Tuple[Dict[str, Any], Dict[str, Any]]:
    """Options of the connection, options of the eigensolver."""
    for name in options:
        if name not in _CONNECTION + _EIGEN:
            raise TypeError(f'unexpected option {name!r}; known are {", ".join(_CONNECTION + _EIGEN)}')
    return ({k: v for k, v in options.items() if k in _CONNECTION and v is not None},
            {k: v for k, v in options.items() if k in _EIGEN and v is not None})


class _RunBase:
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
        return self._run.eigen

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
              face_scalars: Optional[Mapping[str, npt.ArrayLike]] = None) -> List[str]:
        """Writes the field, in the formats of the extensions.

        Parameters
        ----------
        *files : path
            Names that end with one of field_formats().
        face_scalars : dict of (#F,) arrays, optional
            Numbers per face that go into .vtp files by name.

        Returns
        -------
        list of str
            The files written. All of them appear, or none.

        Raises
        ------
        FileError
        """
        return _alcap.write_field(self.connection, self.field, self.singularities, [os.fspath(f) for f in files],
                                  dict(face_scalars or {}), None)

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


class FieldRun(_RunBase):
    """A smoothest field with everything that was computed on the way, see smoothest_field()."""


class DesignRun(_RunBase):
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


def smoothest_field(surface: Surface, n: int = 4, *, s: float = 0.0, normalise: bool = False,
                    progress: Progress = None, threads: int = 0, **options: Any) -> FieldRun:
    """The smoothest n-vector field of a surface, with singularities and certificate.

    Parameters
    ----------
    surface : Surface
        A connection is made for it, as `options` say.
    n : int
        1 vectors, 2 lines, 4 crosses, 6 hexagons.
    s : float
        Energy family in [-1, 1] (Knoeppel et al. 2013); 0 is the Dirichlet energy.
    normalise : bool
        Divide by |u| afterwards.
    progress : callable(phase, fraction), optional
        Called on this thread; what it raises ends the call. See progress_bar().
    threads : int
        The most threads; 0: all. Results do not depend on it.
    **options
        Of the connection: connection, detail, length_factor, tan_cap, cones, balance_cones, generator_holonomy,
        loop_index, see connect(). Of the eigensolver: tolerance (1e-8), solver, method, max_iterations (1000), seed,
        prove_smallest.

    Returns
    -------
    FieldRun

    Raises
    ------
    OptionError, SolveError
    KeyboardInterrupt
        Ctrl-C; within a tenth of a second, but for a factorisation that has begun.
    """
    connection, eigen = _split(options)
    if isinstance(surface, ConnectedSurface):
        raise TypeError('smoothest_field makes the connection itself: pass the Surface and connection=..., or use '
                        'eigen_design for the smoothest field of a ConnectedSurface')
    how = {'n': n, 's': s, 'normalise': normalise, 'repairs': []}
    return FieldRun(_alcap.run_field(surface, how, connection, eigen, progress, threads))


def run_field(V: npt.ArrayLike, F: npt.ArrayLike, n: int = 4, *, repairs: Sequence[str] = (), s: float = 0.0,
              normalise: bool = False, progress: Progress = None, threads: int = 0, **options: Any) -> FieldRun:
    """smoothest_field() of arrays, after repairs.

    Parameters
    ----------
    V : (#V, 3) array of float64 or float32
    F : (#F, 3) array of integers
    repairs : sequence of str
        'weld' joins vertices at equal positions, 'orient' turns faces until neighbours agree. Vertices keep their
        numbers.

    Returns
    -------
    FieldRun

    Raises
    ------
    MeshError
        The mesh cannot be used; names the elements.
    """
    connection, eigen = _split(options)
    how = {'n': n, 's': s, 'normalise': normalise, 'repairs': list(repairs)}
    return FieldRun(_alcap.run_field_arrays(V, F, how, connection, eigen, progress, threads))


def run_batch(meshes: Sequence[Any], n: int = 4, *, jobs: int = 0, repairs: Sequence[str] = (), s: float = 0.0,
              normalise: bool = False, progress: Progress = None, errors: str = 'raise',
              **options: Any) -> List[Union[FieldRun, Exception]]:
    """The smoothest fields of many meshes, each on one thread, on all cores.

    Parameters
    ----------
    meshes : sequence of Surface or (V, F)
    jobs : int
        Meshes at a time; 0: one per core.
    errors : str
        'raise' raises the first error when all meshes are done; 'return' puts it in the place of the run.

    Returns
    -------
    list of FieldRun
        In the order of the meshes, the same to the last bit as one after the other.
    """
    if errors not in ('raise', 'return'):
        raise OptionError(f"option 'errors' = {errors}: must be 'raise' or 'return'", 'errors', errors,
                          "must be 'raise' or 'return'")
    connection, eigen = _split(options)
    how = {'n': n, 's': s, 'normalise': normalise, 'repairs': list(repairs)}
    out: List[Union[FieldRun, Exception]] = []
    for run in _alcap.run_batch(list(meshes), how, connection, eigen, jobs, progress):
        if callable(run):
            try:
                run()
            except Exception as error:
                if errors == 'raise':
                    raise
                out.append(error)
        else:
            out.append(FieldRun(run))
    return out


def _design_text(design: Any) -> Tuple[str, str]:
    """JSON of a design and the folder that its files are relative to."""
    if isinstance(design, Mapping):
        return json.dumps({'alcap_design': 1, **design}), ''
    path = os.fspath(design)
    with open(path, encoding='utf-8') as file:
        return file.read(), os.path.dirname(os.path.abspath(path))


def design_field(surface: Surface, design: Union[Mapping[str, Any], str, 'os.PathLike[str]'], *, solver: str = 'auto',
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

    def solve(self, design: Union[Mapping[str, Any], str, 'os.PathLike[str]']) -> DesignRun:
        """As design_field(); after an exception the session can be used again."""
        return DesignRun(self._session.solve(*_design_text(design)))


def read_design(path: Union[str, 'os.PathLike[str]']) -> Dict[str, Any]:
    """A design from its JSON file, checked. Raises FileError naming the line or the JSON path."""
    return json.loads(_alcap.read_design(os.fspath(path)))


def write_design(path: Union[str, 'os.PathLike[str]'], design: Mapping[str, Any]) -> None:
    """Writes a design so that reading it gives the same design."""
    _alcap.write_design(os.fspath(path), _design_text(design)[0])
