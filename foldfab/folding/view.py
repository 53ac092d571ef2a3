"""What a unit sees of the furniture around it: how far its bases may come down, and all that its fold depends on."""

from __future__ import annotations

import itertools

import numpy as np

from foldfab.folding.candidates import Problem, Surroundings, clearances, held, is_slantable, seen_from
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Array, Bools

NEARLY = 0.2
"""What is unfolded and keeps bases apart by less than this share of K more than their stack is not in the way."""

Limits = dict[tuple[str, str], tuple[float, float, str]]
"""By (lower, upper) base: how far the upper cluster may come down before it meets something that lies flat, before it
meets something that is not folded yet, and the owner of the latter."""


def limits_of(problem: Problem, unit: Unit, around: Surroundings) -> Limits:
    """How far each upper cluster of the unit may come down towards each lower one."""
    found: Limits = {}
    group = np.array([unit.bases.index(around.cluster[around.solids[s].base]) for s in around.owner])
    is_open = np.array([around.solids[s].state == "open" for s in around.owner])
    for (i, a), (j, b) in itertools.combinations(enumerate(unit.bases), 2):
        p, q = np.nonzero(group == i)[0], np.nonzero(group == j)[0]
        over = (around.low[p, None, :2] < around.high[None, q, :2]).all(-1)
        over &= (around.low[None, q, :2] < around.high[p, None, :2]).all(-1)
        room = around.low[None, q, 2] - around.high[p, None, 2]
        room = np.where(over & (room > -1e-6), room, np.inf) - problem.thickness.gap
        standing = is_open[p, None] | is_open[None, q]
        flat, raised = np.where(standing, np.inf, room), np.where(standing, room, np.inf)
        owner = ""
        if np.isfinite(raised).any():
            at = np.unravel_index(int(np.argmin(raised)), raised.shape)
            blame = p[at[0]] if is_open[p[at[0]]] else q[at[1]]
            owner = around.solids[around.owner[int(blame)]].owner
        found[a, b] = (float(flat.min(initial=np.inf)), float(raised.min(initial=np.inf)), owner)
    return found


def held_up(problem: Problem, unit: Unit, limits: Limits) -> str:
    """The owner of what stands unfolded between two bases that a chain of the unit would bring together."""
    clear = clearances(problem, unit)
    for site in held(problem, unit):
        assert site.far is not None
        pair = (site.anchor, site.far)
        least = problem.thickness.stack(2, has_upper_base=True)
        if limits[pair][1] < clear[pair] - least - NEARLY * problem.thickness.panel:
            return limits[pair][2]
    return ""


def view(problem: Problem, unit: Unit, around: Surroundings, limits: Limits) -> object:
    """All of its surroundings that the fold of a unit can depend on, hashable."""
    relevant = np.zeros(len(around.owner), dtype=bool)
    base = np.array([around.cluster[around.solids[s].base] for s in around.owner])
    for name, (low, high) in seen_from(problem, unit).items():
        near = (around.low <= high).all(1) & (around.high >= low).all(1)
        relevant |= near & (base == name)
    if is_slantable(problem, unit):
        relevant |= _crossing(problem, unit, around, base)
    if problem.options.stay_in_box:
        relevant[:] = True
    labels = tuple(
        (around.solids[around.owner[i]].owner, around.solids[around.owner[i]].state) for i in np.nonzero(relevant)[0]
    )
    shape = np.round(np.concatenate([around.low[relevant], around.high[relevant]]), 4) + 0.0
    clear = clearances(problem, unit)
    numbers = tuple(
        (pair, round(min(flat, clear[pair]), 4), (round(up, 4), owner) if up < clear[pair] else None)
        for pair, (flat, up, owner) in limits.items()
    )
    place = tuple(np.round(around.offset, 4)) if problem.options.stay_in_box else None
    return (labels, shape.tobytes(), numbers, place)


def _crossing(problem: Problem, unit: Unit, around: Surroundings, base: Array) -> Bools:
    """Boxes of the upper and of the lower cluster that may meet while the unit slants."""
    reach = max(problem.sites[p].clear / np.cos(problem.sites[p].lean) for p in unit.patches)
    below, above = base == unit.bases[0], base == unit.bases[1]
    low, high = around.low[above] - reach, around.high[above] + [reach, reach, 0.0]
    near = (around.low[below][:, None] <= high[None]).all(-1) & (around.high[below][:, None] >= low[None]).all(-1)
    found = np.zeros(len(base), dtype=bool)
    found[np.nonzero(below)[0][near.any(1)]] = True
    found[np.nonzero(above)[0][near.any(0)]] = True
    return found
