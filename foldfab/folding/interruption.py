"""Hinges that are interrupted where something else folds through: which of them would make a choice cheaper.

Where only the knuckles or the feet of a patch are in the way, and its panels are not, its hinges may have knuckles
elsewhere. What that could gain is bounded by the conflict graph in which hinges that may still be interrupted are not
there at all. Where its cheapest choice counts less, the lanes that it takes in vain are made again, each with the least
stretch of knuckles that holds, in every place; until it takes none. That is exact: what is left out meets nothing less.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from foldfab.folding.basic import Option
from foldfab.folding.conflict import may_be_interrupted
from foldfab.folding.graph import Graph
from foldfab.folding.lanes import Lane
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import Prospects
from foldfab.folding.repertoire import Repertoire
from foldfab.geometry.arrays import Array

BETTER = 1e-5
"""By how much a choice must be cheaper: more than preferences between options of equal cost add up to."""


def hindered(
    problem: Problem, own: Repertoire, found: Prospects, graph: Graph, picked: tuple[int, ...] | None, offset: Array,
    chosen: Mapping[str, Option] | None = None,
) -> list[Lane]:  # fmt: skip
    """The lanes whose hinges keep a unit from a choice cheaper than the one that was picked from its graph."""
    weight = graph.weight(picked) if picked is not None else np.inf
    every = [x for many in found.lanes.values() for x in many]
    if weight <= _least(problem, found) + BETTER or not any(_is_hindered(own, found, x) for x in every):
        return []
    room = {
        x.number: found.panels.get(x.number, found.blocked[x.number])
        if may_be_interrupted(own, x)
        else found.blocked[x.number]
        for x in every
    }
    bare = Graph(problem, own, replace(found, blocked=room), offset, graph.learned, chosen, is_bare=True)
    best = bare.cheapest()
    if best is None or bare.weight(best) >= weight - BETTER:
        return []
    places = [o.place(i) for o, i in zip(graph.options, best, strict=True)]
    in_vain = {g for g, (i, cost) in enumerate(zip(best, graph.costs, strict=True)) if not np.isfinite(cost[i])}
    for pair, table in graph.tables.items():
        in_vain |= set(pair) if table[best[pair[0]], best[pair[1]]] else set()
    lanes = [place[0] for g, place in enumerate(places) if g in in_vain and place is not None]
    return [x for x in lanes if may_be_interrupted(own, x)]


def touched(own: Repertoire) -> list[Lane]:
    """The lanes whose hinges meet something of their own unit that their panels do not meet."""
    found = set[int]()
    for (a, b), pieces in own.pieces.items():
        for one, other, rows in ((a, b, pieces), (b, a, pieces.T)):
            if one not in found and may_be_interrupted(own, own.lanes[one]) and _by_hinges(own, one, other, rows):
                found.add(one)
    return [own.lanes[n] for n in sorted(found)]


def hampered(own: Repertoire, found: Prospects) -> list[Lane]:
    """The lanes whose hinges meet something around the unit that their panels do not meet."""
    every = (x for many in found.lanes.values() for x in many if may_be_interrupted(own, x))
    return [x for x in every if _is_hampered(found, x)]


def _by_hinges(own: Repertoire, one: int, other: int, pieces: Array) -> bool:
    """Whether a lane has pieces that meet another one by their hinges only; `pieces` (N_s, N_s) are all that meet."""
    firm = np.zeros_like(pieces)
    for i in range(2):
        key = (2 * one, 2 * other + i) if one < other else (2 * other + i, 2 * one)
        if key in own.parts:
            firm |= own.parts[key] if one < other else own.parts[key].T
    return bool((pieces & ~firm).any())


def _is_hindered(own: Repertoire, found: Prospects, x: Lane) -> bool:
    """Whether the hinges of a lane meet anything that its panels do not meet."""
    if not may_be_interrupted(own, x):
        return False
    return _is_hampered(found, x) or any(
        _by_hinges(own, x.number, b if a == x.number else a, pieces if a == x.number else pieces.T)
        for (a, b), pieces in own.pieces.items()
        if x.number in (a, b)
    )


def _is_hampered(found: Prospects, x: Lane) -> bool:
    panels = found.panels.get(x.number)
    return panels is not None and bool((found.blocked[x.number] & ~panels).any())


def _least(problem: Problem, found: Prospects) -> float:
    """What a choice counts at least: each patch as if nothing met anything."""
    least = 0.0
    for patch, many in found.lanes.items():
        hinges = min((x.variant.hinges for x in many), default=problem.options.max_hinges)
        least += problem.sites[patch].importance * problem.options.alpha * hinges / problem.options.max_hinges
    return least
