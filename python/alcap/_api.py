# SPDX-License-Identifier: MIT
"""The steps of the library, in the order the data flows."""
from __future__ import annotations

import math
import os
import sys
import time
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt
import scipy.sparse

from . import _alcap
from ._alcap import ConnectedSurface, CurveSet, Field, Frames, Polyline, Surface
from ._controls import Control, SingularityTarget, Stroke, VertexConstraint
from ._run import _EIGEN, _given
from ._types import Progress

Path = Union[str, 'os.PathLike[str]']
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
Complexes = npt.NDArray[np.complex128]


def _csc(parts: Tuple[Any, Any, Any, Any]) -> scipy.sparse.csc_matrix:
    data, indices, indptr, shape = parts
    matrix = scipy.sparse.csc_matrix((data, indices, indptr), shape=shape, copy=False)
    matrix.has_sorted_indices = True
    return matrix


def _csr(parts: Tuple[Any, Any, Any, Any]) -> scipy.sparse.csr_matrix:
    data, indices, indptr, shape = parts
    return scipy.sparse.csr_matrix((data, indices, indptr), shape=shape, copy=False)


def _parts(matrix: Any) -> Tuple[Any, Any, Any]:
    matrix = scipy.sparse.csc_matrix(matrix)
    if not matrix.has_sorted_indices:
        matrix = matrix.sorted_indices()
    return matrix.data, matrix.indices, matrix.indptr


def _singularities(surface: ConnectedSurface, field: Field, given: Optional[Any]) -> Any:
    return find_singularities(surface, field) if given is None else given


# ---- meshes

@dataclass(frozen=True)
class MeshFile:
    """What a mesh file held.

    Attributes
    ----------
    V : (#V, 3) array of float64
    F : (#F, 3) array of int32
    format : str
        'obj', 'off', 'ply' or 'stl'.
    polygon_of : (#F,) array of int32
        The file's polygon of each face; empty when all were triangles.
    ignored : dict
        Lines or elements that carry no surface: kind to count.
    bytes : int
        Size of the file.
    """

    V: Floats
    F: Ints
    format: str
    polygon_of: Ints
    ignored: Dict[str, int]
    bytes: int


def read_mesh(path: Path, *, polygons: str = 'triangulate', format: str = '', progress: Progress = None) -> MeshFile:
    """Reads OBJ, OFF, PLY or STL.

    Parameters
    ----------
    path : path
    polygons : str
        What becomes of faces with more than three corners: 'triangulate' or 'refuse'.
    format : str
        One of mesh_formats(); empty: by content, then by extension.

    Returns
    -------
    MeshFile

    Raises
    ------
    FileError
        Missing, cut, malformed; names the line.
    """
    return MeshFile(*_alcap.read_mesh(os.fspath(path), polygons, format, progress))


def read_mesh_from_memory(data: bytes, format: str = '', *, polygons: str = 'triangulate') -> MeshFile:
    """read_mesh() of bytes."""
    return MeshFile(*_alcap.read_mesh_from_memory(data, polygons, format))


def write_mesh(path: Path, V: npt.ArrayLike, F: npt.ArrayLike) -> None:
    """Writes .off, .obj or .ply. The file appears complete or not at all. Raises FileError, MeshError."""
    _alcap.write_mesh(os.fspath(path), V, F)


def find_defects(V: npt.ArrayLike, F: npt.ArrayLike) -> List[Dict[str, Any]]:
    """All that is wrong with a mesh: defect, element, count, first, message; what to repair first in front."""
    return _alcap.find_defects(V, F)


def repair_weld(V: npt.ArrayLike, F: npt.ArrayLike) -> Ints:
    """(#F, 3) int32: faces that use the first vertex at every position; welds triangle soups."""
    return _alcap.repair_weld(V, F)


def repair_orientation(F: npt.ArrayLike, n_vertices: Optional[int] = None) -> Ints:
    """(#F, 3) int32: faces turned so that neighbours agree; that of the smallest face wins. Raises MeshError."""
    count = int(np.max(F)) + 1 if n_vertices is None else n_vertices
    return _alcap.repair_orientation(F, count)


