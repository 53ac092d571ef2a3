"""The order in which the units fold: greedy with one-step look-ahead (section 5.5, figure 14).

At each step the unit is taken that minimises C1 + C2: its own cost now, plus the costs of all the others if it were
folded. Where no unit can fold, the remaining ones are merged into one and fold in place.

What a unit can do alone bounds its cost from below. So only those others are solved anew in the look-ahead that would
see the unit folded, and the look-ahead ends where no other unit can be better. With k units that see each other and n
in all this takes O(n k) solutions where costs stay at their bounds, and O(n²) of the paper's at worst.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from foldfab.folding.problem import Problem
from foldfab.folding.repertoire import repertoire
from foldfab.folding.scene import Scene, advanced, alone
from foldfab.folding.surroundings import depends_on, look
from foldfab.folding.unit_fold import Refusal, UnitFold, fold_seen, fold_unit, least_weight
from foldfab.folding.units import Unit, merged
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import near_pairs

REFUSED = 1e3
"""What a unit that cannot fold counts in the look-ahead: more than any cost."""
DIGITS = 9
"""Outlooks that agree to this many digits are the same."""


@dataclass(frozen=True, slots=True, eq=False)
class Ordered:
    """The folds of all units in their order, or the refusals where it ends."""

    folds: tuple[UnitFold, ...]
    refusals: tuple[Refusal, ...]


@dataclass(slots=True, eq=False)
class _State:
    """Where the greedy order has come to."""

    problem: Problem
    scene: Scene
    floor: Mapping[str, float]
    """By unit, what it costs at least."""
    rest: dict[str, Unit]
    beside: Mapping[str, set[str]]
    """By unit, those whose folds reach into the space of its own."""
    now: dict[str, UnitFold | Refusal] = field(default_factory=dict)
    """What each remaining unit would do now."""
    keys: dict[str, object] = field(default_factory=dict)
    """By remaining unit, what it saw when that was found."""
    sees: dict[str, set[str]] = field(default_factory=dict)
    """By remaining unit, those whose folding may change what it does."""
    seen_by: dict[str, set[str]] = field(default_factory=dict)
    """The same the other way round."""


def floors(problem: Problem) -> dict[str, float]:
    """By unit, what its cheapest choice without conflicts counts in the search, whatever stands around it."""
    return {u.name: least_weight(problem, repertoire(problem, u)) for u in problem.units}


def tight_floors(problem: Problem, scene: Scene) -> dict[str, float]:
    """By unit, what it counts where it is all alone and is played through: no order lets it fold for less."""
    return {u.name: _weight(fold_unit(problem, alone(scene, u), u)) for u in problem.units}


def greedy(problem: Problem, scene: Scene, floor: Mapping[str, float]) -> Ordered:
    """Folds all units of the open scene one after another; `floor` is what each costs at least."""
    state = _State(problem, scene, floor, {u.name: u for u in problem.units}, _beside(problem))
    for unit in problem.units:
        _look_again(state, unit)
    folds: list[UnitFold] = []
    while state.rest:
        best = _best(state)
        if best is None:
            return _merged(state, folds)
        if not _still_holds(state, best):
            continue
        best = _final(state, best)
        folds.append(best)
        state.scene = after(problem, state.scene, best)
        del state.rest[best.unit.name]
        for name in sorted(state.seen_by.get(best.unit.name, ())):
            if name in state.rest:
                _look_again(state, state.rest[name])
    return Ordered(tuple(folds), ())


def after(problem: Problem, scene: Scene, fold: UnitFold) -> Scene:
    """The scene once the unit lies folded; the furniture's lowest base stays where it is."""
    ends = np.array([fold.motion.shift[b][-1] for b in fold.unit.bases])[fold.cluster]
    return advanced(scene, fold.unit, fold.chains, ends - ends[0])


def travel(problem: Problem, fold: UnitFold) -> dict[str, Array]:
    """By base that moves, (k, 3) how it does while the furniture's lowest base stays where it is, mm."""
    ways = [fold.motion.shift[b] for b in fold.unit.bases]
    root = ways[int(fold.cluster[0])]
    moving = {i: way - root for i, way in enumerate(ways) if np.abs(way - root).max() > 0}
    return {
        b.name: moving[int(k)] for b, k in zip(problem.scaffold.bases, fold.cluster, strict=True) if int(k) in moving
    }


