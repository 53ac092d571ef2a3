"""Units that are solved together: what their patches may do, as far as it is known, as one constraint program."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from foldfab.folding.congruent import repertoire
from foldfab.folding.graph import Graph
from foldfab.folding.lanes import Lane
from foldfab.folding.master import Cut, Master, Order
from foldfab.folding.options import Options
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import Prospects, ruled_out, unhindered
from foldfab.folding.scene import Scene
from foldfab.folding.symmetry import Signature, is_less, signature, unlike
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Bools

NO_MORE = 1e-5
"""What preferences between options of equal cost may add up to."""

Place = tuple[int, tuple[int, int]] | None
"""A lane by its number and a window; None where a patch is deleted."""


@dataclass(frozen=True, slots=True)
class Lesson:
    """A cut in terms that outlive one constraint program."""

    options: tuple[tuple[str, frozenset[Place]], ...]
    order: tuple[Order, ...]


@dataclass(slots=True, eq=False)
class Group:
    """Units that are solved together."""

    problem: Problem
    scene: Scene
    """The furniture with everything else folded as it will be."""
    units: tuple[Unit, ...]
    known: float
    """What the best fold known counts."""
    floor: Mapping[str, float]
    """By unit, what it counts at least."""
    lanes: dict[str, tuple[Lane, ...]]
    """By patch; those on plinths are added as they are asked for."""
    lessons: list[Lesson] = field(default_factory=list)
    """In the order in which they were learned."""
    learned: set[Lesson] = field(default_factory=set)
    """The same, to tell what is new."""
    excluded: tuple[Mapping[str, Signature], ...] = ()
    """Modifications of all patches that are not asked for again, nor with less left of them."""


def learn(group: Group, lessons: Iterable[Lesson]) -> None:
    """Adds what was not learned before."""
    for lesson in lessons:
        if lesson not in group.learned:
            group.learned.add(lesson)
            group.lessons.append(lesson)


def posed(group: Group) -> tuple[dict[str, Options], Master]:
    """The options of every patch, and the constraint program over those that may be part of something cheaper."""
    problem = group.problem
    options: dict[str, Options] = {}
    tables = {}
    ways: dict[str, list[dict[str, Bools]]] = {}
    for unit in group.units:
        own = repertoire(problem, unit)
        found = _all_of(group, unit)
        graph = Graph(problem, own, found, np.zeros(3))
        options.update({o.patch: o for o in graph.options})
        ways[unit.name] = [dict(zip(unit.patches, masks, strict=True)) for masks in graph.modes]
        tables.update({(unit.patches[g], unit.patches[h]): m for (g, h), m in graph.tables.items()})
    spare = group.known - sum(float(o.weight.min()) for o in options.values())
    worth = {p: np.nonzero(o.weight - o.weight.min() <= spare)[0].tolist() for p, o in options.items()}
    worth = {p: keep if np.isfinite(spare) else _finite(options[p]) for p, keep in worth.items()}
    master = Master({u.name: u.patches for u in group.units}, options, tables, worth)
    for patch, twin in sorted(problem.twins.items()):
        if patch < twin.patch and patch in options and twin.patch in options:
            master.treat_alike(
                patch,
                twin.patch,
                unlike(options[patch], options[twin.patch], problem.options.shrink_steps, is_reversed=twin.is_reversed),
            )
    for many in ways.values():
        master.one_of(many)
    for unit in group.units:
        master.at_least({p: options[p].weight for p in unit.patches}, group.floor[unit.name])
    for one in group.excluded:
        alike = (
            (p, tuple(i for i in range(len(o.price)) if is_less(signature(o[i]), one[p]))) for p, o in options.items()
        )
        master.add(Cut(tuple(alike), ()))
    for lesson in group.lessons:
        master.add(cut_of(options, lesson))
    return options, master


def _finite(options: Options) -> list[int]:
    found: list[int] = np.nonzero(np.isfinite(options.weight))[0].tolist()
    return found


def _all_of(group: Group, unit: Unit) -> Prospects:
    """All lanes of a unit that are known by now, whatever stands around it."""
    free = unhindered(group.problem, repertoire(group.problem, unit))
    lanes = {p: group.lanes[p] for p in unit.patches}
    blocked = {x.number: ruled_out(group.problem, x) for many in lanes.values() for x in many}
    return replace(free, lanes=lanes, blocked=blocked)


def cut_of(options: Mapping[str, Options], lesson: Lesson) -> Cut:
    """A lesson in terms of the options that there are now."""
    places = tuple(
        (p, tuple(i for i in range(len(options[p].price)) if place_of(options[p], i) in held))
        for p, held in lesson.options
    )
    return Cut(places, lesson.order)


def place_of(options: Options, index: int) -> Place:
    """An option in terms that outlive a constraint program."""
    found = options.place(index)
    return (found[0].number, found[1]) if found is not None else None
