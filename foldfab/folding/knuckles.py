"""Hinges that were interrupted get all knuckles back for which there is room, once the whole fold is settled.

The search gives an interrupted hinge the least stretch that holds it (`interruption`). Here every other piece of the
patch that is kept gets its knuckles back where, with half the gap on both sides, they meet nothing along the nominal
fold, and nothing in the whole fold played with them; but no stretch that is too narrow to hold.
"""

from __future__ import annotations

from dataclasses import replace

from foldfab.folding import basic
from foldfab.folding.basic import WHOLE
from foldfab.folding.conflict import compare
from foldfab.folding.congruent import repertoire
from foldfab.folding.model import Chain
from foldfab.folding.ordering import after
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import blocked_pieces, in_the_way
from foldfab.folding.repertoire import Repertoire, lane, pieces_met
from foldfab.folding.scene import Scene, open_scene, shown
from foldfab.folding.simulate import clashes
from foldfab.folding.surroundings import Surroundings, look
from foldfab.folding.unit_fold import UnitFold

NAMED = 3
"""How many things a note names."""

Mark = tuple[int, int]
"""First and last cutting point of a stretch, in N_s-ths of the width."""


def given_back(problem: Problem, folds: tuple[UnitFold, ...]) -> tuple[tuple[UnitFold, ...], list[str]]:
    """The folds with all knuckles that have room, and what there is to say of hinges that stay interrupted.

    Args:
        problem: the scaffold and its thickness.
        folds: the folds of its units in their order.
    """
    if not any(c.breaks for fold in folds for c in fold.chains):
        return folds, []
    scene, notes = open_scene(problem), list[str]()
    for k, fold in enumerate(folds):
        for patch in sorted(c.patch for c in fold.chains if c.breaks):
            folds, free, met = _whole_again(problem, scene, folds, k, patch)
            steps = problem.options.shrink_steps
            where = ", ".join(f"{a / steps:g}-{b / steps:g}" for a, b in free)
            through = f" where {', '.join(sorted(met)[:NAMED])} would meet their knuckles" if met else ""
            notes += [f"hinges of {patch} interrupted at {where}{through}"] if free else []
    return folds, notes


def _whole_again(
    problem: Problem, scene: Scene, folds: tuple[UnitFold, ...], k: int, patch: str
) -> tuple[tuple[UnitFold, ...], list[Mark], set[str]]:
    """The folds with more knuckles for one patch of one of them, the stretches that stay free, and what is there."""
    fold, own = folds[k], repertoire(problem, folds[k].unit)
    views = _views(problem, scene, folds)
    variant, (first, last) = fold.chosen[patch].variant, fold.chosen[patch].window
    assert variant is not None
    steps = problem.options.shrink_steps
    kept = set(range(round(variant.hinged[0] * steps), round(variant.hinged[1] * steps)))
    pieces, met = _with_room(problem, own, views[k], fold, patch)
    pieces = [s for s in pieces if first <= s < last and s not in kept]
    for more in ([pieces] if len(pieces) > 1 else []) + [[s] for s in pieces]:
        tried = _with_knuckles(problem, folds, k, patch, kept | set(more))
        if not set(more) <= kept and _holds(problem, scene, tried, views, k):
            kept |= set(more)
    kept = {s for a, b in _stretches(kept) if _is_held(problem, fold, patch, (a, b)) for s in range(a, b)}
    free = _stretches(set(range(first, last)) - kept)
    return _with_knuckles(problem, folds, k, patch, kept), free, met


