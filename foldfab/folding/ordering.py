"""The order in which the units fold: greedy with one-step look-ahead (section 5.5, figure 14).

At each step the unit is taken that minimises C1 + C2: its own cost now, plus the costs of all the others if it were
folded; of units that count the same the lowest. Where no unit can fold, the remaining ones are merged into one and fold
in place.

What a unit can do alone bounds its cost from below. So only those others are solved anew in the look-ahead that would
see the unit folded, and the look-ahead ends where no other unit can be better. With k units that see each other and n
in all this takes O(n k) solutions where costs stay at their bounds, and O(n²) of the paper's at worst.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import networkx as nx
import numpy as np

from foldfab.folding.congruent import repertoire
from foldfab.folding.problem import Problem
from foldfab.folding.scene import Scene, advanced
from foldfab.folding.surroundings import Surroundings, depends_on, look
from foldfab.folding.symmetry import bound
from foldfab.folding.unit_fold import (
    Choice,
    Refusal,
    UnitFold,
    estimated,
    fold_alone,
    fold_seen,
    fold_unit,
    has_room,
    is_solved,
    least_choice,
)
from foldfab.folding.units import Unit, merged
from foldfab.folding.work import PLAYING
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import near_pairs

REFUSED = 1e3
"""What a unit that cannot fold counts in the look-ahead: more than any cost."""
DIGITS = 5
"""Outlooks that agree to this many digits are the same: preferences between options of equal cost count no more."""


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
    floor: Mapping[str, Choice]
    """By unit, its cheapest choice without conflicts."""
    beside: Mapping[str, set[str]]
    """By unit, those whose folds reach into the space of its own."""
    place: Mapping[str, int]
    """By unit, how many have lower bases; what lies flat first is in the way of nothing above."""
    rest: dict[str, Unit]
    """The units that are not folded yet, those with the lowest bases first."""
    guess: dict[str, float] = field(default_factory=dict)
    """By remaining unit, what folding it now would count: exact, or at least not too much."""
    waits: dict[str, set[str]] = field(default_factory=dict)
    """By remaining unit, those that stand between its bases and have to fold first."""
    sees: dict[str, set[str]] = field(default_factory=dict)
    """By remaining unit, those whose folding may change that."""
    seen_by: dict[str, set[str]] = field(default_factory=dict)
    """The same the other way round."""
    ahead: dict[UnitFold, Scene] = field(default_factory=dict)
    """The scenes that the look-ahead of this step has made, by the fold that leads to them."""


def floors(problem: Problem) -> dict[str, Choice]:
    """By unit, its cheapest choice without conflicts, whatever stands around it: no order lets it fold for less."""
    return {u.name: least_choice(problem, repertoire(problem, u)) for u in problem.units}


def greedy(problem: Problem, scene: Scene, floor: Mapping[str, Choice]) -> Ordered:
    """Folds all units of the open scene one after another; `floor` is the cheapest choice of each."""
    place = places(problem)
    rest = {u.name: u for u in sorted(problem.units, key=lambda u: place[u.name])}
    state = _State(problem, scene, floor, _beside(problem), place, rest)
    for unit in problem.units:
        _look_again(state, unit)
    folds: list[UnitFold] = []
    while state.rest:
        name = _best(state)
        if name is None:
            return _merged(state, folds)
        best = _folded(state, name)
        if best is None:
            continue
        folds.append(best)
        del state.rest[name]
        if not state.rest:
            break
        state.scene = _then(state, best)
        state.ahead.clear()
        for other in sorted(state.seen_by.get(name, ())):
            if other in state.rest:
                _look_again(state, state.rest[other])
    return Ordered(tuple(folds), ())


def after(problem: Problem, scene: Scene, fold: UnitFold) -> Scene:
    """The scene once the unit lies folded; the furniture's lowest base stays where it is."""
    ends = np.array([fold.motion.shift[b][-1] for b in fold.unit.bases])[fold.cluster]
    return advanced(scene, fold.unit, fold.chosen, fold.chains, ends - ends[0])


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
    state.guess[unit.name] = _guessed(state, state.scene, unit, around)
    state.waits[unit.name] = {state.problem.unit_of[p].name for p in around.standing}
    for name in state.sees.get(unit.name, ()):
        state.seen_by[name].discard(unit.name)
    twins = {state.problem.unit_of[t.patch].name for p in unit.patches if (t := state.problem.twins.get(p))}
    state.sees[unit.name] = depends_on(state.problem, unit, around) | state.beside[unit.name] | twins - {unit.name}
    for name in state.sees[unit.name]:
        state.seen_by.setdefault(name, set()).add(unit.name)


def _guessed(state: _State, scene: Scene, unit: Unit, around: Surroundings) -> float:
    """What a unit counts where it has looked around: that of its cheapest choice while nothing is in its way."""
    own, cheapest = repertoire(state.problem, unit), state.floor[unit.name]
    is_free = not any(bound(state.problem, scene.chosen, patch) for patch in unit.patches)
    if is_free and not is_solved(state.problem, around) and has_room(state.problem, own, around, cheapest):
        return cheapest.weight
    return min(estimated(state.problem, scene, own, around), REFUSED)


