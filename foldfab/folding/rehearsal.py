"""The whole fold played through with everything in its final shape.

While a unit is folded, the units after it are still plain panels to it: where their hinges will be is not decided yet.
Here they are shown as they became, with knuckles, feet and plinths. A conflict that is found in this way belongs to
more than a pair of options (it depends on the order), so it is learned: the later patch must fold in another way.
"""

from __future__ import annotations

from dataclasses import replace

from foldfab.folding.basic import Variant
from foldfab.folding.candidates import Problem, surroundings
from foldfab.folding.ordering import last_travel
from foldfab.folding.scene import Scene, advanced
from foldfab.folding.simulate import clashes
from foldfab.folding.unit_fold import UnitFold


def first_clash(problem: Problem, scene: Scene, folds: tuple[UnitFold, ...]) -> tuple[str, Variant] | None:
    """The patch and variant that are in the way of an earlier unit, or None where the fold holds.

    Args:
        problem: the scaffold and its thickness.
        scene: the open furniture.
        folds: the folds of its units in their order.
    """
    order = {patch: i for i, fold in enumerate(folds) for patch in fold.unit.patches}
    variants = {p: o.variant for fold in folds for p, o in fold.chosen.items() if o.variant is not None}
    now = replace(scene, planned={c.patch: c for fold in folds for c in fold.chains})
    for fold in folds:
        around = surroundings(problem, now, fold.unit)
        for pair in clashes(fold.chains, fold.motion, around, problem.thickness):
            blamed = max((p for p in pair if p in variants), key=lambda p: (order[p], p), default=None)
            if blamed is not None:
                return blamed, replace(variants[blamed], pads=(0.0, 0.0))
        now = advanced(now, fold.unit, fold.chains, last_travel(fold, now), fold.unit.name)
    return None
