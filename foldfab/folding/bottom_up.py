"""The units folded one after another from the lowest up, each by its cheapest choice as soon as that has room.

Where that folds all of them, no order is cheaper, and none of the look-ahead of section 5.5 is needed to find one that
is as cheap. Where a unit is left over this tells nothing.
"""

from __future__ import annotations

import heapq
from collections.abc import Mapping
from dataclasses import replace
from typing import get_args

from foldfab.folding import basic
from foldfab.folding.basic import Option, Variant
from foldfab.folding.congruent import repertoire
from foldfab.folding.model import Side
from foldfab.folding.ordering import DIGITS, Ordered, after, places
from foldfab.folding.problem import Problem, demanding
from foldfab.folding.prospects import blocked_pieces, prospects
from foldfab.folding.realise import Clash, realised
from foldfab.folding.reasons import reasons_of
from foldfab.folding.repertoire import Place, Repertoire
from foldfab.folding.scene import Scene
from foldfab.folding.surroundings import Surroundings, depends_on, look
from foldfab.folding.unit_fold import Choice, UnitFold, estimated, fold_seen, has_room


def bottom_up(problem: Problem, scene: Scene, floor: Mapping[str, Choice]) -> Ordered | None:
    """The folds of all units of the open scene, each at its `floor`, or None where that is not found at once."""
    if problem.twins:
        return None
    place = places(problem)
    ready = sorted((place[name], name) for name in place)
    waiting: dict[str, set[str]] = {}
    folds: list[UnitFold] = []
    while ready:
        name = heapq.heappop(ready)[1]
        own = repertoire(problem, problem.tree.units[name])
        around = look(problem, scene, own)
        fold = _folded(problem, scene, own, around, floor[name])
        if fold is None:
            waiting[name] = depends_on(problem, own.unit, around)
            continue
        folds.append(fold)
        scene = after(problem, scene, fold)
        for other in [n for n, seen in waiting.items() if name in seen]:
            del waiting[other]
            heapq.heappush(ready, (place[other], other))
    return None if waiting else Ordered(tuple(folds), ())


def _folded(problem: Problem, scene: Scene, own: Repertoire, around: Surroundings, floor: Choice) -> UnitFold | None:
    """The fold of a unit where it costs no more than at least, or None where it does here."""
    chosen = _with_room(problem, own, around, floor)
    if chosen is not None:
        return _played(problem, scene, own, around, chosen, floor)
    if round(estimated(problem, scene, own, around) - floor.counted, DIGITS) > 0:
        return None
    found = fold_seen(problem, scene, own, around, is_final=True)
    return found if isinstance(found, UnitFold) and round(found.weight - floor.counted, DIGITS) <= 0 else None


def _with_room(problem: Problem, own: Repertoire, around: Surroundings, floor: Choice) -> Mapping[str, Place] | None:
    """A cheapest choice that has room: the known one or, where the unit is a single patch, its mirror image.

    None where there may be others, or where it depends on how far the unit has been carried which of them is best.
    """
    if any(x.variant.mechanism == "slanted" for x, _ in floor.places.values()) and around.offset.any():
        return None
    if has_room(problem, own, around, floor):
        return floor.places
    if around.standing or len(own.unit.patches) > 1 or demanding(problem, own.unit.patches[0]):
        return None
    for patch, (x, window) in floor.places.items():
        sides = tuple(replace(x.variant, side=side) for side in get_args(Side))
        alike = [y for y in own.plain[patch] if y is not x and y.variant in sides]
        room = blocked_pieces(problem, own, around, alike)
        free = [y for y in alike if not room[y.number][slice(*window)].any()]
        if free:
            return {patch: (free[0], window)}
    return None


def _played(
    problem: Problem, scene: Scene, own: Repertoire, around: Surroundings, chosen: Mapping[str, Place], floor: Choice
) -> UnitFold | None:
    options = {p: _option(problem, p, x.variant, window) for p, (x, window) in chosen.items()}
    result = realised(problem, scene, own.unit, around, options)
    if isinstance(result, Clash):
        return None
    cost = sum(o.cost for o in options.values())
    reasons = reasons_of(problem, own, prospects(problem, own, around, in_place=False), options) if cost else {}
    return UnitFold(own.unit, options, reasons, *result, around.cluster, cost, floor.counted, around.key, floor.gap)


def _option(problem: Problem, patch: str, variant: Variant, window: tuple[int, int]) -> Option:
    options = problem.options
    kept = (window[1] - window[0]) / options.shrink_steps
    return Option(variant, window, problem.sites[patch].importance * basic.cost(variant.hinges, kept, options))
