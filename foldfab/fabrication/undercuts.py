"""What is taken from panels around their hinges, so that what hangs in the air as it is printed comes free.

The first layers of a knuckle that stands in the air are laid over a gap that is one or two layers high, and grow
together with what lies below. A round one, of 4 mm, lays a stripe of 1.7 mm there. So, where axes lie level, a
panel's knuckle is *pointed* where another body lies below or above it: by two planes of 45° that just leave its cones
whole. Where axes stand upright, knuckles *taper* to their cones at both ends. The *roof* of the room that a panel
leaves around the knuckles of another one, and the end of a panel that stands over another one, are planes of 45° too,
where there is room. Material is only taken away, so that every gap and every clearance of the fold stays.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from foldfab.fabrication.hinges import Knuckles, Mark, knuckles, stretches
from foldfab.fabrication.shapes import Shape, box, cone, cut, placed, prism
from foldfab.fabrication.walls import LINE
from foldfab.folding.mechanism import frames
from foldfab.folding.model import Chain, Thickness
from foldfab.geometry.arrays import Array

KEPT = 0.02
"""How much thicker than a cone what is kept around it is: coplanar faces leave slivers, mm."""
CLEAR = 0.1
"""How far a cutter reaches beyond what it cuts, mm."""
LEVEL, UPRIGHT = 0.1, 0.995
"""An axis that rises by less than the one along its way lies level, by more than the other it stands upright; sines."""
FACING = 0.2
"""A way faces another one where the cosine between them is more than this."""
WEB = 2 * LINE
"""What is left of a panel beyond a roof, and beside a stop, at least, mm."""
SHARE = 0.25
"""A knuckle tapers at either end over no more than this share of its length."""


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

    def around(self, outline: list[Array]) -> list[Mark]:
        """Points (2,) around the axis, in the panel's frame."""
        return [(float(self.x + x), float(self.z + z)) for x, z in outline]


def undercuts(chain: Chain, thickness: Thickness, i: int, up: Array) -> list[Shape]:
    """What is cut from the knuckles of panel `i` of a chain, in its frame; open, `up` (3,) there points up in print."""
    if abs(up[1]) > UPRIGHT:
        return [hole for hinge in _hinges(chain, thickness, i) for hole in _tapers(hinge, thickness)]
    pairs = [(hinge, way) for way in _ways(up) for hinge in _hinges(chain, thickness, i)]
    return [hole for hinge, way in pairs if way @ hinge.carrier > FACING for hole in _point(hinge, thickness, way)]


def roofs(chain: Chain, thickness: Thickness, j: int, up: Array, share: float) -> Iterator[tuple[str, Shape]]:
    """By panel, roofs of 45° over the rooms around the knuckles at inserted hinge `j`, canonical frame.

    They are flat above a share of their height, and where less would be left of the panel; there is none that would be
    no higher than its room. `up` (3,) points up in print, canonical frame; the hinge is open.
    """
    thickness = thickness.of(chain.panel)
    origins, axes = (found[0] for found in frames(chain, np.zeros(1)))
    hinge = next(_hinges(chain, thickness, j))
    # Flanks that begin inside the room leave no steps on its facets.
    reach = thickness.knuckle_room - KEPT
    for way in _ways(axes[j] @ up):
        beyond = np.array([abs(hinge.x) + thickness.panel / 2, _beyond(chain, thickness, j, 1.0)])
        most = float((beyond / np.maximum(np.abs(way), FACING)).min()) - WEB
        low, top = reach * np.sqrt(0.5), min(reach * (1 + share * (np.sqrt(2.0) - 1)), most)
        flat = reach * np.sqrt(2.0) - top
        if way @ (hinge.carrier * [1.0, -1.0]) > FACING and top > reach + KEPT:
            peak = [(-flat, top), (flat, top)] if flat > KEPT else [(0.0, top)]
            outline = hinge.around(_turned([(-low, low), *peak, (low, low)], way))
            for a, b in stretches(hinge.marks.carrier, thickness.gap, _span(chain)):
                yield chain.panels[j], placed(prism(outline, a, b), origins[j], axes[j])


