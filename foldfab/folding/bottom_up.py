"""The units folded one after another from the lowest up, each by its cheapest choice as soon as that has room.

Where that folds all of them, no order is cheaper, and none of the look-ahead of section 5.5 is needed to find one that
is as cheap. Where a unit is left over, or its cheapest choice does not hold where it stands, this tells nothing.
"""

from __future__ import annotations

import heapq
from collections.abc import Mapping

from foldfab.folding import basic
from foldfab.folding.basic import Option
from foldfab.folding.congruent import repertoire
from foldfab.folding.ordering import DIGITS, Ordered, after, places
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import prospects
from foldfab.folding.realise import Clash, realised
from foldfab.folding.reasons import reasons_of
from foldfab.folding.repertoire import Repertoire
from foldfab.folding.scene import Scene
from foldfab.folding.surroundings import Surroundings, depends_on, look
from foldfab.folding.unit_fold import Choice, UnitFold, estimated, fold_seen, has_room


def bottom_up(problem: Problem, scene: Scene, floor: Mapping[str, Choice]) -> Ordered | None:
    """The folds of all units of the open scene, each at its `floor`, or None where that is not found at once."""
    if problem.twins:
        return None
    place = places(problem)
    waiting: dict[str, set[str]] = {}
    ready = sorted((place[name], name) for name in place)
    folds: list[UnitFold] = []
    while ready:
        _, name = heapq.heappop(ready)
        unit = problem.tree.units[name]
        own = repertoire(problem, unit)
        around = look(problem, scene, own)
        fold = None
        if has_room(problem, own, around, floor[name]) and not around.offset.any():
            fold = _folded(problem, scene, own, around, floor[name])
        elif round(estimated(problem, scene, own, around) - floor[name].weight, DIGITS) <= 0:
            found = fold_seen(problem, scene, own, around, is_final=True)
            if isinstance(found, UnitFold) and round(found.weight - floor[name].weight, DIGITS) <= 0:
                fold = found
        if fold is None:
            waiting[name] = depends_on(problem, unit, around)
            continue
        folds.append(fold)
        scene = after(problem, scene, fold)
        for other in [n for n, seen in waiting.items() if name in seen]:
            del waiting[other]
            heapq.heappush(ready, (place[other], other))
    return None if waiting else Ordered(tuple(folds), ())


def _folded(
    problem: Problem, scene: Scene, own: Repertoire, around: Surroundings, floor: Choice
) -> UnitFold | None:
    """The fold of a unit by its cheapest choice, or None where that does not hold."""
    chosen = {p: _option(problem, p, x.variant, window) for p, (x, window) in floor.places.items()}
    result = realised(problem, scene, own.unit, around, chosen)
    if isinstance(result, Clash):
        return None
    cost = sum(o.cost for o in chosen.values())
    reasons = reasons_of(problem, own, prospects(problem, own, around, in_place=False), chosen) if cost else {}
    return UnitFold(own.unit, chosen, reasons, *result, around.cluster, cost, floor.weight, around.key)


def _option(problem: Problem, patch: str, variant: basic.Variant, window: tuple[int, int]) -> Option:
    options = problem.options
    kept = (window[1] - window[0]) / options.shrink_steps
    return Option(variant, window, problem.sites[patch].importance * basic.cost(variant.hinges, kept, options))
