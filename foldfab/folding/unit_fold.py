"""Foldabilization of one unit at a given moment: the inner loop (sections 5.4 and 5.5).

The cheapest conflict-free choice is made real: bases are lowered by the longest paths, chains get the plinths they
lack, and the fold is simulated. What then meets is added to the conflicts and the choice is made anew, until it holds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from foldfab.folding import basic
from foldfab.folding.aside import bring_back
from foldfab.folding.basic import Option, Variant
from foldfab.folding.conflict import compare_sheets
from foldfab.folding.congruent import repertoire
from foldfab.folding.graph import Graph, Lesson
from foldfab.folding.interruption import interrupted
from foldfab.folding.model import Chain
from foldfab.folding.options import DELETION
from foldfab.folding.press import Motion
from foldfab.folding.problem import Problem
from foldfab.folding.promises import Outlook, is_cheapest, promising
from foldfab.folding.prospects import Prospects, blocked_pieces, prospects, unhindered
from foldfab.folding.realise import Clash, chain_of, realised
from foldfab.folding.reasons import reason_against, reasons_of
from foldfab.folding.repertoire import Place, Repertoire, extend
from foldfab.folding.scene import Scene, alone
from foldfab.folding.sheets import crossings
from foldfab.folding.surroundings import Surroundings, look
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Indices

ROUNDS = 60
"""Choices that are tried for one unit before it counts as not foldable at this moment."""


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
    cluster: Indices
    """(b,) by number of each base, the place of the unit's base that it moves with."""
    cost: float
    """Sum of its terms of eq. 1."""
    weight: float
    """What the search minimises: the cost, with deletions counted many times."""
    seen: object
    """All that it depends on (`Surroundings.key`)."""
    gap: float = 0.0
    """By how much it may weigh more than the cheapest in these surroundings, where the work did not suffice to tell."""
    learned: tuple[Lesson, ...] = ()
    """What did not work in these surroundings."""


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """One option for each patch of a unit, not yet played."""

    weight: float
    """What it counts in the search, or less where that is not proven."""
    places: Mapping[str, Place]
    """By patch that is kept, its lane and its window in N_s-ths."""
    spare: float = 0.0
    """By how much hinges that are interrupted might better it, where the work did not suffice to tell."""
    gap: float = 0.0
    """By how much anything else might."""

    @property
    def counted(self) -> float:
        """What it counts as it is."""
        return self.weight + self.spare + self.gap


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a unit cannot fold at this moment."""

    unit: Unit
    reason: str
    learned: tuple[Lesson, ...] = ()
    """What did not work in these surroundings."""


def fold_unit(problem: Problem, scene: Scene, unit: Unit, *, in_place: bool = False) -> UnitFold | Refusal:
    """The cheapest valid folding solution of a unit in the scene, or why there is none."""
    own = repertoire(problem, unit)
    return fold_seen(problem, scene, own, look(problem, scene, own), in_place=in_place)


def fold_seen(
    problem: Problem, scene: Scene, own: Repertoire, around: Surroundings, *,
    in_place: bool = False, is_final: bool = False,
) -> UnitFold | Refusal:  # fmt: skip
    """The same for a unit that has looked around already.

    A solution is found once for all scenes that look the same from the unit. Where it has been carried to decides only
    between options of equal cost, and is looked at only where the fold `is_final`.
    """
    if own.unit in problem.hopeless:
        return Refusal(own.unit, problem.hopeless[own.unit])
    key = (around.key, in_place, tuple(np.round(around.offset, 3)) if is_final else None)
    if key not in problem.solved:
        problem.solved[key] = _fold(problem, scene, own, around, in_place=in_place)
    found: UnitFold | Refusal = problem.solved[key]
    return found


def estimated(problem: Problem, scene: Scene, own: Repertoire, around: Surroundings) -> float:
    """What a unit counts at least where it has looked around: its cheapest choice that has room, not played."""
    known = problem.solved.get((around.key, False, None))
    if known is not None:
        return known.weight if isinstance(known, UnitFold) else np.inf
    key = (around.key, "estimated")
    if key not in problem.solved:
        problem.solved[key] = _estimate(problem, scene, own, around)
    found: float = problem.solved[key]
    return found


def _estimate(problem: Problem, scene: Scene, own: Repertoire, around: Surroundings) -> float:
    if around.standing or own.unit in problem.hopeless:
        return np.inf
    found = prospects(problem, own, around, in_place=False)
    graph = Graph(problem, own, found, around.offset, chosen=scene.chosen)
    found, graph, picked = _picked(problem, scene, own, around, found, graph, in_place=False)
    problem.begun[around.key, around.offset.tobytes()] = found, graph
    return graph.weight(picked) if picked is not None else np.inf


def fold_alone(problem: Problem, scene: Scene, unit: Unit) -> UnitFold | Refusal:
    """What a unit could do where nothing but itself is there; where that is nothing, it is not tried any more."""
    bare = alone(scene, unit)
    own = repertoire(problem, unit)
    found = fold_seen(problem, bare, own, look(problem, bare, own))
    if isinstance(found, Refusal):
        problem.hopeless[unit] = found.reason
    return found


def least_choice(problem: Problem, own: Repertoire) -> Choice:
    """The cheapest choice without conflicts, whatever stands around the unit and however it is played; found once."""
    if own.unit not in problem.least:
        problem.least[own.unit] = _least_choice(problem, own)
    found: Choice = problem.least[own.unit]
    return found


def _least_choice(problem: Problem, own: Repertoire) -> Choice:
    def posed() -> tuple[Prospects, Graph]:
        found = unhindered(problem, own)
        return found, Graph(problem, own, found, np.zeros(3))

    def settled() -> tuple[Graph, tuple[int, ...] | None]:
        found, graph = posed()
        return _bettered(problem, own, found, graph, None, posed)[1:]

    graph, picked = settled()
    # Only here, before anything rests on what the unit counts at least.
    found_any, floor = interrupted(problem, own, graph, picked)
    if found_any:
        graph, picked = settled()
    if picked is not None and not own.sheets and crossings(problem.scaffold, _chains(problem, own.unit, graph, picked)):
        compare_sheets(problem, own)
        graph, picked = settled()
    if picked is None:
        return Choice(np.inf, {})
    chosen = {o.patch: o.place(i) for o, i in zip(graph.options, picked, strict=True)}
    places = {p: place for p, place in chosen.items() if place is not None}
    if not graph.gaps:
        own.least.update(places)
    # Where the work did not suffice to prove the choice, what it may be too dear by is no part of what must be paid.
    gap = float(sum(graph.gaps))
    weight = graph.weight(picked) - gap
    return Choice(min(weight, floor), places, max(weight - floor, 0.0), gap)


def _chains(problem: Problem, unit: Unit, graph: Graph, picked: tuple[int, ...]) -> list[Chain]:
    """The chains of a choice as they are before anything is balanced."""
    places = (options.place(i) for options, i in zip(graph.options, picked, strict=True))
    kept = [place for place in places if place is not None]
    made = (chain_of(problem, unit, x.patch, x.variant, window) for x, window in kept)
    return [chain for chain in made if chain is not None]


def is_solved(problem: Problem, around: Surroundings) -> bool:
    """Whether the unit has been folded in such surroundings before."""
    return (around.key, False, None) in problem.solved


def has_room(problem: Problem, own: Repertoire, around: Surroundings, choice: Choice) -> bool:
    """Whether nothing around is in the way of a choice, as far as the nominal fold tells."""
    if around.standing or len(choice.places) < len(own.unit.patches):
        return False
    room = blocked_pieces(problem, own, around, [x for x, _ in choice.places.values()])
    return not any(room[x.number][a:b].any() for x, (a, b) in choice.places.values())


def _fold(
    problem: Problem, scene: Scene, own: Repertoire, around: Surroundings, *, in_place: bool
) -> UnitFold | Refusal:
    unit = own.unit
    if around.standing:
        return Refusal(unit, f"{', '.join(sorted(around.standing)[:3])} in the way still stands unfolded")
    why: list[str] = []
    found, graph = _begun(problem, scene, own, around, in_place=in_place)
    for _ in range(ROUNDS):
        found, graph, picked = _picked(problem, scene, own, around, found, graph, in_place=in_place)
        if picked is None:
            break
        chosen = {o.patch: o[i] for o, i in zip(graph.options, picked, strict=True)}
        result = realised(problem, scene, unit, around, chosen)
        if not isinstance(result, Clash):
            reasons = reasons_of(problem, own, found, chosen)
            cost = sum(o.cost for o in chosen.values())
            return UnitFold(
                unit, chosen, reasons, *result, around.cluster, cost, graph.weight(picked), around.key,
                gap=float(sum(graph.gaps)), learned=tuple(graph.learned),
            )  # fmt: skip
        why += [result.reason] if result.reason not in why else []
        graph.learn(picked, result)
        if result.crosses and not own.sheets:
            compare_sheets(problem, own)
            graph = Graph(problem, own, found, around.offset, graph.learned, scene.chosen)
    return Refusal(unit, reason_against(problem, own, found, why), tuple(graph.learned))


def _begun(
    problem: Problem, scene: Scene, own: Repertoire, around: Surroundings, *, in_place: bool
) -> tuple[Prospects, Graph]:
    """What the unit can do and its conflict graph, made already where it was estimated in such surroundings."""
    known: tuple[Prospects, Graph] | None = problem.begun.pop((around.key, around.offset.tobytes()), None)
    if known is not None and not in_place:
        return known
    found = prospects(problem, own, around, in_place=in_place)
    return found, Graph(problem, own, found, around.offset, chosen=scene.chosen)


def _picked(
    problem: Problem, scene: Scene, own: Repertoire, around: Surroundings, found: Prospects, graph: Graph, *,
    in_place: bool,
) -> tuple[Prospects, Graph, tuple[int, ...] | None]:  # fmt: skip
    """The cheapest choice without conflicts, over all lanes that could be part of it."""
    # Preferences depend on where a unit has been carried, and so may the cheapest choice.
    known = graph.holds(own.least) if not around.offset.any() else None
    learned = graph.learned

    def posed() -> tuple[Prospects, Graph]:
        found = prospects(problem, own, around, in_place=in_place)
        return found, Graph(problem, own, found, around.offset, learned, scene.chosen)

    return _bettered(problem, own, found, graph, known, posed)


def _bettered(
    problem: Problem, own: Repertoire, found: Prospects, graph: Graph, known: tuple[int, ...] | None,
    posed: Callable[[], tuple[Prospects, Graph]],
) -> tuple[Prospects, Graph, tuple[int, ...] | None]:  # fmt: skip
    """The cheapest choice once all lanes are made that could better it, and the graph `posed` with them.

    Lanes that only go with deletions are among them where something has to go.
    """
    found, graph, best = _best_offered(problem, own, found, graph, known, posed)
    if own.aside and (best is None or graph.weight(best) >= DELETION):
        bring_back(own)
        found, graph, best = _best_offered(problem, own, *posed(), None, posed)
    return found, graph, best


def _best_offered(
    problem: Problem, own: Repertoire, found: Prospects, graph: Graph, known: tuple[int, ...] | None,
    posed: Callable[[], tuple[Prospects, Graph]],
) -> tuple[Prospects, Graph, tuple[int, ...] | None]:  # fmt: skip
    """The same over what is on offer.

    That the next ones will better it is seen far sooner than what is the cheapest choice until then; and where none
    will, what was looked at for that may tell the cheapest choice of all.
    """
    picked, is_least = (known, True) if known is not None else graph.soon()
    outlook = _outlook(problem, own, graph, picked, is_least=is_least)
    while outlook.wanted:
        weight = _weight(graph, picked, is_least=is_least)
        while outlook.wanted:
            extend(problem, own, outlook.wanted)
            found, graph = posed()
            outlook = _bettering(problem, own, graph, weight)
        picked, is_least = graph.soon()
        if not np.isfinite(outlook.floor):
            outlook = _outlook(problem, own, graph, picked, is_least=is_least)
    best = picked if is_least else outlook.least or picked
    if not is_least and (best is None or not is_cheapest(graph, best, outlook.floor)):
        best = graph.cheapest()
    return found, graph, best


def _weight(graph: Graph, picked: tuple[int, ...] | None, *, is_least: bool) -> float:
    """What a choice counts; without any, what lanes have to better if it is known that there is none, or if not."""
    return graph.weight(picked) if picked is not None else -np.inf if is_least else np.inf


def _outlook(
    problem: Problem, own: Repertoire, graph: Graph, picked: tuple[int, ...] | None, *, is_least: bool
) -> Outlook:
    """The lanes not made yet that could better a choice; all of them where there is no choice."""
    if picked is None and is_least:
        return Outlook(tuple(p for p in own.unit.patches if own.later[p]))
    return _bettering(problem, own, graph, _weight(graph, picked, is_least=is_least))


def _bettering(problem: Problem, own: Repertoire, graph: Graph, weight: float) -> Outlook:
    """The lanes not made yet that could be part of a choice that weighs less."""
    least: Choice | None = problem.least.get(own.unit)
    if least is not None and weight <= least.weight:
        return Outlook(floor=weight)
    first = {p: _price(problem, p, many[0].variant) if many else np.inf for p, many in own.plain.items()}
    spare = weight - sum(price for price in first.values() if np.isfinite(price))
    prices = {p: _price(problem, p, later[0]) for p, later in own.later.items() if later}
    affordable = {p: price for p, price in prices.items() if price - first[p] < spare}
    return promising(graph, affordable, weight) if affordable else Outlook()


def _price(problem: Problem, patch: str, variant: Variant) -> float:
    """λ · eq. 3 of a whole patch."""
    return problem.sites[patch].importance * basic.cost(variant.hinges, 1.0, problem.options)
