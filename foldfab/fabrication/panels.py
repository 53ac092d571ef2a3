"""Panels: slabs of thickness K with a rounded end at each base hinge, cut for their neighbours' knuckles."""

from __future__ import annotations

import numpy as np

from foldfab.fabrication.hinges import knuckles, room, webs
from foldfab.fabrication.shapes import Shape, box, cut, placed, rod, union
from foldfab.fabrication.styles import style
from foldfab.fabrication.undercuts import undercuts
from foldfab.folding.mechanism import frames
from foldfab.folding.model import Chain, Thickness
from foldfab.geometry.arrays import Array


def panels(chain: Chain, thickness: Thickness, up: Array | None = None) -> list[Shape]:
    """The panels of a chain in the open posture, from the anchor on.

    `up` (3,) is the way that points up where it is printed like that, canonical frame; else None.
    """
    thickness = thickness.of(chain.panel)
    origins, axes = frames(chain, np.zeros(1))
    made = [_panel(chain, thickness, i, None if up is None else axes[0, i] @ up) for i in range(len(chain.lengths))]
    return [placed(body, origins[0, i], axes[0, i]) for i, body in enumerate(made)]


def _panel(chain: Chain, thickness: Thickness, i: int, up: Array | None) -> Shape:
    """One panel in its own frame: x along its normal, y along the hinges, z along its length from its first axis."""
    half, gap, last = thickness.panel / 2, thickness.gap, len(chain.lengths) - 1
    low, high = float(chain.span[0]), float(chain.span[1])
    length = float(chain.lengths[i])
    start, end = (0.0 if i == 0 else gap / 2), (length if i == last else length - gap / 2)
    solid = [box((-half, low, start), (half, high, end))]
    holes: list[Shape] = []
    extra: list[Shape] = []
    sockets: list[Shape] = []
    pinned = style(thickness.hinge)
    ends = [(0, 0.0)] if i == 0 else []
    ends += [(last + 1, length)] if i == last and chain.far is not None else []
    for hinge, z in ends:
        solid.append(rod(half, low, high, 0.0, z))
        marks = knuckles(chain.hinge_spans[hinge], thickness, chain.breaks)
        holes += room(marks.carrier + marks.free, thickness.foot_room, thickness, 0.0, z, (low, high))
        more, bores = pinned.follower(marks, thickness, 0.0, z)
        extra, sockets = extra + more, sockets + bores
    if i > 0:
        marks, x = knuckles(chain.hinge_spans[i], thickness, chain.breaks), float(chain.offsets[i])
        holes += room(marks.carrier, thickness.knuckle_room, thickness, x, 0.0, (low, high))
        more, bores = pinned.follower(marks, thickness, x, 0.0)
        extra, sockets = extra + more + webs(marks.follower, thickness, x, 0.0, 1.0), sockets + bores
    if i < last:
        marks, x = knuckles(chain.hinge_spans[i + 1], thickness, chain.breaks), float(chain.offsets[i + 1])
        holes += room(marks.follower, thickness.knuckle_room, thickness, x, length, (low, high))
        more, bores = pinned.carrier(marks, thickness, x, length)
        extra, sockets = extra + more + webs(marks.carrier, thickness, x, length, -1.0), sockets + bores
    sockets += undercuts(chain, thickness, i, up) if up is not None else []
    return cut(union([cut(union(solid), holes), *extra]), sockets)