def shortest_path(surface: Surface, start: int, end: int) -> Ints:
    """(k,) int32: the vertices of a shortest path of edges; empty when there is none."""
    return _alcap.shortest_path(surface, start, end)


# ---- sharp edges

@dataclass(frozen=True)
class FeatureLine:
    """A chain of feature edges.

    Attributes
    ----------
    vertices : (k + 1,) array of int32
    edges : (k,) array of int32
    closed : bool
    """

    vertices: Ints
    edges: Ints
    closed: bool


@dataclass(frozen=True)
class FeatureGraph:
    """Feature edges, the vertices they meet at, and the lines they form.

    Attributes
    ----------
    edges : (k,) array of int32
    angles : (k,) array of float64
        Dihedral angles, radians, positive where the surface is convex.
    vertices : list of str
        Of every vertex: 'smooth', 'end', 'crease' or 'corner'.
    lines : list of FeatureLine
    """

    edges: Ints
    angles: Floats
    vertices: List[str]
    lines: List[FeatureLine]


def _graph(d: Dict[str, Any]) -> FeatureGraph:
    return FeatureGraph(d['edges'], d['angles'], d['vertices'], [FeatureLine(*line) for line in d['lines']])


def sharp_edges(surface: Surface, *, angle: float = math.radians(40), corner_angle: float = math.radians(40),
                boundary: bool = True) -> FeatureGraph:
    """The graph of edges at which the surface folds by at least `angle` (radians), and of the boundary."""
    return _graph(_alcap.sharp_edges(surface, angle, corner_angle, boundary))


def feature_graph(surface: Surface, edges: npt.ArrayLike, *, corner_angle: float = math.radians(40)) -> FeatureGraph:
    """The graph of any edges (k,)."""
    return _graph(_alcap.feature_graph(surface, edges, corner_angle))


def dihedral_angles(surface: Surface) -> Floats:
    """(#E,) float64: angle between the normals of the faces of every edge, radians, positive where convex."""
    return _alcap.dihedral_angles(surface)


# ---- connections

def connect(surface: Surface, connection: str = 'global', *, detail: Optional[float] = None,
            length_factor: Optional[str] = None, tan_cap: Optional[float] = None,
            cones: Optional[Sequence[Tuple[int, float]]] = None, balance_cones: Optional[bool] = None,
            generator_holonomy: Optional[Sequence[float]] = None, loop_index: Optional[Sequence[float]] = None,
            target: Optional[Mapping[str, npt.ArrayLike]] = None, spread: Optional[bool] = None, n: int = 1, progress: Progress = None, threads: int = 0) -> ConnectedSurface:
    """A surface with a connection on it.

    Parameters
    ----------
    surface : Surface
    connection : str
        'global' (as Levi-Civita as possible), 'local', 'polar', 'polar-barycenter', 'trivial' with cones that are
        multiples of 1/n, or 'metric': with cones of any size, or nearest to a target.
    detail : float
        Smaller spreads the curvature of a vertex over more faces: fields ignore small bumps. 1 by default.
    length_factor : str
        'mean_edge' (default), 'metric' or 'per_edge'.
    cones : sequence of (vertex, index)
        Of a trivial or metric connection; indices in turns. They must sum to the Euler characteristic.
    balance_cones : bool
        Add cones until they do.
    generator_holonomy, loop_index : sequence of float
        In turns, of surface.homology_generators() and surface.boundary_loops.
    target : dict with one array
        Of a metric connection: rotation (3 #F,), adjustment (3 #F,), vertex_curvature (#V,) or face_curvature (#F,),
        radians.
    spread : bool
        With a target: whether the curvature of vertices may spread over faces; True by default.
    n : int
        Of a trivial connection: cones and holonomies are multiples of 1/n turn.

    Returns
    -------
    ConnectedSurface
        It is a Surface as well.

    Raises
    ------
    OptionError
    """
    options = _given(connection=connection, detail=detail, length_factor=length_factor, tan_cap=tan_cap, cones=cones,
                     balance_cones=balance_cones, generator_holonomy=generator_holonomy, loop_index=loop_index,
                     target=None if target is None else dict(target), spread=spread, n=n)
    return _alcap.connect(surface, options, progress, threads)


