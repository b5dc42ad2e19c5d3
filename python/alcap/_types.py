# SPDX-License-Identifier: MIT
"""Types that several modules name."""
from __future__ import annotations

from typing import Callable, Optional

#: Called with the phase and the part of it that is done, in [0, 1].
Progress = Optional[Callable[[str, float], object]]
