"""The order in which the units fold: greedy with one-step look-ahead (section 5.5, figure 14).

At each step the unit is taken that minimises C1 + C2: its own cost now, plus the costs of all the others if it were
folded. Where no unit can fold, the remaining ones are merged into one and fold in place. Quadratic in the units for
each step; solutions are kept and used again while nothing about their surroundings has changed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.folding.candidates import Problem
from foldfab.folding.scene import Scene, advanced
from foldfab.folding.unit_fold import Refusal, UnitFold, fold_unit
from foldfab.folding.units import Unit, merged
from foldfab.geometry.arrays import Array

REFUSED = 1e3
"""What a unit that cannot fold counts in the look-ahead: more than any cost."""

Memory = dict[tuple[str, frozenset[object]], UnitFold | Refusal]
"""Solutions by unit and history of the scene."""


@dataclass(frozen=True, slots=True, eq=False)
class Ordered:
    """The folds of all units in their order, or the refusals where it ends."""

    folds: tuple[UnitFold, ...]
    refusals: tuple[Refusal, ...]
    scene: Scene


def greedy(problem: Problem, scene: Scene) -> Ordered:
    """Folds all units of the scene one after another."""
    rest = list(scene.units)
    folds: list[UnitFold] = []
    memory: Memory = {}
    while rest:
        now = {u.name: _solved(problem, scene, u, memory) for u in rest}
        able = [f for f in now.values() if isinstance(f, UnitFold)]
        if not able:
            return _merged(problem, scene, rest, folds, [r for r in now.values() if isinstance(r, Refusal)])
        best = _best(problem, scene, able, rest, memory)
        if any(o.variant is not None and o.variant.mechanism == "slanted" for o in best.chosen.values()):
            final = fold_unit(problem, scene, best.unit, is_final=True)
            best = final if isinstance(final, UnitFold) else best
        folds.append(best)
        scene = _after(scene, best)
        rest = [u for u in rest if u.name != best.unit.name]
    return Ordered(tuple(folds), (), scene)


def travel(fold: UnitFold, scene: Scene) -> dict[str, Array]:
    """By base, (k, 3) how it moves during the fold if the furniture's lowest base stays where it is, mm."""
    root = fold.motion.shift[fold.cluster[scene.scaffold.bases[0].name]]
    return {base: fold.motion.shift[fold.cluster[base]] - root for base in scene.offset}


def last_travel(fold: UnitFold, scene: Scene) -> dict[str, Array]:
    """By base, (3,) how far it has moved after the fold, mm."""
    return {base: way[-1] for base, way in travel(fold, scene).items()}


def _best(problem: Problem, scene: Scene, able: list[UnitFold], rest: list[Unit], memory: Memory) -> UnitFold:
    """The unit with the least C1 + C2, by name where several have."""
    if len(able) == 1:
        return able[0]
    return min(able, key=lambda f: (_outlook(problem, scene, f, rest, memory), f.unit.name))


def _after(scene: Scene, fold: UnitFold) -> Scene:
    choice = (fold.unit.name, *((p, fold.chosen[p]) for p in sorted(fold.chosen)))
    return advanced(scene, fold.unit, fold.chains, last_travel(fold, scene), choice)


def _solved(problem: Problem, scene: Scene, unit: Unit, memory: Memory) -> UnitFold | Refusal:
    key = (unit.name, scene.history)
    if key not in memory:
        memory[key] = fold_unit(problem, scene, unit)
    return memory[key]


def _outlook(
    problem: Problem, scene: Scene, fold: UnitFold, rest: list[Unit],
    memory: Memory,
) -> float:  # fmt: skip
    """C1 + C2 of folding this unit now."""
    after = _after(scene, fold)
    total = fold.weight
    for unit in rest:
        if unit.name != fold.unit.name:
            later = _solved(problem, after, unit, memory)
            total += later.weight if isinstance(later, UnitFold) else REFUSED
    return float(np.round(total, 9))


def _merged(
    problem: Problem, scene: Scene, rest: list[Unit], folds: list[UnitFold], refusals: list[Refusal]
) -> Ordered:
    whole = merged(scene.scaffold, tuple(rest))
    fold = fold_unit(problem, scene, whole, in_place=True) if len(rest) > 1 else refusals[0]
    if isinstance(fold, Refusal):
        return Ordered(tuple(folds), (*refusals, fold) if len(rest) > 1 else (fold,), scene)
    folds.append(fold)
    return Ordered(tuple(folds), (), _after(scene, fold))
