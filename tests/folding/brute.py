"""Brute force: every choice of options in every order of the units, played through as the solver defines validity.

A choice is valid where no two options of a unit exclude each other in the conflict graph (which has tests of its own)
and every unit folds in its turn while the units before it lie folded and those after it stand open as they were
chosen. Raised lanes join in as soon as any scene asks for them.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from foldfab.folding import basic
from foldfab.folding.basic import Option
from foldfab.folding.congruent import repertoire
from foldfab.folding.graph import Graph
from foldfab.folding.lanes import Lane
from foldfab.folding.options import Options
from foldfab.folding.ordering import after
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import prospects, unhindered
from foldfab.folding.realise import Clash, realised
from foldfab.folding.rehearsal import first_clash
from foldfab.folding.scene import open_scene, shown
from foldfab.folding.surroundings import look
from foldfab.folding.unit_fold import UnitFold
from foldfab.folding.units import Unit

from .every import whole

NO_MORE = 1e-5
"""What preferences between options of equal cost may add up to."""


def cheaper(problem: Problem, most: float, limit: int = 100_000) -> tuple[float | None, int]:
    """The weight of the cheapest valid choice below `most`, or None where there is none; and how many were played."""
    lanes = {p: whole(problem, u).plain[p] for u in problem.units for p in u.patches}
    played: set[tuple[object, ...]] = set()
    while True:
        count = sum(map(len, lanes.values()))
        for weight, chosen in _choices(problem, lanes, most):
            key = tuple(sorted((p, o) for p, o in chosen.items()))
            if key in played:
                continue
            played.add(key)
            assert len(played) < limit, "too many choices for brute force"
            if any(_holds(problem, chosen, order, lanes) for order in itertools.permutations(problem.units)):
                return weight, len(played)
        if sum(map(len, lanes.values())) == count:
            return None, len(played)
        # What was played before may see more with the new lanes, but it does not fold another way.


def _choices(
    problem: Problem, lanes: dict[str, tuple[Lane, ...]], most: float
) -> list[tuple[float, dict[str, Option]]]:
    """All choices without conflicts that count less than `most`, cheapest first."""
    by_unit = [list(_of_unit(problem, unit, lanes, most)) for unit in problem.units]
    found = []
    for parts in itertools.product(*by_unit):
        weight = sum(w for w, _ in parts)
        if weight < most:
            found.append((weight, {p: o for _, chosen in parts for p, o in chosen.items()}))
    return sorted(found, key=lambda f: f[0])


def _of_unit(
    problem: Problem, unit: Unit, lanes: Mapping[str, tuple[Lane, ...]], most: float
) -> Iterator[tuple[float, dict[str, Option]]]:
    own = repertoire(problem, unit)
    steps = problem.options.shrink_steps
    blocked = {x.number: np.full(steps, x.is_out) for p in unit.patches for x in lanes[p]}
    found = replace(unhindered(problem, own), lanes={p: lanes[p] for p in unit.patches}, blocked=blocked)
    graph = Graph(problem, own, found, np.zeros(3))

    def extended(picked: tuple[int, ...], weight: float) -> Iterator[tuple[float, dict[str, Option]]]:
        g = len(picked)
        if g == len(graph.options):
            yield weight, {o.patch: o[i] for o, i in zip(graph.options, picked, strict=True)}
            return
        options: Options = graph.options[g]
        for i in range(len(options.price)):
            heavier = weight + float(options.weight[i])
            if heavier < most and not any(
                (h, g) in graph.tables and graph.tables[h, g][picked[h], i] for h in range(g)
            ):
                yield from extended((*picked, i), heavier)

    yield from extended((), 0.0)


def _holds(
    problem: Problem, chosen: Mapping[str, Option], order: tuple[Unit, ...], lanes: dict[str, tuple[Lane, ...]]
) -> bool:
    """Whether a choice folds in an order; what lanes its scenes ask for is added."""
    scene = open_scene(problem)
    for unit in order:
        scene = shown(scene, unit.patches, _plain(problem, unit, chosen), is_folded=False)
    folds = []
    for unit in order:
        own = repertoire(problem, unit)
        around = look(problem, scene, own)
        if around.standing:
            return False
        result = realised(problem, scene, unit, around, {p: chosen[p] for p in unit.patches})
        if isinstance(result, Clash):
            for patch, many in prospects(problem, own, around, in_place=False).lanes.items():
                lanes[patch] += tuple(x for x in many if x not in lanes[patch])
            return False
        fold = UnitFold(unit, {p: chosen[p] for p in unit.patches}, {}, *result, around.cluster, 0.0, 0.0, around.key)
        folds.append(fold)
        scene = after(problem, scene, fold)
    return first_clash(problem, open_scene(problem), tuple(folds)) is None


def _plain(problem: Problem, unit: Unit, chosen: Mapping[str, Option]) -> Iterator[basic.Chain]:
    for patch in unit.patches:
        site, option = problem.sites[patch], chosen[patch]
        span = basic.window_span(site, option.window, problem.options.shrink_steps, problem.thickness)
        if option.variant is not None and span is not None:
            made = basic.chain(site, option.variant, span, problem.thickness)
            if made is not None:
                yield made