def balance_cones(surface: Surface, cones: Sequence[Tuple[int, float]], n: int = 1) -> List[Tuple[int, float]]:
    """The cones (vertex, index in turns) and behind them those that closed components lack, in steps of 1/n."""
    return _alcap.balance_cones(surface, cones, n)


def face_frames(surface: Surface) -> Frames:
    """Frames of the faces: X along the first edge, N the normal."""
    return _alcap.face_frames(surface)


@dataclass(frozen=True)
class Transported:
    """What became of a vector on its way.

    Attributes
    ----------
    z : complex
        The component in the frame at the end.
    turn : float
        How far it has turned against the frames on the way, radians, for n = 1.
    turn_from_path : float
        How far it has turned against the direction of the path, radians, for n = 1.
    """

    z: complex
    turn: float
    turn_from_path: float


def transport(surface: ConnectedSurface, path: Union[Polyline, npt.ArrayLike], z: complex, n: int = 1) -> Transported:
    """Parallel transport of an n-vector along vertices (k,) that edges join, or along a Polyline."""
    if isinstance(path, Polyline):
        return Transported(*_alcap.transport_along_line(surface, path, z, n))
    return Transported(*_alcap.transport_along_vertices(surface, path, z, n))


# ---- operators and energies

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
    return _csc(S), _csc(M)


def curvature_and_boundary(surface: ConnectedSurface, n: int) -> scipy.sparse.csc_matrix:
    """(#V, #V) csc_matrix of complex128: C + B, u* (C + B) u = E_A(u) - E_H(u)."""
    return _csc(_alcap.curvature_and_boundary(surface, n))


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
    return _csr(P), _csr(Q)


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


# ---- solvers

class Factorised:
    """A factorised Hermitian positive definite matrix, see factorise()."""

    def __init__(self, inner: Any) -> None:
        self._inner = inner
        self.report: Dict[str, Any] = {}

    @property
    def name(self) -> str:
        """The backend and its choices."""
        return self._inner.name

    def solve(self, b: npt.ArrayLike) -> Complexes:
        """Solves A x = b.

        Parameters
        ----------
        b : (#V,) or (#V, k) array of complex128
            Read without a copy where columns are contiguous.

        Returns
        -------
        array of the same shape
            `report` says iterations and the recomputed residual.
        """
        array = np.asarray(b)
        x, self.report = self._inner._solve(array.reshape(array.shape[0], -1))
        return x.reshape(array.shape)


def factorise(A: Any, solver: str = 'auto', *, tolerance: float = 1e-10, max_iterations: int = 1000) -> Factorised:
    """Factorises a Hermitian positive definite sparse matrix (copied) with one of linear_solvers()."""
    return Factorised(_alcap.factorise(_parts(A), solver, tolerance, max_iterations))


def smallest_eigenpair(S: Any, M: Any, area: float, *, tolerance: Optional[float] = None, solver: Optional[str] = None,
                       method: Optional[str] = None, max_iterations: Optional[int] = None, seed: Optional[int] = None,
                       prove_smallest: Optional[str] = None, progress: Progress = None,
                       threads: int = 0) -> Tuple[Complexes, Dict[str, Any]]:
    """The smallest eigenpair of S u = lambda M u.

    Parameters
    ----------
    S, M : (#V, #V) sparse matrices of complex128
        Hermitian; S positive semidefinite, M positive definite. Copied.
    area : float
        Of the surface: 1 / area is the scale of eigenvalues.
    tolerance : float
        Relative residual, 1e-8 by default.
    prove_smallest : str
        'auto', 'always' or 'never': whether it is proven that no smaller eigenvalue exists.

    Returns
    -------
    u : (#V,) array of complex128
        Of length 1 in M.
    report : dict
        solver, converged, iterations, lambda, next (None where it is not established), residual and energy_residual
        (recomputed), smallest ('proven', 'searched', 'not checked' or 'refuted'), lower_bound, smallest_note, seconds,
        message.
    """
    options = _given(tolerance=tolerance, solver=solver, method=method, max_iterations=max_iterations, seed=seed,
                     prove_smallest=prove_smallest)
    return _alcap.smallest_eigenpair(_parts(S), _parts(M), area, options, progress, threads)


