"""What of a body counts for its box: the corners of its hull, and its smallest box as such."""

from __future__ import annotations

from dataclasses import dataclass

from foldfab.geometry.arrays import Array
from foldfab.intake.model import Body
from foldfab.intake.tight import Frame, hull, least, main_frame


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """A body's hull, and its smallest box."""

    body: Body
    corners: Array
    """(k, 3) of its hull."""
    axes: Frame
    """Of its smallest box."""


def outline(body: Body) -> Outline | None:
    """None where it has no area."""
    corners, normals = hull(body.mesh.vertices)
    return Outline(body, corners, least(corners, normals)) if len(normals) else None


def main_axes(outlines: list[Outline]) -> Frame:
    """The axes of the furniture that they make together."""
    return main_frame([o.corners for o in outlines], [o.axes for o in outlines])
