# SPDX-License-Identifier: MIT
"""Types and small things that several modules name."""
from __future__ import annotations

import os
from typing import Any, Callable, Dict, Optional, Union

import numpy as np
import numpy.typing as npt

#: Called with the phase and the part of it that is done, in [0, 1].
Progress = Optional[Callable[[str, float], object]]

Path = Union[str, 'os.PathLike[str]']
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
Complexes = npt.NDArray[np.complex128]

CONNECTION_OPTIONS = ('connection', 'detail', 'length_factor', 'tan_cap', 'cones', 'balance_cones',
                      'generator_holonomy', 'loop_index', 'target', 'spread', 'connection_tolerance',
                      'connection_iterations')
EIGEN_OPTIONS = ('tolerance', 'angle_tolerance', 'solver', 'method', 'max_iterations', 'seed', 'prove_smallest')


def given(**options: Any) -> Dict[str, Any]:
    """The options that are not None."""
    return {name: value for name, value in options.items() if value is not None}