def eigenpairs(S: Any, M: Any, area: float, count: int, *, tolerance: Optional[float] = None,
               solver: Optional[str] = None, method: Optional[str] = None, max_iterations: Optional[int] = None,
               seed: Optional[int] = None, prove_smallest: Optional[str] = None, progress: Progress = None,
               threads: int = 0) -> Tuple[npt.NDArray[Any], npt.NDArray[Any], Dict[str, Any]]:
    """The `count` smallest eigenpairs of S u = lambda M u; parameters as of smallest_eigenpair().

    Returns
    -------
    eigenvalues : (count,) array of float64
        Ascending.
    U : (#V, count) array of complex128
        U^H M U = 1.
    report : dict
        solver, converged, iterations, residual (count,), cluster (eigenvalues of one cluster share a number), smallest
        ('proven': counted, none is missing), seconds, message.
    """
    options = _given(tolerance=tolerance, solver=solver, method=method, max_iterations=max_iterations, seed=seed,
                     prove_smallest=prove_smallest)
    return _alcap.eigenpairs(_parts(S), _parts(M), area, count, options, progress, threads)


def inertia(S: Any, M: Any, sigma: float, *, progress: Progress = None, threads: int = 0) -> int:
    """How many eigenvalues of S u = lambda M u lie below sigma (Sylvester's law of inertia)."""
    return _alcap.inertia(_parts(S), _parts(M), sigma, progress, threads)


def register_linear_solver(name: str, factory: Callable[[Any], Any]) -> '_alcap.Registration':
    """Makes a callable a linear backend, for `solver=name`.

    Parameters
    ----------
    name : str
    factory : callable
        Given a csc_matrix, Hermitian positive definite, real or complex, returns solve(B) or an object with a method
        `solve`, such as scipy.sparse.linalg.splu's. B and the result are (#V, k).

    Returns
    -------
    Registration
        A context manager; close() takes the name out again. Keep it as long as the name is used.
    """
    def make(*parts: Any) -> Any:
        made = factory(_csc(parts))  # type: ignore[arg-type]
        return getattr(made, 'solve', made)
    return _alcap.register_linear_solver(name, make)


def register_eigen_solver(name: str, solver: Callable[[Any, Any, float, Dict[str, Any]], Any]) -> '_alcap.Registration':
    """Makes a callable an eigensolver, for `method=name`.

    Parameters
    ----------
    name : str
    solver : callable(S, M, area, options)
        Returns the eigenvector (#V,) of the smallest eigenvalue, of any length and phase. options: tolerance,
        max_iterations, seed. Residual and convergence are checked by the library.
    """
    def solve(S: Any, M: Any, area: float, options: Dict[str, Any]) -> Any:
        return solver(_csc(S), _csc(M), area, options)
    return _alcap.register_eigen_solver(name, solve)


# ---- fields

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


def curvature_field(surface: ConnectedSurface, n: int = 4, *, smallest: bool = False, rings: int = 1) -> Field:
    """Directions of principal curvature; |u| is half the difference of the curvatures. n is even."""
    return _alcap.curvature_field(surface, n, smallest, rings)


def root_mean_square(surface: Surface, u: npt.ArrayLike) -> float:
    """Root mean square of |u| (#V,) over the surface."""
    return _alcap.root_mean_square(surface, u)


# ---- strokes and curves

