# SPDX-License-Identifier: MIT
"""Linear solvers and eigensolvers, those of the library and your own."""
from __future__ import annotations

import atexit
import weakref
from typing import Any, Callable, Dict, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import _alcap
from ._errors import report_in_python
from ._sparse import csc, parts
from ._types import Complexes, Progress, given


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


def factorise(A: Any, solver: str = 'auto', *, right_hand_sides: int = 0, tolerance: float = 1e-10,
              max_iterations: int = 1000) -> Factorised:
    """Factorises a Hermitian positive definite sparse matrix (copied).

    Parameters
    ----------
    A : (k, k) sparse matrix of complex128
        Both triangles stored.
    solver : str
        One of linear_solvers(); 'auto' picks one when it sees the matrix.
    right_hand_sides : int
        For 'auto': how many will be solved for; 0: not known, many.
    tolerance : float
        Of iterative backends: relative residual.
    max_iterations : int
        Of iterative backends.

    Returns
    -------
    Factorised

    Raises
    ------
    SolveError
        A is not positive definite, or memory ran out.
    """
    return Factorised(_alcap.factorise(parts(A, 'A'), solver, right_hand_sides, tolerance, max_iterations))


def smallest_eigenpair(S: Any, M: Any, area: float, *, tolerance: Optional[float] = None,
                       angle_tolerance: Optional[float] = None, degree: int = 1, solver: Optional[str] = None,
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
        Relative residual, instead of the angle.
    angle_tolerance : float
        Degrees, 0.01 by default: without a tolerance the solve may end where the angle to the true vector, or to the
        nearest of many that are as smooth, is below this; 0: a residual of 1e-8 instead.
    degree : int
        n where u is an n-th power of directions: angles are those of the directions.
    solver, method : str
        One of linear_solvers(), one of eigen_solvers(); 'auto' by default.
    max_iterations : int
        Operator applications before giving up, 1000 by default.
    seed : int
        Of the start vector, 1 by default.
    prove_smallest : str
        'auto', 'always' or 'never': whether it is proven that no smaller eigenvalue exists.

    Returns
    -------
    u : (#V,) array of complex128
        Of length 1 in M.
    report : dict
        solver, converged, iterations, lambda, next (None where it is not established), residual and energy_residual
        (recomputed), distance (of an eigenvalue from lambda, at most), angle and angle_at_vertices (degrees, None where
        nothing is known), angle_check ('none', 'of many', 'estimated' or 'bounded'), smallest ('proven', 'searched', 'not checked'
        or 'refuted'), lower_bound, smallest_note, seconds, message.
    """
    options = given(tolerance=tolerance, angle_tolerance=angle_tolerance, degree=degree, solver=solver, method=method,
                    max_iterations=max_iterations, seed=seed, prove_smallest=prove_smallest)
    u, report = _alcap.smallest_eigenpair(parts(S, 'S'), parts(M, 'M'), area, options, progress, threads)
    return u, report_in_python(report)


def eigenpairs(S: Any, M: Any, area: float, count: int, *, tolerance: Optional[float] = None,
               angle_tolerance: Optional[float] = None, degree: int = 1, solver: Optional[str] = None,
               method: Optional[str] = None, max_iterations: Optional[int] = None, seed: Optional[int] = None,
               prove_smallest: Optional[str] = None, progress: Progress = None,
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
    options = given(tolerance=tolerance, angle_tolerance=angle_tolerance, degree=degree, solver=solver, method=method,
                    max_iterations=max_iterations, seed=seed, prove_smallest=prove_smallest)
    values, U, report = _alcap.eigenpairs(parts(S, 'S'), parts(M, 'M'), area, count, options, progress, threads)
    return values, U, report_in_python(report)


def inertia(S: Any, M: Any, sigma: float, *, progress: Progress = None, threads: int = 0) -> int:
    """How many eigenvalues of S u = lambda M u lie below sigma (Sylvester's law of inertia)."""
    return _alcap.inertia(parts(S, 'S'), parts(M, 'M'), sigma, progress, threads)


def _until_exit(registration: '_alcap.Registration') -> '_alcap.Registration':
    """Closed before the interpreter ends: afterwards nobody could let go of the callable."""
    seen = weakref.ref(registration)

    def close() -> None:
        left = seen()
        if left is not None:
            left.close()
    atexit.register(close)
    return registration


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
        made = factory(csc(parts))  # type: ignore[arg-type]
        return getattr(made, 'solve', made)
    return _until_exit(_alcap.register_linear_solver(name, make))


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
        return solver(csc(S), csc(M), area, options)
    return _until_exit(_alcap.register_eigen_solver(name, solve))


__all__ = [
    'Factorised', 'eigenpairs', 'factorise', 'inertia', 'register_eigen_solver', 'register_linear_solver',
    'smallest_eigenpair',
]