def _with_room(
    problem: Problem, own: Repertoire, around: Surroundings, fold: UnitFold, patch: str
) -> tuple[list[int], set[str]]:
    """The pieces in which the whole hinges of a patch meet nothing along the nominal fold, and what they meet."""
    lanes = {p: x for p, o in fold.chosen.items() if o.variant and (x := lane(problem, own, p, o.variant)) is not None}
    whole = lane(problem, own, patch, replace(lanes[patch].variant, hinged=WHOLE))
    if whole is None:
        return [], set()
    compare(problem, own, [whole, *lanes.values()])
    taken = blocked_pieces(problem, own, around, [whole])[whole.number].copy()
    met = set(in_the_way(problem, own, around, [whole])) if taken.any() else set()
    for other, x in lanes.items():
        low, high = fold.chosen[other].window
        for part in range(2) if other != patch else ():
            table = pieces_met(own.parts, 2 * whole.number + 1, 2 * x.number + part)
            if table is not None:
                hit = table[:, low:high].any(1)
                taken |= hit
                met |= {other} if hit.any() else set()
    return [s for s in range(len(taken)) if not taken[s]], met


def _with_knuckles(
    problem: Problem, folds: tuple[UnitFold, ...], k: int, patch: str, kept: set[int]
) -> tuple[UnitFold, ...]:
    chains = tuple(
        replace(c, breaks=_breaks(problem, c, kept, folds[k].chosen[patch].window)) if c.patch == patch else c
        for c in folds[k].chains
    )
    return (*folds[:k], replace(folds[k], chains=chains), *folds[k + 1 :])


def _breaks(problem: Problem, chain: Chain, kept: set[int], window: Mark) -> tuple[tuple[float, float], ...]:
    """What hinges leave free along `along` that have knuckles in some pieces only, mm."""
    steps = problem.options.shrink_steps
    stretches = [(0 if a == window[0] else a, steps if b == window[1] else b) for a, b in _stretches(kept)]
    ends = [0, *(end for mark in stretches for end in mark), steps]
    free = [(a / steps, b / steps) for a, b in zip(ends[::2], ends[1::2], strict=True) if b > a]
    return basic.breaks(problem.sites[chain.patch], free, problem.thickness)


def _stretches(pieces: set[int]) -> list[Mark]:
    """Neighbouring pieces as stretches."""
    found: list[Mark] = []
    for s in sorted(pieces):
        found.append((found.pop()[0] if found and found[-1][1] == s else s, s + 1))
    return found


def _is_held(problem: Problem, fold: UnitFold, patch: str, stretch: Mark) -> bool:
    """Whether all hinges of a patch would hold by one stretch alone."""
    chain = next(c for c in fold.chains if c.patch == patch)
    alone = _breaks(problem, chain, set(range(*stretch)), fold.chosen[patch].window)
    return basic.holds(replace(chain, breaks=alone), problem.thickness)


def _views(problem: Problem, scene: Scene, folds: tuple[UnitFold, ...]) -> list[Surroundings]:
    """What each unit sees of the others as they became."""
    patches = [patch for fold in folds for patch in fold.unit.patches]
    scene = shown(scene, patches, [chain for fold in folds for chain in fold.chains], is_folded=False)
    found = []
    for fold in folds:
        found.append(look(problem, scene, repertoire(problem, fold.unit)))
        scene = after(problem, scene, fold)
    return found


def _holds(
    problem: Problem, scene: Scene, tried: tuple[UnitFold, ...], before: list[Surroundings], changed: int
) -> bool:
    """Whether nothing meets in any unit to which a change makes a difference, half the gap around all included."""
    for k, (fold, around) in enumerate(zip(tried, _views(problem, scene, tried), strict=True)):
        if k != changed and around.key == before[k].key:
            continue
        own = repertoire(problem, fold.unit)
        if clashes(fold.unit, problem.tree.number, fold.chains, fold.motion, around, problem.thickness):
            return False
        if k != changed and _is_blocked(problem, own, around, fold):
            return False
    return True


def _is_blocked(problem: Problem, own: Repertoire, around: Surroundings, fold: UnitFold) -> bool:
    chosen = [(x, o) for p, o in fold.chosen.items() if o.variant and (x := lane(problem, own, p, o.variant))]
    room = blocked_pieces(problem, own, around, [x for x, _ in chosen])
    return any(room[x.number][slice(*o.window)].any() for x, o in chosen)
