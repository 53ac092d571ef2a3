"""Base plates: the outlines of the parts in a base patch, K thick, with feet, plinths and pockets of their hinges."""

from __future__ import annotations

import numpy as np

from foldfab.fabrication.hinges import feet, knuckles
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, box, cut, hull, placed, union
from foldfab.fabrication.solids import pieces, without_crumbs
from foldfab.fabrication.styles import style
from foldfab.folding.anatomy import RIM, base_boxes, faces, pockets
from foldfab.folding.mechanism import joints, tilts
from foldfab.folding.model import Chain, Thickness
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes
from foldfab.scaffold.model import BasePatch

GROWTH = (0.0, 0.2, 0.5, 1.0, 2.0)
"""By how much outlines are grown, mm, until parts that touch are one body."""
ROOT_SHARE = 0.5
"""How deep a foot reaches into its plate, as a share of its own thickness or the plate's."""
WALL = 1.2
"""Beside a pocket no wall thinner than this is left, mm."""
OPEN = GROWTH[-1] + 0.1
"""How far a pocket is cut beyond the faces and edges that it opens, mm: outlines may be grown."""


def plate(base: BasePatch, chains: tuple[Chain, ...], thickness: Thickness) -> tuple[Shape, bool]:
    """The shape of a base in the open posture, and whether it had to be filled to hold together."""
    posts: list[Shape] = []
    sockets: list[Shape] = []
    pads: list[Shape] = []
    for chain in chains:
        for end in _ends(chain, base.name):
            solid, holes, pad = _mount(chain, base, thickness, end)
            posts, sockets, pads = posts + solid, sockets + holes, [*pads, pad]
    body, is_filled = _one_body(_members(base, thickness), pads)
    return cut(union([cut(body, recesses(base, chains, thickness)), *posts]), sockets), is_filled


def recesses(base: BasePatch, chains: tuple[Chain, ...], thickness: Thickness) -> list[Shape]:
    """What is cut from a base, before anything stands on it, for the chains that sink into it; open posture."""
    found = [(pockets(c, end, thickness), end) for c in chains for end in _ends(c, base.name) if c.pads[end] < 0]
    edges = [base_boxes(base, thickness), *(pocket for pocket, _ in found)]
    return [_recess(pocket, end, edges) for pocket, end in found]


def _recess(pocket: Boxes, end: int, edges: list[Boxes]) -> Shape:
    """A pocket (1,) as it is cut: on to an edge of the plate, or of another pocket, that is near."""
    half, axes = pocket.half[0], pocket.axes[0]
    low, high = -half, half.copy()
    for beside in edges:
        for i in range(2):
            middle = (beside.center - pocket.center[0]) @ axes[i]
            reach = np.abs(beside.axes @ axes[i] * beside.half).sum(1)
            for edge in np.concatenate([middle - reach, middle + reach]).tolist():
                low[i] = edge - OPEN if -half[i] - WALL < edge < -half[i] else low[i]
                high[i] = edge + OPEN if half[i] < edge < half[i] + WALL else high[i]
    low[2], high[2] = (low[2], high[2] + OPEN) if end == 0 else (low[2] - OPEN, high[2])
    return placed(box(low, high), pocket.center[0], axes)


def _members(base: BasePatch, thickness: Thickness) -> Boxes:
    """The plate's members (n,): as thick as the plate or, at several heights, each where its part lies."""
    boxes, face = base_boxes(base, thickness), faces(base, thickness)
    center, half = boxes.center.copy(), boxes.half.copy()
    for i, outline in enumerate(base.outlines):
        if outline.extent is not None:
            middle, rise = sum(outline.extent) / 2, (outline.extent[1] - outline.extent[0]) / 2
            rise = max(rise, thickness.of(base.thickness).panel / 2) + RIM
            low, high = max(middle - rise, face.bottom), min(middle + rise, face.top)
            center[i, 2], half[i, 2] = (low + high) / 2, (high - low) / 2
    return Boxes(center, boxes.axes, half)


def _one_body(outlines: Boxes, pads: list[Shape]) -> tuple[Shape, bool]:
    for growth in GROWTH:
        body = union([_slab(outlines[i : i + 1], growth) for i in range(len(outlines))] + pads)
        if pieces(without_crumbs(printed(body))) == 1:
            return body, False
    return hull([_slab(outlines[i : i + 1], 0.0) for i in range(len(outlines))] + pads), True


def _slab(outline: Boxes, growth: float) -> Shape:
    half = outline.half[0] + np.array([growth, growth, 0.0])
    return placed(box(-half, half), outline.center[0], outline.axes[0])


def _ends(chain: Chain, base: str) -> list[int]:
    """Which ends of a chain a base carries: 0 for the anchor's, 1 for the far one."""
    return [i for i, name in enumerate((chain.anchor, chain.far)) if name == base]


def _mount(chain: Chain, base: BasePatch, thickness: Thickness, end: int) -> tuple[list[Shape], list[Shape], Shape]:
    """Feet and plinth, sockets, and the bit of plate below them."""
    axis, rise = axis_of(chain, end), chain.rise * (1.0 if end == 0 else -1.0)
    # Right-handed with z along the outward direction of the face.
    frame = np.stack([chain.across, chain.along if end == 0 else -chain.along, rise])
    face, thickness = faces(base, thickness), thickness.of(chain.panel)
    span, hinge = (chain.span, chain.hinge_spans[0]) if end == 0 else (-chain.span[::-1], -chain.hinge_spans[-1][::-1])
    marks = knuckles(chain.hinge_spans[0 if end == 0 else -1], thickness, chain.breaks)
    marks = marks if end == 0 else marks.mirrored
    pad, half = chain.pads[end], thickness.panel / 2
    plate = face.top - face.bottom
    depth = thickness.axis_height + max(pad, 0.0) + ROOT_SHARE * min(thickness.panel, plate + min(pad, 0.0))
    solid, holes = style(thickness.hinge).carrier(marks, thickness, 0.0, 0.0)
    solid += feet(marks, thickness, depth)
    if pad > 0:
        solid.append(box((-half, span[0], -depth), (half, span[1], -thickness.axis_height)))
    low, high = (span if pad > 0 else hinge) + np.array([-RIM, RIM]) * (pad > 0)
    below = thickness.axis_height + pad
    slab = box((-half - RIM, low, -below - plate), (half + RIM, high, -below))
    made = [placed(s, axis, frame) for s in solid]
    return made, [placed(h, axis, frame) for h in holes], placed(slab, axis, frame)


def axis_of(chain: Chain, end: int) -> Array:
    """(3,) the middle of the chain's first (0) or last (1) hinge axis in the open posture."""
    if end == 0:
        return chain.root
    place: Array = chain.root + joints(chain, tilts(chain, np.zeros(1)))[0, -1] @ np.stack([chain.across, chain.rise])
    return place
