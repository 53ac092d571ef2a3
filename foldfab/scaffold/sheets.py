"""The parts that fold, as medial sheets; sheets that cannot be told apart in print become one.

Section 5.1, medial sheet extraction. The paper's patches have no thickness; in print, two parallel sheets whose
mid-planes are closer than a panel and a gap would be one lump, so they are merged here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, bounds, near_pairs
from foldfab.geometry.rotation import cross
from foldfab.scaffold.segments import Segment, sheet

PARALLEL = np.cos(np.radians(5.0))
"""Sheets within this angle of each other count as parallel."""
OVERLAP = 0.5
"""Sheets are merged where they share at least this much of the smaller one, in width and in length."""
SLACK = 1e-6
"""What rounding may make of a cosine or of a length in mm, and far more."""


@dataclass(frozen=True, slots=True, eq=False)
class Sheet:
    """A rectangle with horizontal hinge direction that abstracts one or more parts that fold."""

    parts: tuple[str, ...]
    center: Array
    """(3,) mm."""
    along: Array
    """(3,) unit hinge direction, horizontal."""
    up: Array
    """(3,) unit, rising."""
    width: float
    """mm along `along`."""
    length: float
    """mm along `up`."""
    thickness: float
    """mm, of the part itself."""
    hingeable: bool

    @property
    def normal(self) -> Array:
        """(3,) unit."""
        across: Array = cross(self.along, self.up)
        return across

    @property
    def bottom(self) -> float:
        """Height of its lower end, mm."""
        return float(self.center[2] - self.up[2] * self.length / 2)

    @property
    def top(self) -> float:
        """Height of its upper end, mm."""
        return float(self.center[2] + self.up[2] * self.length / 2)

    def at(self, height: float) -> Array:
        """(3,) the middle of its horizontal line at that height."""
        middle: Array = self.center + self.up * (height - self.center[2]) / self.up[2]
        return middle


def sheets(parts: tuple[Segment, ...], distance: float) -> tuple[Sheet, ...]:
    """The medial sheets of parts that fold; parallel ones closer than `distance` mm that overlap become one."""
    found = [Sheet((part.name,), part.center, *sheet(part), part.hingeable) for part in parts]
    return tuple(_merged(sorted(found, key=lambda s: (-s.width * s.length, s.parts)), distance))


def as_boxes(many: tuple[Sheet, ...]) -> Boxes:
    """The solid boxes of the sheets (n,), axes along, up and normal."""
    return Boxes(
        np.array([s.center for s in many]).reshape(-1, 3),
        np.array([[s.along, s.up, s.normal] for s in many]).reshape(-1, 3, 3),
        np.array([[s.width, s.length, s.thickness] for s in many]).reshape(-1, 3) / 2,
    )


def joined(a: Sheet, b: Sheet) -> Sheet:
    """The tight rectangle in the plane of `a` around both."""
    corners = [_corners(a, a), _corners(a, b)]
    low = np.minimum(corners[0][0], corners[1][0])
    high = np.maximum(corners[0][1], corners[1][1])
    middle = (low + high) / 2
    center = a.center + middle[0] * a.along + middle[1] * a.up
    size = high - low
    parts = (*a.parts, *(p for p in b.parts if p not in a.parts))
    return replace(
        a,
        parts=parts,
        center=center,
        width=float(size[0]),
        length=float(size[1]),
        hingeable=a.hingeable and b.hingeable,
    )


def _merged(rest: list[Sheet], distance: float) -> list[Sheet]:
    """Each sheet in turn is joined to the first before it, as that has grown by then, with which it is one."""
    flat = as_boxes(tuple(rest))
    rivals = [set[int]() for _ in rest]
    for old, new in _alike(flat, flat, distance):
        if old < new:
            rivals[new].add(old)
    done: dict[int, Sheet] = {}
    for new, leaf in enumerate(rest):
        twin = next((i for i in sorted(rivals[new]) if i in done and _are_one(done[i], leaf, distance)), None)
        if twin is None:
            done[new] = leaf
            continue
        done[twin] = joined(done[twin], leaf)
        for _, later in _alike(as_boxes((done[twin],)), flat[new + 1 :], distance):
            rivals[new + 1 + later].add(twin)
    return list(done.values())


def _alike(a: Boxes, b: Boxes, distance: float) -> list[tuple[int, int]]:
    """All pairs of sheets, as `as_boxes` gives them, that may be one, and few others: what is parallel and close.

    Seen in the plane of `a`, `b` may be turned: the tight rectangle around it lies in a square around its circle.
    """
    around = np.sqrt(2.0) * np.hypot(b.half[:, 0], b.half[:, 1])[:, None] + distance + SLACK
    flat = Boxes(a.center, a.axes, a.half * [1.0, 1.0, 0.0])
    i, j = near_pairs(bounds(flat), (b.center - around, b.center + around))
    normal, offset = a.axes[i, 2], b.center[j] - a.center[i]
    is_parallel = np.abs((normal * b.axes[j, 2]).sum(1)) > PARALLEL - SLACK
    kept = is_parallel & (np.abs((normal * offset).sum(1)) < distance + SLACK)
    return list(zip(i[kept].tolist(), j[kept].tolist(), strict=True))


def _are_one(a: Sheet, b: Sheet, distance: float) -> bool:
    if abs(a.normal @ b.normal) < PARALLEL or abs((b.center - a.center) @ a.normal) >= distance:
        return False
    low_a, high_a = _corners(a, a)
    low_b, high_b = _corners(a, b)
    shared = np.minimum(high_a, high_b) - np.maximum(low_a, low_b)
    return bool((shared > OVERLAP * np.minimum(high_a - low_a, high_b - low_b)).all())


def _corners(frame: Sheet, other: Sheet) -> tuple[Array, Array]:
    """Lower and upper corner (2,) of `other` in the plane coordinates (along, up) of `frame`."""
    plane = np.stack([frame.along, frame.up])
    middle = plane @ (other.center - frame.center)
    reach = np.abs(plane @ other.along) * other.width / 2 + np.abs(plane @ other.up) * other.length / 2
    return middle - reach, middle + reach