def stroke_through_points(surface: Surface, faces: npt.ArrayLike, barycentric: npt.ArrayLike) -> Polyline:
    """A line through points of the surface: faces (k,), barycentric coordinates (k, 3)."""
    return _alcap.stroke_through_points(surface, faces, barycentric)


def polyline_through(surface: Surface, faces: npt.ArrayLike, barycentric: npt.ArrayLike) -> Polyline:
    """A line through points, each of which lies in a face with the next one; needs no positions."""
    return _alcap.polyline_through(surface, faces, barycentric)


def stroke_along_vertices(surface: Surface, vertices: npt.ArrayLike) -> Polyline:
    """A line along edges; vertices (k,) that no edge joins are joined by a shortest path."""
    return _alcap.stroke_along_vertices(surface, vertices)


def stroke_from_space(surface: Surface, points: npt.ArrayLike) -> Polyline:
    """A line through the points of the surface closest to points (k, 3)."""
    return _alcap.stroke_from_space(surface, points)


def streamlines(surface: ConnectedSurface, field: Field, *, progress: Progress = None, **options: Any) -> CurveSet:
    """Evenly spaced integral curves of all families.

    Parameters
    ----------
    **options
        In diagonals of the box around the mesh: spacing (0.01), min_length (0.02), max_length (5). separation (0.5, a
        fraction of spacing), tolerance (1e-6), singularity_radius (0.01), max_curves, max_points.

    Returns
    -------
    CurveSet
    """
    return _alcap.streamlines(surface, field, options, progress)


def trace_curves(surface: ConnectedSurface, field: Field, faces: npt.ArrayLike, barycentric: npt.ArrayLike,
                 angles: Optional[npt.ArrayLike] = None, *, progress: Progress = None, **options: Any) -> CurveSet:
    """One integral curve per seed: faces (k,), barycentric (k, 3), direction angles (k,) in the face's frame, radians.

    `options` as of streamlines(), and sides: 'both', 'forward' or 'backward'.
    """
    given = np.zeros(np.shape(faces)) if angles is None else angles
    return _alcap.trace_curves(surface, field, faces, barycentric, given, options, progress)


def separatrices(surface: ConnectedSurface, field: Field, singularities: Optional[Any] = None, *,
                 progress: Progress = None, **options: Any) -> CurveSet:
    """The curves that leave singularities straight; `options` as of streamlines()."""
    return _alcap.separatrices(surface, field, _singularities(surface, field, singularities), options, progress)


# ---- design

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
    progress : callable(phase, fraction), optional
        Of every call.

    Raises
    ------
    OptionError
        Bad options; a system that is singular because nothing holds it.
    """

    def __init__(self, surface: ConnectedSurface, n: int = 1, *, guidance_weight: float = 0.0,
                 t: Optional[float] = None, s: float = 0.0, kind: str = 'triangle', solver: str = 'auto',
                 progress: Progress = None, threads: int = 0) -> None:
        options = {'n': n, 'guidance_weight': guidance_weight, 't': t, 's': s, 'kind': kind, 'solver': solver}
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
    """

    field: Field
    components: List[Dict[str, Any]]
    strokes: List[Dict[str, Any]]
    singularities: List[Dict[str, Any]]


def eigen_design(surface: ConnectedSurface, n: int = 1, *, strokes: Sequence[Stroke] = (),
                 singularities: Sequence[SingularityTarget] = (), s: float = 0.0, offset: float = 1.0,
                 path: str = 'auto', progress: Progress = None, threads: int = 0, **options: Any) -> EigenDesign:
    """The smoothest field of a connection that follows strokes and has singularities (LTGD 2016, Sec. 7.2).

    Without controls it is the smoothest field of the connection.

    Parameters
    ----------
    offset : float
        Removes what the paper leaves free across strokes; 0: as in the paper.
    path : str
        'auto', 'real_view' or 'low_rank'.
    **options
        Of the eigensolver: tolerance, solver, method, max_iterations, seed.

    Returns
    -------
    EigenDesign
    """
    for name in options:
        if name not in _EIGEN:
            raise TypeError(f'unexpected option {name!r}; known are {", ".join(_EIGEN)}')
    how = {'n': n, 's': s, 'offset': offset, 'path': path}
    return EigenDesign(*_alcap.eigen_design(surface, list(strokes), list(singularities), how, _given(**options),
                                            progress, threads))


