"""The choice of modifications and the order of units in one shot, to a proven optimum (beyond section 5.5).

What each unit costs by itself bounds any fold from below. Units whose folds reach into each other's space make groups;
where a group of the greedy solution costs more than its units by themselves, its options and its order become one
constraint program (`master`). Its cheapest proposal is played through; what then meets depends on more than a pair of
options (on the order, on where things lie folded) and is added as a cut, until a proposal holds. As the program is a
relaxation throughout, the first proposal that holds is optimal.

The limit is one of work: the deterministic time of the solver, and fixed charges for what is done besides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import fsum

import numpy as np

from foldfab.folding import basic
from foldfab.folding.aside import bring_back
from foldfab.folding.congruent import repertoire
from foldfab.folding.group import NO_MORE, Group, cut_of, posed
from foldfab.folding.options import DELETION
from foldfab.folding.ordering import Ordered, after, neighbouring
from foldfab.folding.problem import Problem
from foldfab.folding.repertoire import extend
from foldfab.folding.replay import played
from foldfab.folding.scene import Scene
from foldfab.folding.symmetry import Signature
from foldfab.folding.unit_fold import UnitFold
from foldfab.folding.work import PLAYING

BUILDING = 5e-2
"""Charge for a constraint program that is built, s."""
SHARE = 0.5
"""Share of the remaining work that one proposal may take."""


def optimal(
    problem: Problem, scene: Scene, known: Ordered | None, floor: Mapping[str, float],
    limit: float = np.inf,
) -> tuple[Ordered | None, float]:  # fmt: skip
    """The best order that was found, and what any order counts at least.

    Args:
        problem: the scaffold and its units.
        scene: the open furniture.
        known: the greedy order, if there is one.
        floor: by unit, what it counts at least by itself.
        limit: what an order has to count less than to be looked for.
    """
    if not np.isfinite(sum(floor.values())):
        # Some unit has no choice without conflicts at all, in whatever order.
        return known, np.inf
    folds = {f.unit.name: f for f in known.folds} if known else {}
    is_whole = set(folds) == set(floor)
    groups = neighbouring(problem, scene) if is_whole else [set(floor)]
    order = [f.unit.name for f in known.folds] if known else sorted(floor)
    best = _best(groups, folds) if is_whole else [_weight(known) if known else np.inf]
    settled = [_is_settled(names, b, floor, folds if is_whole else {}) for names, b in zip(groups, best, strict=True)]
    bound = fsum(_claimed(problem, g, b, floor) for g, b, done in zip(groups, best, settled, strict=True) if done)
    left = [(names, b) for names, b, done in zip(groups, best, settled, strict=True) if not done]
    rest_counts = bound + fsum(floor[n] for names, _ in left for n in names)
    for k, (names, least) in enumerate(left):
        least = min(least, limit - rest_counts + fsum(floor[n] for n in names))
        others = [folds[n] for n in order if n not in names] if is_whole else []
        group = _group(problem, scene, others, {n: floor[n] for n in names}, least)
        found, group_bound = _solved(group, problem.work.left / (len(left) - k))
        bound += _claimed(problem, names, min(group_bound, least), floor)
        if found is not None:
            rest = [n for n in order if n not in names] if is_whole else []
            folds = {**{n: folds[n] for n in rest}, **{f.unit.name: f for f in found}}
            order, is_whole = [*rest, *(f.unit.name for f in found)], True
    if not is_whole:
        return known, bound
    return Ordered(tuple(folds[n] for n in order), ()), bound


def lower_bound(problem: Problem, scene: Scene, known: Ordered, floor: Mapping[str, float]) -> float:
    """What any order counts at least: a unit that has to do with no other one cannot do better than it does."""
    folds = {f.unit.name: f for f in known.folds}
    if set(folds) != set(floor):
        return fsum(floor.values())
    groups = neighbouring(problem, scene)
    best = _best(groups, folds)
    return fsum(
        _claimed(problem, g, b, floor) if _is_settled(g, b, floor, folds) else fsum(floor[n] for n in g)
        for g, b in zip(groups, best, strict=True)
    )


def _claimed(problem: Problem, names: set[str], bound: float, floor: Mapping[str, float]) -> float:
    """What a group counts at least, given what it does over all lanes there are: there might be cheaper ones."""
    units = (problem.tree.units[n] for n in names)
    is_open = any(unit in problem.least and problem.least[unit].spare > NO_MORE for unit in units)
    return min(bound, fsum(floor[n] for n in names)) if is_open else bound


def _best(groups: list[set[str]], folds: Mapping[str, UnitFold]) -> list[float]:
    """What the known folds of each group count; sums are exact, as the order of a set differs from run to run."""
    return [fsum(folds[n].weight for n in names) for names in groups]


def _is_settled(names: set[str], best: float, floor: Mapping[str, float], folds: Mapping[str, UnitFold]) -> bool:
    """Whether nothing can be cheaper than the best known of a group; `folds` are those of all units, if there are."""
    is_single = len(names) == 1 and all(n in folds and folds[n].gap <= NO_MORE for n in names)
    return is_single or best - fsum(floor[n] for n in names) <= NO_MORE


def other(
    problem: Problem, scene: Scene, floor: Mapping[str, float], excluded: tuple[Mapping[str, Signature], ...],
    most: float, work: float,
) -> tuple[Ordered | None, float]:  # fmt: skip
    """The best order with other modifications than those excluded that counts less than `most`, and its bound."""
    group = replace(_group(problem, scene, [], dict(floor), most), excluded=excluded)
    folds, bound = _solved(group, work)
    return (Ordered(folds, ()) if folds is not None else None), bound


def _weight(known: Ordered) -> float:
    return fsum(f.weight for f in known.folds)


def _group(problem: Problem, scene: Scene, others: list[UnitFold], floor: dict[str, float], known: float) -> Group:
    spare = known - fsum(floor.values())
    for fold in others:
        scene = after(problem, scene, fold)
    units = tuple(u for u in problem.units if u.name in floor)
    for unit in units:
        own = repertoire(problem, unit)
        if spare + floor[unit.name] >= DELETION:
            bring_back(own)
        for patch in unit.patches:
            first = own.plain[patch][0].variant if own.plain[patch] else None
            while own.later[patch] and _surcharge(problem, patch, first, own.later[patch][0]) < spare:
                extend(problem, own, [patch])
    lanes = {p: repertoire(problem, u).plain[p] for u in units for p in u.patches}
    return Group(problem, scene, units, known, floor, lanes)


def _surcharge(problem: Problem, patch: str, first: basic.Variant | None, variant: basic.Variant) -> float:
    """How much more a variant costs than the first one of its patch."""
    if first is None:
        return 0.0
    more = basic.cost(variant.hinges, 1.0, problem.options) - basic.cost(first.hinges, 1.0, problem.options)
    return problem.sites[patch].importance * more


def _solved(group: Group, work: float) -> tuple[tuple[UnitFold, ...] | None, float]:
    """The cheapest folds of the group in their order, and what any folds of it count at least.

    No folds where none is cheaper than what is known, or none was found within the work.
    """
    bound, hint = sum(group.floor.values()), None
    done, until = group.problem.work, group.problem.work.spent + work
    best: tuple[UnitFold, ...] | None = None
    while done.spent < until:
        options, master = posed(group)
        done.charge(BUILDING)
        fresh, lanes = len(group.lessons), sum(map(len, group.lanes.values()))
        while done.spent < until:
            proposal, least, spent = master.solved((until - done.spent) * SHARE, hint)
            done.charge(spent)
            bound = max(bound, min(least, group.known))
            if proposal is None or least >= group.known - NO_MORE:
                return best, bound
            done.charge(PLAYING)
            folds, holds = played(group, options, proposal)
            if folds is not None and _counted(folds) < group.known - NO_MORE:
                best, group.known = folds, _counted(folds)
            if holds and folds is not None and proposal.bound >= _counted(folds) - NO_MORE:
                return best, bound
            hint = proposal
            if sum(map(len, group.lanes.values())) > lanes:
                break
            for lesson in group.lessons[fresh:]:
                master.add(cut_of(options, lesson))
            fresh = len(group.lessons)
    return best, bound


def _counted(folds: tuple[UnitFold, ...]) -> float:
    return sum(fold.weight for fold in folds)
