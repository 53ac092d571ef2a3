"""One unit's fold played through with all its parts thick: the check that every choice has to pass.

The conflict graph looks at pairs along a nominal fold; here the chosen chains move exactly as they will, with their
plinths and windows, against everything else. What meets is reported, and the search learns from it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from foldfab.folding import anatomy
from foldfab.folding.candidates import Surroundings
from foldfab.folding.model import Chain, Thickness
from foldfab.folding.press import Motion
from foldfab.folding.space import Sweep, hits, sweep
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, grown

SKIN = 0.02
"""Parts may come this close to touching in the simulation, mm; the kernel measures the true gap later."""
STRIDE = 2
"""Every how many samples of a motion are looked at."""


def clashes(
    chains: tuple[Chain, ...], motion: Motion, around: Surroundings, thickness: Thickness
) -> Iterator[tuple[str, str]]:
    """Pairs of owners that meet: patch and patch, patch and something around, or two bases' clusters."""
    picked = np.unique(np.append(np.arange(0, len(motion.samples), STRIDE), len(motion.samples) - 1))
    movers = {c.patch: _mover(c, motion, picked, thickness) for c in chains}
    for a, b in itertools.combinations(sorted(movers), 2):
        if len(hits(movers[a], movers[b])[0]):
            yield a, b
    static = {base: _cluster(around, base, motion, picked) for base in motion.shift}
    for chain in chains:
        for _, (boxes, owners) in static.items():
            yield from _met(chain, movers[chain.patch], boxes, owners)
    for a, b in itertools.combinations(sorted(static), 2):
        _, i, j = hits(static[a][0], static[b][0])
        yield from sorted({(static[a][1][p][0], static[b][1][q][0]) for p, q in zip(i, j, strict=True)})


def _met(chain: Chain, mover: Sweep, boxes: Sweep, owners: list[tuple[str, bool]]) -> Iterator[tuple[str, str]]:
    own = {chain.anchor, chain.far}
    _, _, met = hits(mover, boxes)
    for owner, is_plate in sorted({owners[i] for i in met}):
        if not (is_plate and owner in own):
            yield chain.patch, owner


def _mover(chain: Chain, motion: Motion, picked: Array, thickness: Thickness) -> Sweep:
    """Panels, knuckles and feet of a chain over time."""
    s = motion.fold[chain.patch][picked]
    near = motion.shift[chain.anchor][picked]
    panels = anatomy.moving_boxes(chain, thickness, s)
    parts = [Boxes(panels.center + near[:, None], panels.axes, panels.half)]
    parts.append(_repeated(anatomy.anchor_feet(chain, thickness), near))
    if chain.far is not None:
        parts.append(_repeated(anatomy.far_feet(chain, thickness), motion.shift[chain.far][picked]))
    boxes = Boxes(*(np.concatenate([getattr(p, f) for p in parts], axis=1) for f in ("center", "axes", "half")))
    return sweep(grown(boxes, -SKIN), np.zeros(2))


def _cluster(around: Surroundings, base: str, motion: Motion, picked: Array) -> tuple[Sweep, list[tuple[str, bool]]]:
    """Everything that moves with one base of the unit, and whose it is."""
    keep = [i for i, s in enumerate(around.owner) if around.cluster[around.solids[s].base] == base]
    owners = [(around.solids[around.owner[i]].owner, around.solids[around.owner[i]].state == "base") for i in keep]
    return sweep(_repeated(grown(around.boxes[keep], -SKIN), motion.shift[base][picked]), np.zeros(2)), owners


def _repeated(boxes: Boxes, shift: Array) -> Boxes:
    shape = (len(shift), len(boxes))
    return Boxes(
        boxes.center + shift[:, None],
        np.broadcast_to(boxes.axes, (*shape, 3, 3)),
        np.broadcast_to(boxes.half, (*shape, 3)),
    )
