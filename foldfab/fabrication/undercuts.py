"""What is taken from panels around their hinges, so that knuckles which hang in the air as they are printed come free.

The first layers of such a knuckle are laid over a gap that is one or two layers high, and grow together with what lies
below. A round one, of 4 mm, lays a stripe of 1.7 mm there. So, where axes lie level, a panel's knuckle is pointed where
another body lies below or above it: by two planes of 45° that just leave its cones whole. The room that a panel leaves
around the knuckles of another one gets a roof of 45°. Where axes stand upright, knuckles taper to their cones at both
ends. Material is only taken away, so that every gap and every clearance of the fold stays.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from foldfab.fabrication.hinges import Knuckles, knuckles, stretches
from foldfab.fabrication.shapes import Shape, box, cone, cut, prism
from foldfab.fabrication.walls import LINE
from foldfab.folding.model import Chain, Thickness
from foldfab.geometry.arrays import Array

KEPT = 0.02
"""How much thicker than a cone what is kept around it is: coplanar faces leave slivers, mm."""
CLEAR = 0.1
"""How far a cutter reaches beyond what it cuts, mm."""
LEVEL = 0.1
"""An axis that rises by less than this along its way lies level, one that leans by less stands upright, as a sine."""
FACING = 0.2
"""A way faces another one where the cosine between them is more than this."""
WEB = 2 * LINE
"""What is left of a panel beyond a roof at least, mm."""
HALF = 0.5
"""A knuckle tapers over no more than this share of its length."""


@dataclass(frozen=True, slots=True)
class _Hinge:
    """A hinge at which a panel has the inner knuckles, in the panel's frame."""

    marks: Knuckles
    x: float
    z: float
    """Its axis, mm."""
    carrier: Array
    """(2,) x and z of the way to the body that carries it."""
    limit: float
    """How far along z, away from that body, knuckles may be cut, mm from the axis."""

    def around(self, outline: list[Array]) -> list[tuple[float, float]]:
        """Points (2,) around the axis, in the panel's frame."""
        return [(float(self.x + x), float(self.z + z)) for x, z in outline]


@dataclass(frozen=True, slots=True)
class Undercuts:
    """What is cut from one panel, in its frame."""

    slab: list[Shape]
    """From the plain panel, before it has its knuckles."""
    knuckles: list[Shape]
    """From the panel with its knuckles."""


def undercuts(chain: Chain, thickness: Thickness, i: int, up: Array) -> Undercuts:
    """What is cut from panel `i` of a chain, where `up` (3,) in its frame points up in print; it is open there."""
    found = Undercuts([], [])
    if abs(up[1]) > np.sqrt(1 - LEVEL**2):
        for hinge in _hinges(chain, thickness, i):
            found.knuckles.extend(_tapers(hinge, thickness))
    elif abs(up[1]) < LEVEL:
        rise = np.array([up[0], up[2]]) / np.hypot(up[0], up[2])
        found.slab.extend(_ends(chain, thickness, i, rise))
        for way in (-rise, rise):
            for hinge in _hinges(chain, thickness, i):
                if way @ hinge.carrier > FACING:
                    found.knuckles.extend(_point(hinge, thickness, way))
                if hinge.x and way @ (hinge.carrier * [1.0, -1.0]) > FACING:
                    found.slab.extend(_roofs(hinge, chain, thickness, i, way))
    return found


def _hinges(chain: Chain, thickness: Thickness, i: int) -> Iterator[_Hinge]:
    last, beyond = len(chain.lengths) - 1, thickness.panel / 2 - _depth(thickness)
    for j in (i, i + 1) if i == last and chain.far is not None else (i,):
        marks, x = knuckles(chain.hinge_spans[j], thickness, chain.breaks), float(chain.offsets[j])
        if 0 < j <= last:
            yield _Hinge(marks, x, 0.0, -np.array([np.sign(x), 1.0]) / np.sqrt(2), min(beyond, thickness.gap / 2))
        elif j == 0:
            yield _Hinge(marks, 0.0, 0.0, np.array([0.0, -1.0]), beyond)
        else:
            yield _Hinge(marks, 0.0, float(chain.lengths[last]), np.array([0.0, 1.0]), beyond)


def _depth(thickness: Thickness) -> float:
    """How far from the axis the edge of a pointed knuckle is, mm: its planes just leave the cones whole."""
    return float(np.sqrt(2.0)) * (thickness.pin_radius + KEPT)


def _point(hinge: _Hinge, thickness: Thickness, way: Array) -> Iterator[Shape]:
    """What lies outside two planes of 45° that meet in an edge on the side of `way` (2,)."""
    half, edge = thickness.panel / 2, _depth(thickness)
    reach = half + CLEAR
    # The planes end where they reach the faces of the panel.
    flank = [(half, edge - half), (0.0, edge), (0.0, reach), (reach, reach), (reach, edge - half)]
    for sign in (-1.0, 1.0):
        outline = _turned([(sign * across, along) for across, along in flank], way)
        outline = _clipped(outline, -np.sign(hinge.carrier) * [0.0, 1.0], hinge.limit)
        for a, b in hinge.marks.follower if outline else ():
            yield prism(hinge.around(outline), a - thickness.gap / 2, b + thickness.gap / 2)


