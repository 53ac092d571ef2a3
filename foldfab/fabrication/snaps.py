"""The snap of thick accordions: a folding chain first lifts its far base a little before it comes down (section 5.6).

An upright chain of N inserted hinges between faces H apart rises by about N²(K + g)²/2(H − K), a lock in the open
state for nothing. Chains that rise differently while they carry the same bases must share the rise, which the play in
their hinges covers, or does not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.fabrication.model import Finding
from foldfab.folding.mechanism import peak
from foldfab.folding.model import Chain, FoldSolution
from foldfab.folding.press import play_limit

NONE = 1e-6
"""A rise below this is rounding, mm."""


@dataclass(frozen=True, slots=True)
class Snap:
    """How one chain snaps through."""

    patch: str
    rise: float
    """How far it lifts its far base before that comes down, mm, as its exact motion has it."""
    estimate: float | None
    """The same by the formula, mm; None for a chain that does not start upright."""
    play: float
    """What the play in its hinges has to cover, all together, mm."""
    limit: float
    """What that play may be, mm."""


def snaps(solution: FoldSolution) -> tuple[Snap, ...]:
    """The snaps of all chains that have one, or that give way to those of others."""
    found = [_snap(solution, chain) for chain in solution.chains if chain.shape.comes_down]
    return tuple(snap for snap in found if snap.rise > NONE or snap.play > NONE)


def snap_findings(solution: FoldSolution) -> list[Finding]:
    """Fatal where a chain would have to give more than its hinges can."""
    return [
        Finding(
            "snap",
            f"{snap.patch} has to give {snap.play:.2f} mm to pass the snap of its neighbours, its hinges can give "
            f"{snap.limit:.2f} mm; give the patches beside it the same number of hinges, or print larger",
            is_fatal=True,
        )
        for snap in snaps(solution)
        if snap.play > snap.limit + NONE
    ]


def _snap(solution: FoldSolution, chain: Chain) -> Snap:
    gap, inserted = solution.thickness.gap, len(chain.lengths) - 1
    estimate = None
    if chain.lean == 0.0:
        estimate = (inserted * (chain.panel + gap)) ** 2 / (2 * float(chain.lengths.sum()))
    plays = [np.abs(step.play[chain.patch]).max() for step in solution.steps if chain.patch in step.play]
    rise = max(peak(chain)[0], 0.0)
    return Snap(chain.patch, float(rise), estimate, float(max(plays, default=0.0)), play_limit(chain, gap))