@dataclass(frozen=True)
class AlignedField:
    """What aligned_field() returns.

    Attributes
    ----------
    field : Field
        |u| is 1 along held features.
    pieces : list of dict
        Per component: held, rows, lambda, steps (tau, energy, largest and rms change in degrees), settled, residual,
        solver.
    free_corners : (k,) array of int32
        Feature vertices that no n-field can be held at.
    fixed_degrees : float
        Largest angle between a fixed vertex's direction and the field.
    """

    field: Field
    pieces: List[Dict[str, Any]]
    free_corners: Ints
    fixed_degrees: float


def aligned_field(surface: ConnectedSurface, features: FeatureGraph, n: int = 4, *, across: bool = False,
                  weight: float = 0.0, fixed: Sequence[VertexConstraint] = (), linear: bool = False,
                  max_steps: int = 400, settled_degrees: float = 0.1, finest: float = 6.0, solver: str = 'auto',
                  progress: Progress = None, threads: int = 0) -> AlignedField:
    """The n-direction field that runs along features; everything else is free.

    Parameters
    ----------
    features : FeatureGraph
        From sharp_edges() or feature_graph().
    n : int
        Even where there are features.
    across : bool
        Across the features instead of along.
    weight : float
        0: directions are held at features; above 0: features draw softly.
    fixed : sequence of VertexConstraint
        Vertices whose direction is held; they win over features.
    linear : bool
        The harmonic field alone, without steps of renormalising and diffusing.
    max_steps, settled_degrees, finest
        When the steps end, see AlignedOptions in aligned.h.

    Returns
    -------
    AlignedField
    """
    options = {'n': n, 'across': across, 'weight': weight, 'fixed': list(fixed), 'linear': linear,
               'max_steps': max_steps, 'settled_degrees': settled_degrees, 'finest': finest, 'solver': solver}
    return AlignedField(*_alcap.aligned_field(surface, features, options, progress, threads))


def measure_features(surface: ConnectedSurface, field: Field, features: FeatureGraph, *,
                     across: bool = False) -> Dict[str, Any]:
    """How well a field of even n follows features: dict of lines, all (angles in degrees), singularities_at_corners."""
    return _alcap.measure_features(surface, field, features, across)


# ---- files

def write_field(surface: ConnectedSurface, field: Field, *files: Path, singularities: Optional[Any] = None,
                face_scalars: Optional[Mapping[str, npt.ArrayLike]] = None, progress: Progress = None) -> List[str]:
    """Writes a field in the formats of the extensions and returns the files; see FieldRun.write()."""
    return _alcap.write_field(surface, field, _singularities(surface, field, singularities),
                              [os.fspath(f) for f in files], dict(face_scalars or {}), progress)


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


def write_curves(curves: CurveSet, n: int, path: Path) -> None:
    """Writes curves of an n-field as .vtp, .obj or .json. Raises FileError."""
    _alcap.write_curves(curves, n, os.fspath(path))


# ---- progress

def progress_bar(file: Any = None, width: int = 30) -> Callable[[str, float], None]:
    """A bar for `progress=`: one line that says the phase, what is done of it, and for how long it has run."""
    out = sys.stderr if file is None else file
    start = time.monotonic()

    def tell(phase: str, fraction: float) -> None:
        done = round(width * fraction)
        out.write(f'\r{phase:<12} |{"#" * done}{"-" * (width - done)}| {100 * fraction:3.0f} % '
                  f'{time.monotonic() - start:6.1f} s')
        out.flush()
    return tell


__all__ = [name for name, value in list(globals().items())
           if not name.startswith('_') and getattr(value, '__module__', '') == __name__]