def _folded(state: _State, name: str) -> UnitFold | None:
    """The fold of a unit as the furniture stands now, or None where it counts more than was guessed."""
    own = repertoire(state.problem, state.rest[name])
    around = look(state.problem, state.scene, own)
    fold = fold_seen(state.problem, state.scene, own, around)
    if isinstance(fold, Refusal) and not around.standing and own.unit not in state.problem.hopeless:
        fold_alone(state.problem, state.scene, own.unit)
    if round(_weight(fold) - state.guess[name], DIGITS) > 0:
        state.guess[name] = _weight(fold)
        return None
    if isinstance(fold, Refusal):
        return None
    slants = any(o.variant is not None and o.variant.mechanism == "slanted" for o in fold.chosen.values())
    if not slants or not around.offset.any():
        return fold
    # What looked the same before may differ in what sticks out of the outline.
    final = fold_seen(state.problem, state.scene, own, around, is_final=True)
    return final if isinstance(final, UnitFold) else fold


def neighbouring(problem: Problem, scene: Scene) -> list[set[str]]:
    """Groups of units that have to do with each other, by name: their folds share space, or one sees the other."""
    graph: nx.Graph[str] = nx.Graph()
    for name, others in _beside(problem).items():
        unit = problem.tree.units[name]
        around = look(problem, scene, repertoire(problem, unit))
        graph.add_node(name)
        graph.add_edges_from((name, other) for other in others | depends_on(problem, unit, around))
    return sorted((set(c) for c in nx.connected_components(graph)), key=min)


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


def places(problem: Problem) -> dict[str, int]:
    """By unit, how many have lower bases."""
    number = problem.tree.number
    lowest_first = sorted(problem.units, key=lambda u: ([number[b] for b in u.bases], u.name))
    return {unit.name: place for place, unit in enumerate(lowest_first)}


def _best(state: _State) -> str | None:
    """The unit with the least C1 + C2, the lowest where several have; None where no unit can fold."""
    while True:
        best: tuple[float, int, str] | None = None
        does_hold = True
        for hope in _hopes(state):
            if best is not None and best <= hope:
                break
            name = hope[2]
            fold = _folded(state, name)
            does_hold = fold is not None
            if fold is None:
                break
            change = round(_change(state, fold), DIGITS) if len(state.rest) > 1 and _may_look_ahead(state) else hope[0]
            found = (change, state.place[name], name)
            best = min(best, found) if best is not None else found
        # Where what was guessed does not hold, the look-ahead begins anew; guesses only ever rise.
        if does_hold:
            return best[2] if best is not None else None


def _may_look_ahead(state: _State) -> bool:
    """Whether there is work left for that; each patch is played once in any case, and may be so again."""
    work = state.problem.work
    return work.spent < work.limit + 2 * PLAYING * len(state.problem.sites)


def _hopes(state: _State) -> Iterator[tuple[float, int, str]]:
    """The units that may fold, each with how much their folding could at best save others; best first, then lowest."""
    hopes: dict[str, float] = {}
    for name in state.rest:
        excess = state.guess[name] - state.floor[name].weight
        # What waits for several units is not helped by any one of them.
        helpers = (
            state.sees[name] if not state.waits[name] else state.waits[name] if len(state.waits[name]) == 1 else ()
        )
        for other in helpers if excess > 0 else ():
            if other in state.rest and other != name:
                hopes[other] = hopes.get(other, 0.0) - excess
    found = ((round(hope, DIGITS), state.place[name], name) for name, hope in hopes.items())
    able = sorted(hope for hope in found if hope[0] < 0 and state.guess[hope[2]] < REFUSED)
    yield from able
    saving = {name for _, _, name in able}
    # `rest` has the lowest first.
    for name in state.rest:
        if name not in saving and state.guess[name] < REFUSED:
            yield 0.0, state.place[name], name


def _change(state: _State, fold: UnitFold) -> float:
    """By how much the others' costs change where this unit folds now."""
    total = 0.0
    for name in sorted(state.seen_by.get(fold.unit.name, ())):
        if name in state.rest and name != fold.unit.name:
            unit, then = state.rest[name], _then(state, fold)
            around = look(state.problem, then, repertoire(state.problem, unit))
            total += _guessed(state, then, unit, around) - state.guess[name]
    return total


def _then(state: _State, fold: UnitFold) -> Scene:
    """The scene once this unit has folded now."""
    if fold not in state.ahead:
        state.ahead[fold] = after(state.problem, state.scene, fold)
    return state.ahead[fold]


def _merged(state: _State, folds: list[UnitFold]) -> Ordered:
    left = tuple(u for u in state.problem.units if u.name in state.rest)
    refusals = [r for unit in left if isinstance(r := fold_unit(state.problem, state.scene, unit), Refusal)]
    if len(refusals) == 1:
        return Ordered(tuple(folds), tuple(refusals))
    whole = merged(state.problem.scaffold, left)
    fold = fold_unit(state.problem, state.scene, whole, in_place=True)
    if isinstance(fold, Refusal):
        return Ordered(tuple(folds), (*refusals, fold))
    return Ordered((*folds, fold), ())
