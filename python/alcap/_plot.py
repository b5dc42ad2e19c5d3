# SPDX-License-Identifier: MIT
"""Pictures with matplotlib."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Sequence

import numpy as np
import numpy.typing as npt

from . import _alcap

if TYPE_CHECKING:  # pragma: no cover
    from matplotlib.figure import Figure

    from ._run import Run


def _camera(view: Sequence[float]) -> npt.NDArray[np.float64]:
    """Rows right, up, towards the eye."""
    out = np.asarray(view, dtype=float)
    out = out / np.linalg.norm(out)
    up = np.array([0.0, 0.0, 1.0]) if abs(out[2]) < 0.95 else np.array([0.0, 1.0, 0.0])
    right = np.cross(up, out)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(out, right), out])


# The colours of the page (apps/viewer/style.css).
CANVAS, CLAY, INK = '#f3f1ec', '#ebe5d8', '#2b3644'
MARKS = ((1, '#d55e00', 'o'), (-1, '#0072b2', 'D'))


def draw(run: 'Run', ax: Any, view: Sequence[float], arrows: int, length: Optional[float]) -> 'Figure':
    """See FieldRun.plot()."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import to_rgb
    from matplotlib.figure import Figure

    surface = run.surface
    if ax is None:
        figure = Figure(figsize=(6, 6), facecolor=CANVAS)
        FigureCanvasAgg(figure)
        ax = figure.add_axes((0, 0, 1, 1))
    camera = _camera(view)
    points = surface.V @ camera.T
    normals = np.cross(surface.V[surface.F[:, 1]] - surface.V[surface.F[:, 0]],
                       surface.V[surface.F[:, 2]] - surface.V[surface.F[:, 0]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    facing = normals @ camera[2]
    depth = points[surface.F, 2].mean(axis=1)
    front = np.flatnonzero(facing > 0)
    front = front[np.argsort(depth[front])]
    shade = 0.65 + 0.35 * facing[front]
    ax.add_collection(PolyCollection(points[surface.F[front]][:, :, :2], antialiased=False,
                                     facecolors=np.outer(shade, to_rgb(CLAY))))
    frames = run.frames
    assert frames is not None
    seen = np.flatnonzero(frames.N @ camera[2] > 0.1)
    if len(seen) > arrows:
        seen = seen[np.linspace(0, len(seen) - 1, arrows).astype(int)]
    size = length if length is not None else 0.8 * float(surface.lengths.mean())
    largest = max((float(np.linalg.norm(run.vectors(k), axis=1).max()) for k in range(run.n)), default=1.0) or 1.0
    segments = []
    for k in range(run.n):
        vectors = (run.vectors(k)[seen] @ camera.T)[:, :2] * (size / largest)
        segments.append(np.stack([points[seen, :2], points[seen, :2] + vectors], axis=1))
    ax.add_collection(LineCollection(np.concatenate(segments), colors=INK, linewidths=0.6))
    found = run.singularities
    if len(found):
        at = _alcap.singularity_positions(surface, found) @ camera.T
        visible = facing[found['face']] > 0
        for sign, color, marker in MARKS:
            chosen = visible & (np.sign(found['index']) == sign)
            ax.scatter(at[chosen, 0], at[chosen, 1], s=28, c=color, marker=marker, edgecolors='white', linewidths=0.6, zorder=3)
    ax.set_aspect('equal')
    ax.autoscale_view()
    ax.set_axis_off()
    return ax.figure
