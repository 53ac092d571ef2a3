"""The verb of this room: a Scaffold becomes a FoldSolution (section 5, eq. 2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from foldfab.errors import FoldingError
from foldfab.folding import anatomy, basic
from foldfab.folding.demands import require_allowed, require_choices, require_variants
from foldfab.folding.improve import improved, weight
from foldfab.folding.model import FoldSolution, Modification, Step, Thickness
from foldfab.folding.optimum import NO_MORE, PLAYING, lower_bound, optimal
from foldfab.folding.ordering import Ordered, floors, greedy, travel
from foldfab.folding.problem import Problem, without
from foldfab.folding.rehearsal import first_clash
from foldfab.folding.scene import open_scene
from foldfab.folding.site import sites, slab
from foldfab.folding.soundness import disconnected, rigid_patches
from foldfab.folding.symmetry import twins
from foldfab.folding.tree import unit_tree
from foldfab.folding.unit_fold import Choice, UnitFold
from foldfab.folding.units import decompose
from foldfab.geometry.boxes import bounds, stacked
from foldfab.scaffold.model import Scaffold

SINGLES = 4
"""How many un-hingeable patches are tried to be disconnected each for itself, before all of them are."""
REHEARSALS = 8
"""How often the fold is solved anew because a rehearsal of the whole has shown a clash; the kernel judges the last."""


def solve(scaffold: Scaffold) -> FoldSolution:
    """The folding solution of a scaffold by the paper's greedy order, with the thickness of its recipe.

    Where patches must not be split, the scaffold is solved with and without their top ends disconnected.

    Raises:
        FoldingError: no order of the units folds the furniture; the message names what stands in the way.
    """
    thickness = Thickness.of_print(scaffold.recipe.print)
    if not scaffold.patches:
        raise FoldingError("nothing folds along this direction: every part lies perpendicular to it already")
    rigid = rigid_patches(scaffold)
    if not rigid:
        return _solved(scaffold, thickness)
    found: list[FoldSolution] = []
    refused: list[FoldingError] = []
    tries = [(), *((name,) for name in rigid[:SINGLES]), rigid]
    for loose in dict.fromkeys(tries):
        tried = disconnected(scaffold, loose, thickness)
        try:
            found.append(_solved(tried, thickness))
        except FoldingError as error:
            refused.append(error)
    if not found:
        raise refused[-1]
    return min(found, key=lambda s: (sum(m.is_deleted for m in s.modifications), s.cost))


def _solved(scaffold: Scaffold, thickness: Thickness) -> FoldSolution:
    problem = posed(scaffold, thickness)
    # First of all, so that copies of a unit get all the lanes that its first one needed.
    choices = floors(problem)
    require_variants(problem)
    require_allowed(problem)
    least: float | None = None
    for _ in range(REHEARSALS):
        ordered, bound = _ordered(problem, choices)
        # What a rehearsal forbids belongs to one order; the bound is over all options.
        least = bound if least is None else least
        bound = min(bound, least)
        met = first_clash(problem, open_scene(problem), ordered.folds)
        if met is None:
            return solution(problem, bound, ordered)
        problem = without(problem, problem.banned | {met})
        choices = floors(problem)
    told = ", ".join(sorted({patch for patch, _ in problem.banned}))
    raise FoldingError(f"no folding solution found: {told} stay in the way of what folds before; try another thickness")


def _ordered(problem: Problem, choices: Mapping[str, Choice]) -> tuple[Ordered, float]:
    """The folds of all units in their order, and what any order counts at least; `choices` is the cheapest of each."""
    scene = open_scene(problem)
    require_choices(problem, choices)
    ordered = greedy(problem, scene, choices)
    floor = {name: choice.weight for name, choice in choices.items()}
    if not ordered.refusals and weight(ordered) - sum(floor.values()) <= NO_MORE:
        return ordered, sum(floor.values())
    if problem.options.ordering == "greedy":
        bound = sum(floor.values()) if ordered.refusals else lower_bound(problem, scene, ordered, floor)
    else:
        work = problem.options.time_limit - PLAYING * sum(problem.plays)
        known = None if ordered.refusals else improved(problem, ordered, choices, work / PLAYING)
        work = problem.options.time_limit - PLAYING * sum(problem.plays)
        found, bound = optimal(problem, scene, known, floor, work)
        ordered = found or ordered
    if ordered.refusals:
        raise FoldingError(_refused(ordered))
    return ordered, bound


def posed(scaffold: Scaffold, thickness: Thickness) -> Problem:
    """The problem that a scaffold poses."""
    placed = {site.patch.name: site for site in sites(scaffold, thickness)}
    units = decompose(scaffold)
    tree = unit_tree(tuple(base.name for base in scaffold.bases), units)
    plates = [anatomy.base_boxes(base, thickness) for base in scaffold.bases]
    furniture = stacked([*plates, *(slab(site, thickness) for site in placed.values())])
    low, high = bounds(furniture)
    problem = Problem(
        scaffold, scaffold.recipe.fold, thickness, placed, units, tree, {p: u for u in units for p in u.patches},
        {part.name: part for part in scaffold.recipe.parts},
        {base.name: anatomy.faces(base, thickness) for base in scaffold.bases}, furniture, (low.min(0), high.max(0)),
    )  # fmt: skip
    return replace(problem, twins=twins(problem))


def _refused(ordered: Ordered) -> str:
    told = [f"{', '.join(r.unit.patches[:4])}: {r.reason}" for r in ordered.refusals[:4]]
    return "no folding solution: " + "; ".join(told)


def solution(problem: Problem, least: float, ordered: Ordered) -> FoldSolution:
    """The solution that an order of folds makes, no order counting less than `least` in the search."""
    chains = tuple(sorted((c for f in ordered.folds for c in f.chains), key=lambda c: c.patch))
    changed = [_modification(problem, fold, patch) for fold in ordered.folds for patch in fold.unit.patches]
    changed.sort(key=lambda m: m.patch)
    cost = sum(m.cost for m in changed)
    # What was spent beyond the bound, preferences left aside, is what another solution could save at most.
    spent = weight(ordered) - least
    bound = cost if spent < NO_MORE else max(cost - spent, 0.0)
    steps = _steps(problem, ordered.folds)
    return FoldSolution(
        problem.scaffold, problem.thickness, chains, tuple(changed), steps, cost, bound, _notes(problem, ordered)
    )


def _steps(problem: Problem, folds: tuple[UnitFold, ...]) -> tuple[Step, ...]:
    total = sum(fold.motion.path for fold in folds)
    steps, start = [], 0.0
    for i, fold in enumerate(folds):
        end = 1.0 if i == len(folds) - 1 else start + fold.motion.path / total
        m = fold.motion
        ways = travel(problem, fold)
        steps.append(Step(fold.unit.name, fold.unit.patches, start, end, m.samples, ways, m.fold, m.play))
        start = end
    return tuple(steps)


def _modification(problem: Problem, fold: UnitFold, patch: str) -> Modification:
    reason = fold.reasons.get(patch, "")
    return basic.modification(problem.sites[patch], fold.chosen[patch], problem.options, reason)


def _notes(problem: Problem, ordered: Ordered) -> tuple[str, ...]:
    notes = []
    for fold in ordered.folds:
        for chain in fold.chains:
            if chain.panel > problem.sites[chain.patch].panel + 0.01:
                notes.append(f"{chain.patch} is {chain.panel:.1f} mm thick so that the stack closes flat")
            raised = sum(max(pad, 0.0) for pad in chain.pads)
            if raised > 0.01:
                notes.append(f"{chain.patch} stands on plinths of {raised:.1f} mm so that the stack closes flat")
            for base, pad in zip((chain.anchor, chain.far), chain.pads, strict=True):
                if pad < 0:
                    deep = f"{-pad:.1f} mm deep for {chain.patch}"
                    notes.append(f"{base} has a pocket {deep} so that the stack closes flat")
            site = problem.sites[chain.patch]
            if float(np.ptp(chain.span)) > float(np.ptp(site.span)) + 0.01:
                notes.append(
                    f"{chain.patch} is widened to {float(np.ptp(chain.span)):.1f} mm, the least width of a hinge"
                )
    return (*problem.scaffold.notes, *notes)
