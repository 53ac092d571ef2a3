"""The nominal fold of a unit: how its bases would come down if every chain were light (section 5.4, figure 11a).

The conflict graph is drawn along it, before anything is chosen. The time of the unit falls into sections, from the
start of one base to the start of the next; each has the same number of frames, the first of which are for the snap of
the accordions that start there.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from foldfab.folding import press
from foldfab.folding.problem import Problem, clear_height, clearances, held, levels
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Array, Bools, handed

CLIMB = 3
"""Instants at the start of each section at which thick accordions snap, while the bases wait."""
FRAMES = 17 + CLIMB
"""Instants of each section at which clashes are looked for."""


@dataclass(frozen=True, slots=True, eq=False)
class Nominal:
    """How the bases of a unit come down, by section."""

    down: Mapping[str, Array]
    """By base, (sections, FRAMES) translation along Z, mm; without the frames to snap where no base comes down."""

    @property
    def sections(self) -> int:
        """How many sections there are."""
        return len(next(iter(self.down.values())))


def nominal(problem: Problem, unit: Unit) -> Nominal:
    """The nominal fold of a unit; a unit of T-scaffolds has one section in which its base stands still."""
    clear = clearances(problem, unit)
    least = {**_plates_apart(problem, unit), **{pair: _least_stack(problem, unit, pair) for pair in clear}}
    heights = {pair: clear_height(problem, *pair) for pair in least}
    way = press.ways(unit.bases, least, heights, levels(problem, unit))
    marks = sorted({round(w, 6) for w in way.values()} | {0.0}, reverse=True)
    if not clear or len(marks) == 1:
        return Nominal({b: np.zeros((1, FRAMES - CLIMB)) for b in unit.bases})
    turn = np.append(np.zeros(CLIMB), 1 - np.cos(np.linspace(0.0, np.pi / 2, FRAMES - CLIMB)))
    level = np.array([a + (b - a) * turn for a, b in itertools.pairwise(marks)])
    return Nominal({b: np.minimum(level, way[b]) - way[b] for b in unit.bases})


@cache
def evenly(sections: int, frames: int) -> Array:
    """Progress (sections, frames) of a chain that folds evenly, and waits where others snap."""
    moving = FRAMES - CLIMB
    found = np.linspace(0.0, 1.0, sections * moving).reshape(sections, moving)
    return handed(np.concatenate([np.repeat(found[:, :1], frames - moving, axis=1), found], axis=1))


def snapped(progress: Array) -> Array:
    """Progress (sections, FRAMES) of a chain that is past its snap wherever it is open, with the snap before its start.

    All chains that start together climb together, each to its own snap.
    """
    found = progress.copy()
    for section in found:
        if section[-1] > section[0]:
            section[:CLIMB] = np.linspace(0.0, section[0], CLIMB + 1)[:-1]
            break
    return found


def _least_stack(problem: Problem, unit: Unit, pair: tuple[str, str]) -> float:
    """How high the chains between two bases are at least when folded, mm."""
    panel = min(site.panel for site in held(problem, unit) if (site.anchor, site.far) == pair)
    return problem.thickness.of(panel).stack(2, has_upper_base=True)


def _plates_apart(problem: Problem, unit: Unit) -> dict[tuple[str, str], float]:
    """By (lower, upper) base that lie over one another, the gap that remains between them."""
    low, high = (np.array([problem.plates[b][end][:2] for b in unit.bases]) for end in (0, 1))
    over: Bools = (np.maximum(low[:, None], low) < np.minimum(high[:, None], high)).all(-1)
    pairs = itertools.combinations(range(len(unit.bases)), 2)
    return {(unit.bases[i], unit.bases[j]): problem.thickness.gap for i, j in pairs if over[i, j]}
