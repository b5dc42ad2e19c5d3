# SPDX-License-Identifier: MIT
"""What a design can ask for."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Optional, Tuple, Union

from ._alcap import Polyline

if TYPE_CHECKING:
    from ._features import FeatureGraph


@dataclass(frozen=True)
class SingularityTarget:
    """A singularity of index sign / n in a face.

    Parameters
    ----------
    face : int
    sign : int
        +1: source, vortex, spiral (n = 1), wedge (n = 2); -1: saddle, trisector.
    orientation : float
        Radians, in the face's frame (its first edge). n = 1 and positive: 0 source, pi/2 vortex, pi sink; otherwise
        the direction of one of the straight branches.
    strength : float
        1 holds against a guidance field of unit length.
    pin : (float, float, float), optional
        Puts the zero exactly at these barycentric coordinates.
    count : int
        So many zeros of index sign / n side by side, as one pattern of index sign * count / n.
    """

    face: int
    sign: int = 1
    orientation: float = 0.0
    strength: float = 1.0
    pin: Optional[Tuple[float, float, float]] = None
    count: int = 1
    kind: ClassVar[str] = 'singularity'


@dataclass(frozen=True)
class VertexConstraint:
    """The field at a vertex: u[vertex] = value, or with `direction_only` a real multiple of it.

    Parameters
    ----------
    vertex : int
    value : complex
        The n-th power of a branch, in the vertex frame.
    direction_only : bool
    """

    vertex: int
    value: complex = 1.0
    direction_only: bool = False
    kind: ClassVar[str] = 'vertex'


@dataclass(frozen=True)
class Stroke:
    """Alignment with a line on the surface, softly.

    Parameters
    ----------
    line : Polyline
        From stroke_through_points(), stroke_along_vertices() or stroke_from_space().
    weight : float
        Larger follows closer.
    radius : float
        Half the width of a hat-shaped footprint, in the unit of V; 0: the line alone.
    """

    line: Polyline
    weight: float = 1.0
    radius: float = 0.0
    kind: ClassVar[str] = 'stroke'


@dataclass(frozen=True)
class EigenStroke:
    """Alignment of an eigen_design() with a line on the surface.

    Parameters
    ----------
    line : Polyline
        From stroke_through_points(), stroke_along_vertices() or stroke_from_space().
    weight : float
        1 draws the field to within a few degrees of the line, on every mesh and in every unit.
    across : bool
        Across the line, not along it.
    radius : float
        Half the width of a hat-shaped footprint, in the unit of V; 0: the line alone.
    """

    line: Polyline
    weight: float = 1.0
    across: bool = False
    radius: float = 0.0
    kind: ClassVar[str] = 'eigen_stroke'


@dataclass(frozen=True)
class BoundaryAlignment:
    """Alignment with every boundary loop, softly: along it, or with `normal` across it."""

    normal: bool = False
    weight: float = 1.0
    kind: ClassVar[str] = 'boundary'


@dataclass(frozen=True)
class FeatureAlignment:
    """Alignment of a field of even n with edges: drawn to unit vectors along them, and held there.

    Parameters
    ----------
    features : FeatureGraph
        From sharp_edges() or feature_graph().
    across : bool
        Across the features, not along them.
    weight : float
        As of Stroke.
    hold : bool
        Directions at vertices are exact, except where features meet that no n-direction follows; the weight draws
        lengths to 1.
    """

    features: FeatureGraph
    across: bool = False
    weight: float = 1.0
    hold: bool = True
    kind: ClassVar[str] = 'features'


@dataclass(frozen=True)
class ControlTolerances:
    """How far off controls may be and still count as met; the field itself does not depend on it.

    Parameters
    ----------
    singularity_degrees, fixed_degrees : float
        Orientation of a singularity, direction at a vertex. Degrees are in (0, 180].
    stroke_degrees, boundary_degrees : float
        Mean deviation from a stroke or features, and from the boundary, degrees.
    cone_degrees : float
        Curvature of a cone, 360 degrees to index 1.
    fixed_value : float
        Vertices whose length is given as well: relative, in (0, 1], as all that follow.
    pin_length : float
        Length of the field at a pinned zero, relative to the corners of its face; in design_field().
    """

    singularity_degrees: float = 0.5
    fixed_degrees: float = 0.5
    stroke_degrees: float = 10.0
    boundary_degrees: float = 10.0
    cone_degrees: float = 360e-6
    fixed_value: float = 1e-6
    pin_length: float = 1e-6


Control = Union[SingularityTarget, VertexConstraint, Stroke, BoundaryAlignment, FeatureAlignment]