def bevels(
    chain: Chain, thickness: Thickness, j: int, up: Array, taken: tuple[Mark, ...]
) -> Iterator[tuple[str, Shape]]:
    """By panel, what lies below a plane of 45° at that end at inserted hinge `j` that looks down, canonical frame.

    The plane begins at the lower side of the end: beside the hinge, where it is level. `taken` is where along the hinge
    there are stops; `up` (3,) points up in print, canonical frame; the hinge is open.
    """
    thickness = thickness.of(chain.panel)
    origins, axes = (found[0] for found in frames(chain, np.zeros(1)))
    for rise in _ways(axes[j] @ up)[:1]:
        i, sign = (j, 1.0) if rise[1] > 0 else (j - 1, -1.0)
        half, slope = thickness.panel / 2, float(np.tan(np.pi / 4 - np.arcsin(min(abs(rise[0]), 1.0))))
        depth = min(half * slope, _beyond(chain, thickness, i, sign) - thickness.gap / 2 - WEB)
        if depth < CLEAR:
            continue
        back = -float(np.sign(chain.offsets[j])) * half
        low, high = (0.0, back) if back * rise[0] > -LEVEL else (back, 0.0)
        # From a little inside on: a plane through an edge leaves slivers.
        way = CLEAR * float(np.sign(high - low))
        rises = depth / half * np.array([-CLEAR, -CLEAR, abs(high - low)])
        end = 0.0 if sign > 0 else float(chain.lengths[i])
        across = (low, high + way, high + way)
        outline = [(float(x), float(end + sign * (thickness.gap / 2 + z))) for x, z in zip(across, rises, strict=True)]
        for a, b in _beside(_span(chain), taken, thickness.gap + WEB):
            yield chain.panels[i], placed(prism(outline, a, b), origins[i], axes[i])


def _ways(up: Array) -> list[Array]:
    """(2,) x and z of the way up in a panel's frame, and of that down, where axes lie level; else none."""
    if abs(up[1]) > LEVEL:
        return []
    rise: Array = up[[0, 2]] / np.hypot(up[0], up[2])
    return [rise, -rise]


def _span(chain: Chain) -> Mark:
    return float(chain.span[0]), float(chain.span[1])


def _beside(span: Mark, taken: tuple[Mark, ...], margin: float) -> Iterator[Mark]:
    """What is left of a span beside what is taken from it, and a little beyond it at its ends, mm."""
    at = span[0] - CLEAR
    for low, high in [*sorted(taken), (span[1] + CLEAR + margin, np.inf)]:
        if low - margin > at:
            yield at, low - margin
        at = max(at, high + margin)


def _hinges(chain: Chain, thickness: Thickness, i: int) -> Iterator[_Hinge]:
    last, beyond = len(chain.lengths) - 1, thickness.panel / 2 - _depth(thickness)
    for j in (i, i + 1) if i == last and chain.far is not None else (i,):
        marks, x = knuckles(chain.hinge_spans[j], thickness, chain.breaks), float(chain.offsets[j])
        if 0 < j <= last:
            way = -np.array([np.sign(x), 1.0]) / np.sqrt(2.0)
            yield _Hinge(marks, x, 0.0, way, min(beyond, thickness.gap / 2))
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


def _turned(corners: list[Mark], way: Array) -> list[Array]:
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


def _beyond(chain: Chain, thickness: Thickness, i: int, sign: float) -> float:
    """How far it is along a panel from the hinge at its start, or its end where `sign` < 0, to what the other takes."""
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
        deep = min(thickness.panel / 2 - size, SHARE * (b - a))
        for end, way in ((a, 1.0), (b, -1.0)):
            low, high = sorted((end - way * thickness.gap / 2, end + way * deep))
            tip = end - way * (size + KEPT)
            kept = cone(2 * room, tip + way * 2 * room, tip, hinge.x, hinge.z)
            block = box((hinge.x - room, low, hinge.z - room), (hinge.x + room, high, hinge.z + room))
            yield cut(block, [kept])
