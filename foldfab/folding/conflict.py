"""The conflict graph of a unit (section 5.4, definition 5), between the options of different patches.

Two options conflict where their panels meet while both fold, where they drag the upper base along different ways
(figure 12), or, with thickness, where their accordions snap so differently that the play in their hinges cannot
cover it. Options of one patch form a clique and are never compared.
"""

from __future__ import annotations

import numpy as np

from foldfab.folding.basic import Option, windows
from foldfab.folding.candidates import Candidate, Problem
from foldfab.folding.mechanism import peak, reach
from foldfab.folding.model import Chain, Thickness
from foldfab.folding.press import play_limit
from foldfab.folding.space import conflicts, window_conflicts
from foldfab.geometry.arrays import Array, Bools

SAME_PLACE = 0.05
"""Two slanted chains drag their upper base alike where the ends differ by less, mm."""


def conflict_table(
    problem: Problem,
    unit: str,
    first: tuple[list[Candidate], list[Option]],
    second: tuple[list[Candidate], list[Option]],
) -> Bools:
    """Which options of one patch (n) conflict with which of another (m), (n, m)."""
    whole = windows(problem.options.shrink_steps)
    place = {w: i for i, w in enumerate(whole)}
    table = np.zeros((len(first[1]), len(second[1])), dtype=bool)
    rows, columns = _by_variant(first[1], place), _by_variant(second[1], place)
    for a in first[0]:
        for b in second[0]:
            if a.variant not in rows or b.variant not in columns:
                continue
            i, w = rows[a.variant]
            j, v = columns[b.variant]
            table[np.ix_(i, j)] = _pair(problem, unit, a, b)[np.ix_(w, v)]
    return table


def go_the_same_way(a: Chain, b: Chain) -> bool:
    """Whether two chains drag their bases along the same way (condition ii of section 5.2)."""
    if not _share_bases(a, b):
        return True
    if a.mechanism != b.mechanism:
        return False
    return a.mechanism == "in-place" or bool(np.abs(_way(a) - _way(b)).max() < SAME_PLACE)


def snap_alike(a: Chain, b: Chain, thickness: Thickness) -> bool:
    """Whether the play in their hinges covers the difference between the snaps of two chains."""
    if not _share_bases(a, b) or a.mechanism != "in-place" or b.mechanism != "in-place":
        return True
    return abs(peak(a)[0] - peak(b)[0]) <= play_limit(a, thickness.gap) + play_limit(b, thickness.gap)


def _share_bases(a: Chain, b: Chain) -> bool:
    return a.far is not None and {a.anchor, a.far} == {b.anchor, b.far}


def _by_variant(many: list[Option], place: dict[tuple[int, int], int]) -> dict[object, tuple[list[int], list[int]]]:
    """By variant, the positions of its options and of their windows."""
    found: dict[object, tuple[list[int], list[int]]] = {}
    for i, option in enumerate(many):
        if option.variant is not None:
            found.setdefault(option.variant, ([], []))
            found[option.variant][0].append(i)
            found[option.variant][1].append(place[option.window])
    return found


def _pair(problem: Problem, unit: str, a: Candidate, b: Candidate) -> Bools:
    """Which windows of one candidate conflict with which of the other."""
    key = (unit, a.chain.patch, a.variant, b.chain.patch, b.variant)
    if key not in problem.pairs:
        whole = windows(problem.options.shrink_steps)
        if not go_the_same_way(a.chain, b.chain) or not snap_alike(a.chain, b.chain, problem.thickness):
            problem.pairs[key] = np.ones((len(whole), len(whole)), dtype=bool)
        else:
            problem.pairs[key] = window_conflicts(conflicts(a.sweep, b.sweep), whole)
    return problem.pairs[key]


def _way(chain: Chain) -> Array:
    """(2, 3) where the far end stands open and folded, relative to the root."""
    ends = reach(chain, np.array([0.0, 1.0])) @ np.stack([chain.across, chain.rise])
    way: Array = ends - ends[0]
    return way
