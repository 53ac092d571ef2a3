"""Foldabilization of one unit at a given moment: the inner loop (sections 5.4 and 5.5).

The cheapest conflict-free choice is made real: bases are lowered by the longest paths, chains get the plinths they
lack, and the fold is simulated. What then meets is added to the conflicts and the choice is made anew, until it holds.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from foldfab.folding.basic import Option
from foldfab.folding.candidates import Candidate, Problem, Surroundings, candidates, options, surroundings
from foldfab.folding.choose import Combination, cheapest, undominated
from foldfab.folding.conflict import conflict_table
from foldfab.folding.model import Chain
from foldfab.folding.press import Motion
from foldfab.folding.realise import Clash, realised
from foldfab.folding.scene import Scene
from foldfab.folding.units import Unit
from foldfab.folding.view import Limits, held_up, limits_of, view
from foldfab.geometry.arrays import Array, Bools

ROUNDS = 60
"""Choices that are tried for one unit before it counts as not foldable at this moment."""

Priced = Mapping[str, list[tuple[Option, float]]]
"""By patch, its options and what each counts in the search."""


@dataclass(frozen=True, slots=True, eq=False)
class UnitFold:
    """A folding solution F_U of a unit (eq. 4) in its surroundings."""

    unit: Unit
    chosen: dict[str, Option]
    """By patch."""
    reasons: dict[str, str]
    """By patch that was changed, why."""
    chains: tuple[Chain, ...]
    motion: Motion
    cluster: dict[str, str]
    """By base of the furniture, the unit's base that it moves with."""
    cost: float
    """Sum of its terms of eq. 1."""
    weight: float
    """What the search minimises: the cost, with deletions counted many times."""


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a unit cannot fold at this moment."""

    unit: Unit
    reason: str


def fold_unit(
    problem: Problem, scene: Scene, unit: Unit, *, in_place: bool = False, is_final: bool = False
) -> UnitFold | Refusal:
    """The cheapest valid folding solution of a unit in the scene, or why there is none.

    A solution is found once for all scenes that look the same from the unit. Where it has been carried to decides
    only between options of equal cost, and is looked at only where the fold `is_final`.
    """
    around = surroundings(problem, scene, unit)
    limits = limits_of(problem, unit, around)
    offset = np.round(scene.offset[unit.bases[0]], 3)
    gone = frozenset(p for u in scene.units if u.name in scene.done for p in u.patches if p not in scene.chains)
    key = (unit, in_place, tuple(offset) if is_final else None, gone, view(problem, unit, around, limits))
    if key not in problem.solved:
        problem.solved[key] = _fold(problem, scene, unit, around, limits, in_place=in_place)
    found: UnitFold | Refusal = problem.solved[key]
    return found


def _fold(
    problem: Problem, scene: Scene, unit: Unit, around: Surroundings, limits: Limits, *, in_place: bool
) -> UnitFold | Refusal:
    standing = held_up(problem, unit, limits)
    if standing:
        return Refusal(unit, f"{standing} stands in the way unfolded")
    found = candidates(problem, unit, around, in_place=in_place)
    offset = scene.offset[unit.bases[0]]
    priced = {p: options(problem, problem.sites[p], found[p], offset) for p in unit.patches}
    costs = [np.array([cost for _, cost in priced[p]]) for p in unit.patches]
    table = _tables(problem, unit, found, priced)
    forbidden: set[Combination] = set()
    worth = [undominated(g, costs, table, frozenset()) for g in range(len(costs))]
    short = [p for p in unit.patches if not found[p]]
    last = "no combination of options is free of conflicts"
    if short:
        last = f"{', '.join(short[:3])} is too short or too steep for hinges at this scale; print larger or thinner"
    for _ in range(ROUNDS):
        picked = cheapest(costs, table, frozenset(forbidden), worth)
        if picked is None:
            break
        chosen = {p: priced[p][i][0] for p, i in zip(unit.patches, picked, strict=True)}
        result = realised(problem, scene, unit, around, limits, chosen)
        if not isinstance(result, Clash):
            reasons = _reasons(problem, found, chosen)
            cost = sum(o.cost for o in chosen.values())
            weight = sum(priced[p][i][1] for p, i in zip(unit.patches, picked, strict=True))
            return UnitFold(unit, chosen, reasons, *result, around.cluster, cost, weight)
        last = last if short else result.reason
        for g in _learn(unit, priced, picked, result, costs, table, forbidden):
            worth[g] = undominated(g, costs, table, frozenset(forbidden))
    return Refusal(unit, last)


def _tables(
    problem: Problem, unit: Unit, found: Mapping[str, list[Candidate]], priced: Priced
) -> dict[tuple[int, int], Bools]:
    key = "/".join(unit.patches)
    made = {}
    for (g, a), (h, b) in itertools.combinations(enumerate(unit.patches), 2):
        first, second = ((found[p], [o for o, _ in priced[p]]) for p in (a, b))
        made[g, h] = conflict_table(problem, key, first, second)
    return made


def _learn(
    unit: Unit, priced: Priced, picked: tuple[int, ...], clash: Clash, costs: list[Array],
    table: dict[tuple[int, int], Bools], forbidden: set[Combination],
) -> set[int]:  # fmt: skip
    """Adds what a simulation found to the conflicts, and returns the patches (by number) whose options it concerns.

    What is too wide for its neighbours is so when it is still wider.
    """
    concerned: set[int] = set()
    for patches in clash.patches:
        groups = sorted(unit.patches.index(p) for p in patches)
        concerned |= set(groups)
        alike = [_alike(priced[unit.patches[g]], picked[g], clash) for g in groups]
        if len(groups) == 1:
            costs[groups[0]][alike[0]] = np.inf
        elif len(groups) == 2:
            table[groups[0], groups[1]][np.ix_(alike[0], alike[1])] = True
        else:
            forbidden.add(tuple((g, picked[g]) for g in groups))
    return concerned


def _alike(many: list[tuple[Option, float]], index: int, clash: Clash) -> list[int]:
    """The options of a patch that a clash of the one at `index` rules out as well."""
    own = many[index][0]
    if clash.holds_for == "this" or own.variant is None:
        return [index]
    low, high = own.window if clash.holds_for == "wider windows" else (np.inf, -np.inf)
    return [
        i for i, (o, _) in enumerate(many) if o.variant == own.variant and o.window[0] <= low and o.window[1] >= high
    ]


def _reasons(problem: Problem, found: Mapping[str, list[Candidate]], chosen: Mapping[str, Option]) -> dict[str, str]:
    """Why each changed patch had to be changed: what its whole, unsplit self would meet."""
    reasons = {}
    for patch, option in chosen.items():
        if option.variant is not None and option.cost == 0.0:
            continue
        obstacles = {name for c in found[patch] for name in c.obstacles if _is_like(c, option)}
        if obstacles:
            reasons[patch] = "because of " + ", ".join(sorted(obstacles)[:3])
        elif option.variant is None or option.window != (0, problem.options.shrink_steps):
            others = sorted(p for p in chosen if p != patch and chosen[p].variant is not None)
            reasons[patch] = "to let " + ", ".join(others[:3]) + " fold through it" if others else ""
        else:
            reasons[patch] = "to come straight down"
    return reasons


def _is_like(candidate: Candidate, option: Option) -> bool:
    return option.variant is None or (candidate.variant.hinges, candidate.variant.side) == (
        option.variant.hinges,
        option.variant.side,
    )
