"""Pockets, from the data of a solution alone: where a chain sinks into its base, and whether enough is left of that.

A chain whose pad is negative stands that much below the face of its base. What its first panel from there takes up when
folded, with the gap around it, is no plate. A plate is cut only where it lies along the hinges or across.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from foldfab.folding.mechanism import tilts
from foldfab.folding.model import POCKET_SKIN, Chain, FoldSolution, Thickness
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, close_pairs, stacked
from foldfab.validity.claim import axes_of

SQUARE = 1e-6
"""Sine of the angle within which a plate lies along the hinges."""
EXACT = 1e-3
"""The grid of places in print, mm."""


@dataclass(frozen=True, slots=True, eq=False)
class Pocket:
    """One of them."""

    patch: str
    """Whose chain sinks."""
    base: str
    up: float
    """+1 in the upper face of the base, -1 in the lower one."""
    depth: float
    """mm."""
    room: Boxes
    """(1,) what is cut, from its floor to the face, open posture."""


def pockets_in(solution: FoldSolution, base: str) -> list[Pocket]:
    """The pockets of a base."""
    ends = [(c, end) for c in solution.chains for end, name in enumerate((c.anchor, c.far)) if name == base]
    return [_pocket(solution.thickness.of(c.panel), c, end, base) for c, end in ends if c.pads[end] < 0]


def without(plate: Boxes, pockets: list[Pocket]) -> Boxes:
    """A plate (n,) less its pockets."""
    for pocket in pockets:
        plate = stacked([_less(plate[i : i + 1], pocket.room) for i in range(len(plate))])
    return plate


def unsound(solution: FoldSolution, heights: dict[str, tuple[float, float]]) -> Iterator[tuple[str, float, str]]:
    """By patch that sinks, how far it is too deep, mm, and in which words; `heights` are those of each base's faces."""
    for base in solution.scaffold.bases:
        found, (low, high) = pockets_in(solution, base.name), heights[base.name]
        for pocket in found:
            left = high - low - pocket.depth
            if any(outline.extent is not None for outline in base.outlines):
                yield pocket.patch, pocket.depth, f"sinks into {base.name}, whose parts lie at several heights"
            elif left < POCKET_SKIN - EXACT:
                told = f"sinks {pocket.depth:.2f} mm into {base.name} and leaves {max(left, 0.0):.2f} mm of it"
                yield pocket.patch, POCKET_SKIN - left, told
        for one, other in itertools.combinations(found, 2):
            left = high - low - one.depth - other.depth
            if one.up != other.up and left < POCKET_SKIN - EXACT and _overlap(one, other):
                told = f"sinks into {base.name} below the pocket of {other.patch}, {max(left, 0.0):.2f} mm apart"
                yield one.patch, POCKET_SKIN - left, told


def _pocket(thick: Thickness, chain: Chain, end: int, base: str) -> Pocket:
    points = axes_of(chain.root, chain, chain.lengths, chain.offsets, chain.lean)
    flat = tilts(chain, np.array([1.0]))[0]
    # The first panel seen from the base, as far as its other end, or the knuckles of the other base there.
    way, count = (np.sign(flat[0]) if end == 0 else -np.sign(flat[-1])), len(chain.lengths)
    ahead = chain.lengths[-end] + thick.gap + (thick.panel / 2 if count == 1 else 0.0)
    low, high = sorted((-way * (thick.panel / 2 + thick.gap), way * ahead))
    out, depth = (chain.rise if end == 0 else -chain.rise), -chain.pads[end]
    middle = points[-end] + out * (depth / 2 - thick.axis_height)
    middle = middle + chain.across * (low + high) / 2 + chain.along * chain.span.mean()
    half = np.array([[(high - low) / 2, float(np.ptp(chain.span)) / 2 + thick.gap, depth / 2]])
    room = Boxes(middle[None], np.stack([chain.across, chain.along, chain.rise])[None], half)
    return Pocket(chain.patch, base, float(np.sign(out[2])), depth, room)


def _less(plate: Boxes, room: Boxes) -> Boxes:
    """A box (1,) without another one (1,), in up to six pieces; itself where they lie askew."""
    axes, turn = plate.axes[0], np.abs(plate.axes[0] @ room.axes[0].T)
    if (np.minimum(turn, np.sqrt(np.maximum(1 - turn**2, 0.0))) > SQUARE).any():
        return plate
    away, reach = axes @ (room.center[0] - plate.center[0]), turn @ room.half[0]
    low, high = -plate.half[0], plate.half[0].copy()
    if (away - reach >= high).any() or (away + reach <= low).any():
        return plate
    pieces = []
    for axis in (2, 0, 1):
        for begin, end in ((low[axis], (away - reach)[axis]), ((away + reach)[axis], high[axis])):
            if end - begin > EXACT:
                first, last = low.copy(), high.copy()
                first[axis], last[axis] = begin, end
                pieces.append(_piece(plate.center[0], axes, first, last))
        low[axis], high[axis] = max(low[axis], (away - reach)[axis]), min(high[axis], (away + reach)[axis])
    return stacked(pieces)


def _piece(origin: Array, axes: Array, low: Array, high: Array) -> Boxes:
    return Boxes((origin + (low + high) / 2 @ axes)[None], axes[None], (high - low)[None] / 2)


def _overlap(one: Pocket, other: Pocket) -> bool:
    """Whether one lies below the other."""
    flat = [
        Boxes(p.room.center * [1, 1, 0], p.room.axes, np.maximum(p.room.half, [0, 0, one.depth])) for p in (one, other)
    ]
    return bool(len(close_pairs(flat[0], flat[1])[0]))