def _turned(corners: list[tuple[float, float]], way: Array) -> list[Array]:
    """(2,) x and z of points that are told by how far they are across a way (2,), and along it."""
    side = np.array([-way[1], way[0]])
    return [across * side + along * way for across, along in corners]


def _clipped(outline: list[Array], way: Array, limit: float) -> list[Array]:
    """What of a convex outline of points (2,) lies no further than a limit along a way (2,)."""
    found = []
    for one, other in zip(outline, [*outline[1:], outline[0]], strict=True):
        at, then = float(one @ way) - limit, float(other @ way) - limit
        found += [one] if at <= 0 else []
        found += [one + at / (at - then) * (other - one)] if at * then < 0 else []
    return found


def _roofs(hinge: _Hinge, chain: Chain, thickness: Thickness, i: int, way: Array) -> Iterator[Shape]:
    """Roofs of 45° over the room around the knuckles of the panel below, as high as what is left of this one lets."""
    # Flanks that begin inside the room leave no steps on its facets.
    reach = thickness.knuckle_room - KEPT
    across = abs(hinge.x) + thickness.panel / 2
    most = np.array([across, _beyond(chain, thickness, i, 1.0)]) / np.maximum(np.abs(way), FACING)
    low, top = reach * np.sqrt(0.5), min(reach * np.sqrt(2.0), float(most.min()) - WEB)
    flat = reach * np.sqrt(2.0) - top
    if top <= reach + KEPT:
        return
    corners = [(-low, low), (-flat, top), (flat, top), (low, low), (0.0, 0.0)]
    corners = corners if flat > KEPT else [(-low, low), (0.0, top), (low, low), (0.0, 0.0)]
    span = (float(chain.span[0]), float(chain.span[1]))
    for a, b in stretches(hinge.marks.carrier, thickness.gap, span):
        yield prism(hinge.around(_turned(corners, way)), a, b)


def _ends(chain: Chain, thickness: Thickness, i: int, rise: Array) -> Iterator[Shape]:
    """What lies below a plane of 45° at that end of a panel that looks down on another one, beside the hinge there.

    The plane begins at the lower side of the end: that of the hinge's room, where it is level.
    """
    half, sign = thickness.panel / 2, float(np.sign(rise[1]))
    j = i if sign > 0 else i + 1
    slope = float(np.tan(np.pi / 4 - np.arcsin(min(abs(rise[0]), 1.0))))
    depth = min(half * slope, _beyond(chain, thickness, i, sign) - thickness.gap / 2 - WEB)
    if not 0 < j < len(chain.lengths) or depth < CLEAR:
        return
    back, steep = -float(np.sign(chain.offsets[j])), depth / half
    low, high = -back * thickness.gap / 2, back * half
    low, high = (low, high) if back * rise[0] > -LEVEL else (high, low)
    way = float(np.sign(high - low))
    # From a little inside on: a plane through an edge leaves slivers.
    start, over = low + way * CLEAR, high + way * CLEAR
    corners = [(start - way * CLEAR, -CLEAR), (over, -CLEAR), (over, abs(over - start))]
    end = 0.0 if sign > 0 else float(chain.lengths[i])
    outline = [(float(x), end + sign * (thickness.gap / 2 + steep * z)) for x, z in corners]
    yield prism(outline, float(chain.span[0]) - CLEAR, float(chain.span[1]) + CLEAR)


def _beyond(chain: Chain, thickness: Thickness, i: int, sign: float) -> float:
    """How far it is along a panel from the hinge at its start (or its end, where `sign` < 0) to what the other takes."""
    last, length = len(chain.lengths) - 1, float(chain.lengths[i])
    other = i + 1 if sign > 0 else i
    if other in (0, last + 1):
        has_base = other == 0 or chain.far is not None
        return length - thickness.foot_room * has_base
    return length - thickness.knuckle_room


def _tapers(hinge: _Hinge, thickness: Thickness) -> Iterator[Shape]:
    """What lies around the cones at both ends of all knuckles, when they widen on to the knuckle's own radius."""
    size, room = thickness.pin_radius, thickness.knuckle_room
    for a, b in hinge.marks.follower:
        deep = min(thickness.panel / 2 - size, HALF * (b - a) / 2)
        for end, way in ((a, 1.0), (b, -1.0)):
            low, high = sorted((end - way * thickness.gap / 2, end + way * deep))
            tip = end - way * (size + KEPT)
            kept = cone(2 * room, tip + way * 2 * room, tip, hinge.x, hinge.z)
            block = box((hinge.x - room, low, hinge.z - room), (hinge.x + room, high, hinge.z + room))
            yield cut(block, [kept])
