"""The whole fold played through with everything in its final shape.

While a unit is folded, the units after it are still plain panels to it: where their hinges will be is not decided yet.
Here they are shown as they became, with knuckles, feet and plinths. A conflict that is found in this way belongs to
more than a pair of options (it depends on the order), so it is learned: the later patch must fold in another way.
A unit to which everything near looks as it did when it was folded is not played again, nor is one that folds alone.
"""

from __future__ import annotations

from dataclasses import replace

from foldfab.folding.basic import Variant
from foldfab.folding.congruent import repertoire
from foldfab.folding.ordering import after
from foldfab.folding.problem import Problem
from foldfab.folding.scene import Scene, shown
from foldfab.folding.simulate import clashes
from foldfab.folding.surroundings import look
from foldfab.folding.unit_fold import UnitFold


def first_clash(problem: Problem, scene: Scene, folds: tuple[UnitFold, ...]) -> tuple[str, Variant] | None:
    """The patch and variant that are in the way of an earlier unit, or None where the fold holds.

    Args:
        problem: the scaffold and its thickness.
        scene: the open furniture.
        folds: the folds of its units in their order.
    """
    if len(folds) == 1:
        return None
    order = {patch: i for i, fold in enumerate(folds) for patch in fold.unit.patches}
    variants = {p: o.variant for fold in folds for p, o in fold.chosen.items() if o.variant is not None}
    patches = [patch for fold in folds for patch in fold.unit.patches]
    scene = shown(scene, patches, [chain for fold in folds for chain in fold.chains], is_folded=False)
    for i, fold in enumerate(folds):
        scene = after(problem, scene, folds[i - 1]) if i else scene
        around = look(problem, scene, repertoire(problem, fold.unit))
        if around.key == fold.seen:
            continue
        numbers = problem.tree.number
        for pair in clashes(fold.unit, numbers, fold.chains, fold.motion, around, problem.thickness):
            blamed = max((p for p in pair if p in variants), key=lambda p: (order[p], p), default=None)
            if blamed is not None:
                return blamed, replace(variants[blamed], pads=(0.0, 0.0))
    return None
