# SPDX-License-Identifier: MIT
"""Sparse matrices of SciPy to and from the library."""
from __future__ import annotations

from typing import Any, Tuple

import scipy.sparse

from ._errors import OptionError


def csc(parts: Tuple[Any, Any, Any, Any]) -> scipy.sparse.csc_matrix:
    data, indices, indptr, shape = parts
    matrix = scipy.sparse.csc_matrix((data, indices, indptr), shape=shape, copy=False)
    matrix.has_sorted_indices = True
    return matrix


def csr(parts: Tuple[Any, Any, Any, Any]) -> scipy.sparse.csr_matrix:
    data, indices, indptr, shape = parts
    return scipy.sparse.csr_matrix((data, indices, indptr), shape=shape, copy=False)


def parts(matrix: Any, name: str) -> Tuple[Any, Any, Any]:
    matrix = scipy.sparse.csc_matrix(matrix)
    rows, columns = matrix.shape
    if rows != columns:
        value, rule = f'{rows} x {columns}', 'must be square'
        raise OptionError(f"option '{name}' = {value}: {rule}", name, value, rule)
    if not matrix.has_sorted_indices:
        matrix = matrix.sorted_indices()
    return matrix.data, matrix.indices, matrix.indptr
