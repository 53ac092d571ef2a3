"""A better start for the optimum: the greedy order once more, without what stood in a unit's way.

Where a unit costs more than it must, the folds that took its room are to blame. Each of them is forbidden in turn and
the greedy order is made anew; what is cheaper is kept. The nearer the start is to the optimum, the smaller is the
constraint program that proves it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from foldfab.folding.basic import Variant
from foldfab.folding.congruent import repertoire
from foldfab.folding.ordering import Ordered, after, floors, greedy
from foldfab.folding.problem import Problem, without
from foldfab.folding.prospects import in_the_way
from foldfab.folding.scene import Scene, open_scene
from foldfab.folding.surroundings import look
from foldfab.folding.unit_fold import Choice

TRIES = 6
"""How many folds are forbidden, one after another, before the best is kept."""
ROUNDS = 3
"""How often that is done."""
BETTER = 1e-5
"""By how much an order must be cheaper."""


def improved(problem: Problem, known: Ordered, choices: Mapping[str, Choice]) -> Ordered:
    """An order that counts less than the one known, or that one.

    Args:
        problem: the scaffold and its units.
        known: a greedy order.
        choices: the cheapest choice of each unit by itself.
    """
    banned = problem.banned
    for _ in range(ROUNDS):
        blamed = list(dict.fromkeys(_blamed(problem, open_scene(problem), known, choices)))[:TRIES]
        found = []
        for ban in blamed:
            order = _under(problem, banned | {ban}) if problem.work.left > 0 else None
            found += [(order, ban)] if order is not None else []
        if not found or weight(min(found, key=lambda f: weight(f[0]))[0]) > weight(known) - BETTER:
            break
        known, ban = min(found, key=lambda f: weight(f[0]))
        banned |= {ban}
    return known


def weight(ordered: Ordered) -> float:
    """What an order counts in the search."""
    return float(sum(fold.weight for fold in ordered.folds))


def _blamed(
    problem: Problem, scene: Scene, known: Ordered, choices: Mapping[str, Choice]
) -> Iterator[tuple[str, Variant]]:
    """The folds that keep later units from their cheapest choice."""
    chosen: dict[str, Variant] = {}
    for fold in known.folds:
        cheapest = choices[fold.unit.name] if problem.tree.units.get(fold.unit.name) is fold.unit else None
        if cheapest is not None and fold.weight > cheapest.weight + BETTER:
            own = repertoire(problem, fold.unit)
            around = look(problem, scene, own)
            for owner in in_the_way(problem, own, around, [x for x, _ in cheapest.places.values()]):
                if owner in chosen:
                    yield owner, chosen[owner]
        chosen.update({p: replace(o.variant, pads=(0.0, 0.0)) for p, o in fold.chosen.items() if o.variant})
        scene = after(problem, scene, fold)


def _under(problem: Problem, banned: frozenset[tuple[str, Variant]]) -> Ordered | None:
    """The greedy order without some variants, or None where there is none."""
    other = without(problem, banned)
    if any(not repertoire(other, other.unit_of[patch]).plain[patch] for patch, _ in banned):
        return None
    found = greedy(other, open_scene(other), floors(other))
    return found if not found.refusals else None
