# SPDX-License-Identifier: MIT
"""What to see while a long call runs."""
from __future__ import annotations

import sys
import time
from typing import Any, Callable


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


__all__ = [
    'progress_bar',
]
