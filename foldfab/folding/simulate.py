"""One unit's fold played through with all its parts thick: the check that every choice has to pass.

The conflict graph looks at pairs along a nominal fold; here the chosen chains move exactly as they will, with their
plinths and windows, against everything near. What meets is reported, and the search learns from it. The fold is played
in scenes of a few frames, so that a chain that stands still in one takes part as one rigid thing.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping

import numpy as np

from foldfab.folding import anatomy
from foldfab.folding.anatomy import Ride
from foldfab.folding.model import Chain, Thickness
from foldfab.folding.press import Motion
from foldfab.folding.space import Batch, batch, carried, meetings
from foldfab.folding.surroundings import Surroundings
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Array, Bools, Indices
from foldfab.geometry.boxes import Boxes, grown, moved, stacked

SKIN = 0.02
"""Parts may come this close to touching in the simulation, mm; the kernel measures the true gap later."""
STRIDE = 2
"""Every how many samples of a motion are looked at."""
MANY = 60
"""Chains of a unit beyond which those that stand still are not all looked at."""
SCENE = 40
"""Frames that are looked at in one go."""


def clashes(
    unit: Unit, number: Mapping[str, int], chains: tuple[Chain, ...], motion: Motion, around: Surroundings,
    thickness: Thickness,
) -> dict[tuple[str, str], float]:  # fmt: skip
    """By two owners that meet, when they first do, in the unit's own time from 0 to 1, earliest first.

    They are patch and patch, patch and something around, or what hangs on two bases. `number` gives the number of every
    base.
    """
    last = len(motion.samples) - 1
    picked = np.append(np.arange(0, last, STRIDE), last)
    own_plates = _own_plates(number, chains, around)
    met: dict[tuple[str, str], float] = {}
    for start in range(0, max(len(picked) - 1, 1), SCENE):
        frames = picked[start : start + SCENE + 1]
        moving, resting = _played(chains, motion, frames, thickness)
        shifts = np.stack([motion.shift[base][frames] for base in unit.bases], axis=1)
        still = carried(grown(around.boxes, -SKIN), shifts[:, around.group], np.arange(len(around.boxes)))
        found = itertools.chain(
            _between_chains(chains, moving, resting),
            _with_surroundings(chains, moving, still, around, own_plates),
            _with_surroundings(chains, resting, still, around, own_plates),
            _between_clusters(still, around),
        )
        for a, b, frame in found:
            time = float(motion.samples[frames[frame]])
            met[a, b] = min(met.get((a, b), 1.0), time)
    return dict(sorted(met.items(), key=lambda item: (item[1], item[0])))


def _played(
    chains: tuple[Chain, ...], motion: Motion, frames: Indices, thickness: Thickness
) -> tuple[Batch | None, Batch | None]:
    """The chains that fold in these frames, and those that are only carried along."""
    folding: dict[int, Ride] = {}
    carried_along: list[tuple[Boxes, Array, int]] = []
    touched: set[str | None] = set()
    rest: list[int] = []
    for i, chain in enumerate(chains):
        s = motion.fold[chain.patch][frames]
        if s[0] == s[-1]:
            rest.append(i)
            continue
        near = motion.shift[chain.anchor][frames]
        far = motion.shift[chain.far][frames] if chain.far is not None else None
        folding[i] = Ride(chain, s, near, far)
        touched |= {chain.anchor, chain.far}
    for i in rest:
        chain = chains[i]
        # In a unit of very many patches only those beside what folds are looked at.
        if len(chains) <= MANY or {chain.anchor, chain.far} & (touched - {None}):
            near = motion.shift[chain.anchor][frames]
            parts = [
                moved(anatomy.resting_boxes(chain, thickness, float(motion.fold[chain.patch][frames[0]])), near[0])
            ]
            parts += (
                [moved(anatomy.far_feet(chain, thickness), motion.shift[chain.far][frames[0]])] if chain.far else []
            )
            carried_along.append((stacked(parts), near - near[0], i))
    moving = _swept(folding, thickness) if folding else None
    if not carried_along:
        return moving, None
    boxes = stacked([b for b, _, _ in carried_along])
    counts = [len(b) for b, _, _ in carried_along]
    lane = np.repeat([i for _, _, i in carried_along], counts)
    shift = np.repeat(np.stack([w for _, w, _ in carried_along], axis=1), counts, axis=1)
    return moving, carried(grown(boxes, -SKIN), shift, lane)


def _swept(folding: Mapping[int, Ride], thickness: Thickness) -> Batch:
    boxes, whose = anatomy.swept_boxes(list(folding.values()), thickness)
    return batch(grown(boxes, -SKIN), np.array(list(folding))[whose])


def _between_chains(
    chains: tuple[Chain, ...], moving: Batch | None, resting: Batch | None
) -> Iterator[tuple[str, str, int]]:
    count = len(chains)
    later = np.tril(np.ones((count, count), dtype=bool))
    same = np.eye(count, dtype=bool)
    for a, b, excluded in ((moving, moving, later), (moving, resting, same), (resting, resting, later)):
        if a is None or b is None or (a is resting and moving is None):
            continue
        for i, j, frame in _first(a.lane, b.lane, meetings(a, b, excluded)):
            yield min(chains[i].patch, chains[j].patch), max(chains[i].patch, chains[j].patch), frame


def _with_surroundings(
    chains: tuple[Chain, ...], many: Batch | None, still: Batch, around: Surroundings, own_plates: Bools
) -> Iterator[tuple[str, str, int]]:
    if many is None:
        return
    for i, solid, frame in _first(many.lane, around.owner, meetings(many, still, own_plates)):
        yield chains[i].patch, around.solids[solid].owner, frame


def _between_clusters(still: Batch, around: Surroundings) -> Iterator[tuple[str, str, int]]:
    by_group = Batch(still.boxes, around.group, still.low, still.high, still.least, still.most)
    count = int(around.group.max(initial=0)) + 1
    found = meetings(by_group, by_group, np.tril(np.ones((count, count), dtype=bool)))
    for a, b, frame in _first(around.owner, around.owner, found):
        yield around.solids[a].owner, around.solids[b].owner, frame


def _first(
    first: Indices, second: Indices, found: Iterator[tuple[Indices, Indices, Indices]]
) -> Iterator[tuple[int, int, int]]:
    """What two labels (n,) and (m,) say of the boxes that meet, and the first frame in which they do."""
    count = int(second.max(initial=0)) + 1
    for frame, p, q in found:
        pairs, place = np.unique(first[p] * count + second[q], return_inverse=True)
        earliest = np.full(len(pairs), np.iinfo(np.int64).max)
        np.minimum.at(earliest, place, frame)
        yield from zip(*(many.tolist() for many in (*np.divmod(pairs, count), earliest)), strict=True)


def _own_plates(number: Mapping[str, int], chains: tuple[Chain, ...], around: Surroundings) -> Bools:
    """(chains, boxes) the plates that a chain's own hinges stand on."""
    own = np.array([[number[c.anchor], number[c.far or c.anchor]] for c in chains]).reshape(-1, 2)
    found: Bools = (own[:, :, None] == around.plate).any(1)
    return found
