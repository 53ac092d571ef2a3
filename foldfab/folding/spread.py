"""The furniture as the paper's sheets between two steps of the fold: bases, and patches that stand open or lie flat.

Without thickness a unit comes down until all its bases lie in one plane, and its sheets in it. All patches are as wide
as they will be left, and what is deleted is not there. Made for all chains together: there are few of any one unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldfab.folding.mechanism import joints, tilts
from foldfab.folding.model import Chain
from foldfab.folding.sheets import UP, ends_of, outlines, sheet
from foldfab.geometry.arrays import Array, Indices
from foldfab.geometry.boxes import Boxes, bounds, stacked
from foldfab.scaffold.model import Scaffold


@dataclass(slots=True, eq=False)
class Spread:
    """All sheets, those of bases first, one for each outline; where they are while their bases stand as at first."""

    owner: list[str]
    base: Indices
    """(n,) number of the base that each moves with."""
    boxes: Boxes
    """(n,)"""
    low: Array
    """(n, 3) lower corners of their bounds."""
    high: Array
    """(n, 3) upper corners."""
    shift: Array
    """(b, 3) how far each base has come since, mm."""
    first: int
    """Where those of patches begin, in the order of the chains."""
    flat: Boxes
    """(c,) those of patches when they lie folded."""
    swept: tuple[Array, Array]
    """Lower and upper corners (c, 3) of all that those of patches pass, as seen from their anchors."""
    hung: tuple[Array, Array]
    """The same as seen from their far bases."""

    def lay(self, chains: Indices) -> None:
        """Some patches, by the places of their chains, lie folded."""
        at, flat = chains + self.first, self.flat[chains]
        self.boxes.center[at], self.boxes.axes[at], self.boxes.half[at] = flat.center, flat.axes, flat.half
        self.low[at], self.high[at] = bounds(flat)


def spread(scaffold: Scaffold, chains: Sequence[Chain]) -> Spread:
    """The open furniture whose patches will fold by these chains."""
    number = {base.name: i for i, base in enumerate(scaffold.bases)}
    plates = [outlines(base) for base in scaffold.bases]
    counts = [len(plate) for plate in plates]
    opened, flat, swept, hung = _patches(scaffold, chains)
    boxes = stacked([*plates, opened])
    low, high = bounds(boxes)
    base = np.concatenate([np.repeat(np.arange(len(counts)), counts), [number[c.anchor] for c in chains]])
    owner = [b.name for b, count in zip(scaffold.bases, counts, strict=True) for _ in range(count)]
    owner += [c.patch for c in chains]
    still = np.zeros((len(number), 3))
    return Spread(owner, base.astype(np.int64), boxes, low, high, still, sum(counts), flat, swept, hung)


def _patches(
    scaffold: Scaffold, chains: Sequence[Chain]
) -> tuple[Boxes, Boxes, tuple[Array, Array], tuple[Array, Array]]:
    """The sheets of chains (c,), open and folded, and the bounds of what they pass, as seen from either end."""
    across, along, rise, root, span = (
        np.array([getattr(c, of) for c in chains]) for of in ("across", "along", "rise", "root", "span")
    )
    ends, lean = np.array([ends_of(scaffold, c) for c in chains]), np.array([c.lean for c in chains])
    sin, cos = np.sin(lean)[:, None], np.cos(lean)[:, None]
    up, length = sin * across + cos * rise, np.abs(np.diff(ends)) / cos
    foot = root + up * ((ends[:, 0] - root[:, 2]) / up[:, 2])[:, None]
    middle, half = along * span.mean(1)[:, None], np.zeros((2, len(chains), 3))
    lies, passes = _aside(scaffold, chains, length[:, 0])
    half[:, :, 1], half[0, :, 2:], half[1, :, 2] = np.ptp(span, axis=1) / 2, length / 2, np.ptp(lies, axis=1) / 2
    stood = Boxes(foot + up * length / 2 + middle, np.stack([cos * across - sin * rise, along, up], axis=1), half[0])
    turned = np.stack([np.broadcast_to(UP, across.shape), along, across], axis=1)
    flat = Boxes(foot + across * lies.mean(1)[:, None] + middle, turned, half[1])
    # What swings stands upright once, and comes as high as it is long.
    straight = np.array([c.far is not None and c.mechanism == "in-place" for c in chains])
    height = rise[:, 2] * np.where(straight, np.abs(np.diff(ends))[:, 0], length[:, 0])
    swept = _passed(foot, across, passes, along, span, np.stack([np.zeros(len(chains)), height], axis=1))
    slants = np.array([c.far is not None and c.mechanism == "slanted" for c in chains])
    back = np.stack([-height, np.zeros(len(chains))], axis=1)
    low, high = _passed(foot + up * length, across, -passes[:, ::-1], along, span, back)
    hung = np.where(slants[:, None], low, swept[0]), np.where(slants[:, None], high, swept[1])
    return stood, flat, swept, hung


def _aside(scaffold: Scaffold, chains: Sequence[Chain], length: Array) -> tuple[Array, Array]:
    """Between which places (c, 2) along `across` sheets of some length (c,) lie from their feet when they are folded,
    and at most meanwhile.
    """
    lies = np.array([[0.0, np.sign(c.turn) * a / len(c.lengths)] for c, a in zip(chains, length, strict=True)])
    passes = lies.copy()
    for i, chain in ((i, c) for i, c in enumerate(chains) if c.lean != 0.0):
        passes[i] = [-length[i], length[i]]
        if chain.far is not None and chain.mechanism == "in-place":
            leaning = sheet(scaffold, chain)
            ends, longest = joints(leaning, tilts(leaning, np.ones(1)))[0, :, 0], float(leaning.lengths.max())
            lies[i], passes[i] = [ends.min(), ends.max()], [-longest, longest]
    return np.sort(lies), np.sort(passes)


def _passed(
    foot: Array, across: Array, aside: Array, along: Array, span: Array, height: Array
) -> tuple[Array, Array]:  # fmt: skip
    """Bounds (c, 3) of what is that far (c, 2) aside, along and above (c, 2) of a foot."""
    corners = foot[:, None, None] + (aside[..., None] * across[:, None])[:, :, None]
    corners = (corners + (span[..., None] * along[:, None])[:, None]).reshape(len(foot), 4, 3)
    low, high = corners.min(1), corners.max(1)
    rises = np.sort(height)
    low[:, 2], high[:, 2] = foot[:, 2] + rises[:, 0], foot[:, 2] + rises[:, 1]
    return low, high
