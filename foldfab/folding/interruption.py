"""Hinges that are interrupted where something else folds through: which of them make a unit's choice cheaper.

Where only the knuckles or the feet of a patch are in the way, and its panels are not, its hinges may have knuckles
elsewhere. What that could gain is asked of the conflict graph in which such hinges have, beside each other patch, the
knuckles that suit. Where a choice of it counts less, the lanes whose hinges are in its way are made again, with a
stretch of knuckles that holds and that suits all; until a choice holds, or none is cheaper. Then they are made in every
place.

What is asked is a relaxation, so that its answers bound any such choice. Where the work ends first, its last answer is
what the unit counts at least.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from foldfab.folding.basic import WHOLE
from foldfab.folding.choose import EPSILON, cheaper
from foldfab.folding.conflict import are_in_the_way, compare, may_be_interrupted
from foldfab.folding.graph import Graph
from foldfab.folding.lanes import Lane
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import unhindered
from foldfab.folding.repertoire import Place, Repertoire, Stretch, interrupt, lane, pieces_met, stretches
from foldfab.folding.work import Work

WORTH = 2e-3
"""By how much a choice must be cheaper to be worth the lanes that it takes."""
ROUNDS = 8
"""How many choices are tried for a unit before it is left as it is."""
ENOUGH = 0.5
"""Work after which it is left as it is, s."""


def interrupted(
    problem: Problem, own: Repertoire, graph: Graph, picked: tuple[int, ...] | None
) -> tuple[bool, float]:  # fmt: skip
    """Adds the lanes by which a unit has a cheaper choice than was picked from its graph; whether there are any, and
    what any choice of such lanes counts at least, if that is worth it and was not found out to the end.
    """
    weight = graph.weight(picked) if picked is not None else np.inf
    least = _least(problem, own)
    if graph.modes or weight <= least + WORTH or not are_in_the_way(own):
        return False, np.inf
    before, work, floor = dict(own.plain), Work(ENOUGH), least
    vain: list[Mapping[str, Place]] = []
    for _ in range(ROUNDS):
        bare = _bare(problem, own, vain)
        best, least = bare.cheaper(weight - WORTH, work)
        floor = max(floor, least)
        if best is None:
            break
        places = {o.patch: o.place(i) for o, i in zip(bare.options, best, strict=True)}
        chosen = {p: place for p, place in places.items() if place is not None}
        agreed = _agreeing(problem, own, chosen) if _are_hindered(own, chosen) else {}
        made = chosen | _made(problem, own, chosen, agreed)
        if not _are_hindered(own, made):
            _settle(problem, own, made, before)
            return True, floor if floor < bare.weight(best) - EPSILON else np.inf
        vain += [chosen] if not agreed else []
    own.plain.update(before)
    own.interrupted.clear()
    return False, floor if floor < weight - WORTH - EPSILON else np.inf


def _bare(problem: Problem, own: Repertoire, vain: Sequence[Mapping[str, Place]]) -> Graph:
    """The conflict graph in which hinges may be interrupted, without choices that were tried in vain."""
    bare = Graph(problem, own, unhindered(problem, own), np.zeros(3), is_bare=True)
    for many in vain:
        places = ((g, many.get(o.patch)) for g, o in enumerate(bare.options))
        bare.forbidden.add(tuple((g, (bare.options[g].index(place),)) for g, place in places))
    return bare


def _made(
    problem: Problem, own: Repertoire, chosen: Mapping[str, Place], agreed: Mapping[str, Stretch]
) -> dict[str, Place]:
    """The lanes that a choice takes instead where hinges keep their knuckles as agreed."""
    made: dict[str, Place] = {}
    for patch, (first, end) in agreed.items():
        x, window = chosen[patch]
        interrupt(problem, own, x, [(first, end)])
        steps = problem.options.shrink_steps
        found = lane(problem, own, patch, replace(x.variant, hinged=(first / steps, end / steps)))
        if found is not None and found in own.plain[patch]:
            made[patch] = found, window
    compare(problem, own, [x for x, _ in made.values()])
    return made


def _settle(
    problem: Problem, own: Repertoire, chosen: Mapping[str, Place], before: Mapping[str, tuple[Lane, ...]]
) -> None:
    """Keeps the lanes of those patches only whose hinges a choice interrupts, but of these in every place."""
    cut = {p for p, (x, _) in chosen.items() if x.variant.hinged != WHOLE}
    own.plain.update({p: many for p, many in before.items() if p not in cut})
    own.interrupted.intersection_update(x.number for x in own.lanes if x.patch in cut)
    for number in sorted(own.interrupted):
        interrupt(problem, own, own.lanes[number], stretches(problem, own, own.lanes[number]))


def _are_hindered(own: Repertoire, chosen: Mapping[str, Place]) -> bool:
    """Whether anything of a choice meets, knuckles and feet included."""
    for (x, a), (y, b) in itertools.combinations(chosen.values(), 2):
        pieces = pieces_met(own.pieces, x.number, y.number)
        if pieces is not None and pieces[slice(*a), slice(*b)].any():
            return True
    return False


def _agreeing(problem: Problem, own: Repertoire, chosen: Mapping[str, Place]) -> dict[str, Stretch]:
    """By patch whose hinges must be interrupted in a choice in which no panels meet, where they keep their knuckles.

    As few as possible; none where they cannot, as far as longer panels do not matter.
    """
    loose = [p for p, (x, _) in chosen.items() if may_be_interrupted(own, x)]
    hinges = [2 * chosen[p][0].number + 1 for p in loose]
    able = [_able(problem, own, chosen, set(loose), p) for p in loose]
    if not all(able):
        return {}
    tables = {}
    for g, h in itertools.combinations(range(len(loose)), 2):
        if pieces_met(own.parts, hinges[g], hinges[h]) is not None:
            tables[g, h] = np.array([[_meet(own, hinges[g], s, hinges[h], t) for t in able[h]] for s in able[g]])
    costs = [np.array([float(s != chosen[p][1]) for s in own_able]) for p, own_able in zip(loose, able, strict=True)]
    best = cheaper(costs, tables, frozenset(), np.inf)[0] or ()
    return {p: many[i] for p, many, cost, i in zip(loose, able, costs, best, strict=False) if cost[i]}


def _able(problem: Problem, own: Repertoire, chosen: Mapping[str, Place], loose: set[str], patch: str) -> list[Stretch]:
    """Where a patch may have knuckles beside all that stays: everywhere in its window, or in a stretch of it."""
    x, window = chosen[patch]
    stays = [(2 * y.number + j, w) for q, (y, w) in chosen.items() if q != patch for j in range(1 if q in loose else 2)]
    within = [s for s in stretches(problem, own, x) if window[0] <= s[0] and s[1] <= window[1]]
    return [s for s in (window, *within) if not any(_meet(own, 2 * x.number + 1, s, *part) for part in stays)]


def _meet(own: Repertoire, one: int, first: Stretch, two: int, second: Stretch) -> bool:
    """Whether two parts of lanes, told apart, meet within some pieces."""
    table = pieces_met(own.parts, one, two)
    return table is not None and bool(table[slice(*first), slice(*second)].any())


def _least(problem: Problem, own: Repertoire) -> float:
    """What a choice counts at least: each patch as if nothing met anything."""
    least = 0.0
    for patch, many in own.plain.items():
        hinges = min((x.variant.hinges for x in many), default=problem.options.max_hinges)
        least += problem.sites[patch].importance * problem.options.alpha * hinges / problem.options.max_hinges
    return least