def _weight(fold: UnitFold | Refusal) -> float:
    return fold.weight if isinstance(fold, UnitFold) else REFUSED


def _look_again(state: _State, unit: Unit) -> None:
    own = repertoire(state.problem, unit)
    around = look(state.problem, state.scene, own)
    state.now[unit.name] = fold_seen(state.problem, state.scene, own, around)
    state.keys[unit.name] = around.key
    for name in state.sees.get(unit.name, ()):
        state.seen_by[name].discard(unit.name)
    state.sees[unit.name] = depends_on(state.problem, unit, around) | state.beside[unit.name]
    for name in state.sees[unit.name]:
        state.seen_by.setdefault(name, set()).add(unit.name)


def _still_holds(state: _State, fold: UnitFold) -> bool:
    """Whether the unit sees what it saw when its fold was found; where something has come near, it looks again."""
    unit = fold.unit
    if look(state.problem, state.scene, repertoire(state.problem, unit)).key == state.keys[unit.name]:
        return True
    _look_again(state, unit)
    return False


def _beside(problem: Problem) -> dict[str, set[str]]:
    names = [u.name for u in problem.units]
    lanes = [repertoire(problem, u).lanes for u in problem.units]
    low = np.array([np.min([x.low for x in many], 0) if many else np.full(3, np.inf) for many in lanes])
    high = np.array([np.max([x.high for x in many], 0) if many else np.full(3, -np.inf) for many in lanes])
    found: dict[str, set[str]] = {name: set() for name in names}
    for i, j in zip(*near_pairs((low, high), (low, high)), strict=True):
        if i != j:
            found[names[i]].add(names[j])
    return found


def _best(state: _State) -> UnitFold | None:
    """The fold with the least C1 + C2, by name where several have."""
    able = {n: f for n in sorted(state.rest) if isinstance(f := state.now[n], UnitFold)}
    excess = {n: e for n in state.rest if (e := _weight(state.now[n]) - state.floor[n]) > 0}
    hopes = dict.fromkeys(able, 0.0)
    for name in excess:
        for other in state.sees[name]:
            if other in hopes and other != name:
                hopes[other] -= excess[name]
    best: tuple[float, str] | None = None
    for name in sorted(able, key=lambda n: (round(hopes[n], DIGITS), n)):
        if best is not None and best <= (round(hopes[name], DIGITS), name):
            break
        change = round(_change(state, able[name]), DIGITS)
        best = min(best, (change, name)) if best is not None else (change, name)
    return able[best[1]] if best is not None else None


def _change(state: _State, fold: UnitFold) -> float:
    """By how much the others' costs change where this unit folds now."""
    then = after(state.problem, state.scene, fold)
    total = 0.0
    for name in sorted(state.seen_by.get(fold.unit.name, ())):
        if name in state.rest and name != fold.unit.name:
            total += _weight(fold_unit(state.problem, then, state.rest[name])) - _weight(state.now[name])
    return total


def _final(state: _State, fold: UnitFold) -> UnitFold:
    """The fold as the furniture stands now: what looked the same may differ in what sticks out of the outline."""
    own = repertoire(state.problem, fold.unit)
    slants = any(o.variant is not None and o.variant.mechanism == "slanted" for o in fold.chosen.values())
    if not slants or not state.scene.moved(fold.unit.bases[0]).any():
        return fold
    around = look(state.problem, state.scene, own)
    final = fold_seen(state.problem, state.scene, own, around, is_final=True)
    return final if isinstance(final, UnitFold) else fold


def _merged(state: _State, folds: list[UnitFold]) -> Ordered:
    refusals = [r for r in state.now.values() if isinstance(r, Refusal) and r.unit.name in state.rest]
    if len(refusals) == 1:
        return Ordered(tuple(folds), tuple(refusals))
    whole = merged(state.problem.scaffold, tuple(state.rest.values()))
    fold = fold_unit(state.problem, state.scene, whole, in_place=True)
    if isinstance(fold, Refusal):
        return Ordered(tuple(folds), (*refusals, fold))
    return Ordered((*folds, fold), ())
