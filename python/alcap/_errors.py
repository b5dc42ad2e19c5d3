# SPDX-License-Identifier: MIT
"""The exceptions of the library. All are `alcap.Error`; those about values are also `ValueError`."""
from __future__ import annotations

from typing import Any, Dict, Sequence

# What messages of the library name, and what does it in Python.
_WORDS = (
    ('Repair::weld', "repairs=['weld']"),
    ('Repair::degenerate', "repairs=['degenerate']"),
    ('Repair::duplicates', "repairs=['duplicates']"),
    ('Repair::split', "repairs=['split']"),
    ('Repair::automatic', "repairs=['auto']"),
    ('Repair::orient', "repairs=['orient']"),
    ('Repair::mollify', "repairs=['mollify']"),
    ('repair_weld()', 'alcap.repair_weld'),
    ('repair_orientation()', 'alcap.repair_orientation'),
    ('EigenOptions::solver', 'solver'),
    ('EigenOptions::method', 'method'),
    ('EigenOptions::max_iterations', 'max_iterations'),
    ('EigenOptions::angle_tolerance', 'angle_tolerance'),
    ('EigenOptions::tolerance', 'tolerance'),
    ('EigenOptions::prove_smallest', 'prove_smallest'),
    ('GlobalOptions::detail', 'detail'),
    ('GlobalOptions::max_iterations', 'connection_iterations'),
    ('GlobalOptions::tolerance', 'connection_tolerance'),
    ('DesignRunOptions::solver', 'solver'),
)


def in_python(message: str) -> str:
    """The message with the names of Python instead of those of C++."""
    for word, python in _WORDS:
        message = message.replace(word, python)
    return message


def report_in_python(report: Dict[str, Any]) -> Dict[str, Any]:
    """The report with its texts in words of Python."""
    return {key: in_python(value) if isinstance(value, str) else value for key, value in report.items()}


class Error(Exception):
    """Everything that the library raises on purpose."""


class FileError(Error, OSError):
    """A file could not be read or written.

    Attributes
    ----------
    path : str
        The file.
    line : int
        Line, from 1, or 0 where lines mean nothing.
    offset : int
        In bytes, or -1.
    """

    def __init__(self, message: str, path: str = '', line: int = 0, offset: int = -1) -> None:
        super().__init__(in_python(message))
        self.path, self.line, self.offset = path, line, offset


class MeshError(Error, ValueError):
    """A mesh cannot be used.

    Attributes
    ----------
    defect : str
        What is wrong, such as 'non_manifold_edge'.
    element : str
        'vertex', 'edge' or 'face': what `first` lists.
    count : int
        How many elements are concerned.
    first : list of int
        The first offenders: vertices, faces, or pairs of vertices for edges.
    """

    def __init__(self, message: str, defect: str = '', element: str = '', count: int = 0,
                 first: Sequence[int] = ()) -> None:
        super().__init__(in_python(message))
        self.defect, self.element, self.count, self.first = defect, element, count, list(first)

    @property
    def vertices(self) -> list[int]:
        """The first offending vertices; empty when it is about other elements."""
        return self.first if self.element == 'vertex' else []

    @property
    def edges(self) -> list[tuple[int, int]]:
        """The first offending edges as pairs of vertices; empty when it is about other elements."""
        return list(zip(self.first[::2], self.first[1::2])) if self.element == 'edge' else []

    @property
    def faces(self) -> list[int]:
        """The first offending faces; empty when it is about other elements."""
        return self.first if self.element == 'face' else []


class OptionError(Error, ValueError):
    """An option or argument has a value that it must not have.

    Attributes
    ----------
    field, value, rule : str
        Which one, its value as text, and what it must be.
    """

    def __init__(self, message: str, field: str = '', value: str = '', rule: str = '') -> None:
        super().__init__(in_python(message))
        self.field, self.value, self.rule = field, value, rule


class SolveError(Error):
    """A solver could not do its work: the matrix is not positive definite, memory ran out."""


class Cancelled(Error):
    """A call was stopped."""


for _error in (Error, FileError, MeshError, OptionError, SolveError, Cancelled):
    _error.__module__ = 'alcap'
