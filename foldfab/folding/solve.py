"""The verb of this room: a Scaffold becomes a FoldSolution (section 5, eq. 2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from foldfab.errors import FoldingError, LossError
from foldfab.folding import anatomy, basic
from foldfab.folding.bottom_up import bottom_up
from foldfab.folding.demands import require_allowed, require_choices, require_variants
from foldfab.folding.group import NO_MORE
from foldfab.folding.improve import improved, weight
from foldfab.folding.knuckles import given_back
from foldfab.folding.model import FoldSolution, Modification, Step, Thickness
from foldfab.folding.optimum import lower_bound, optimal
from foldfab.folding.options import DELETION
from foldfab.folding.ordering import Ordered, floors, greedy, travel
from foldfab.folding.problem import Problem, kept_clear, without
from foldfab.folding.rehearsal import first_clash
from foldfab.folding.scene import Scene, open_scene
from foldfab.folding.site import sites, slab
from foldfab.folding.soundness import disconnected, rigid_patches
from foldfab.folding.symmetry import twins
from foldfab.folding.tree import unit_tree
from foldfab.folding.trespass import trespasses
from foldfab.folding.unit_fold import Choice, UnitFold
from foldfab.folding.units import decompose
from foldfab.folding.work import Work
from foldfab.geometry.boxes import bounds, stacked
from foldfab.scaffold.model import Scaffold

SINGLES = 4
"""How many un-hingeable patches are tried to be disconnected each for itself, before all of them are."""
REHEARSALS = 8
"""How often the fold is solved anew because a rehearsal of the whole has shown a clash; the kernel judges the last."""


def solve(
    scaffold: Scaffold, work: Work | None = None, most: int | None = None, worth: int | None = None
) -> FoldSolution:
    """The folding solution of a scaffold, with the thickness of its recipe.

    Where patches must not be split, the scaffold is solved with and without their top ends disconnected. The search for
    what is better than the first solution is only for such as delete no more than `worth` patches, where that is given.
    It ends with the `work`, that of the recipe's time limit where there is none.

    Raises:
        LossError: more than `most` patches have to go, in whatever order.
        FoldingError: no order of the units folds the furniture; the message names what stands in the way.
    """
    thickness = Thickness.of_print(scaffold.recipe.print)
    if not scaffold.patches:
        raise FoldingError("nothing folds along this direction: every part lies perpendicular to it already")
    work = work or Work(scaffold.recipe.fold.time_limit)
    rigid = rigid_patches(scaffold)
    if not rigid:
        return _solved(posed(scaffold, thickness, work), most, worth)
    found: list[FoldSolution] = []
    refused: list[FoldingError] = []
    tries = list(dict.fromkeys([(), *((name,) for name in rigid[:SINGLES]), rigid]))
    for k, loose in enumerate(tries):
        tried, share = disconnected(scaffold, loose, thickness), Work(work.left / (len(tries) - k))
        try:
            found.append(_solved(posed(tried, thickness, share), most, worth))
        except FoldingError as error:
            refused.append(error)
        work.charge(share.spent)
    if not found:
        raise refused[-1]
    return min(found, key=lambda s: (sum(m.is_deleted for m in s.modifications), s.cost))


def _solved(problem: Problem, most: int | None, worth: int | None) -> FoldSolution:
    # First of all, so that copies of a unit get all the lanes that its first one needed.
    choices = floors(problem)
    require_variants(problem)
    require_allowed(problem)
    _require_worth(choices, most)
    most_proven = np.inf
    for _ in range(REHEARSALS):
        scene = open_scene(problem)
        ordered, bound = _ordered(problem, scene, choices, worth)
        bound = min(bound, most_proven)
        met = first_clash(problem, scene, ordered.folds)
        crossed = trespasses(problem, ordered.folds) if met is None else {}
        if met is None and not crossed:
            return solution(problem, bound, ordered)
        if not crossed or not all(c.is_always for c in crossed.values()):
            # What a rehearsal forbids belongs to one order; the bound is over all options.
            most_proven = bound
        problem = without(problem, problem.banned | {met}) if met else kept_clear(problem, crossed)
        choices = floors(problem)
    told = ", ".join(sorted({patch for patch, _ in (*problem.banned, *problem.crossed)}))
    raise FoldingError(f"no folding solution found: {told} stay in the way of what folds before; try another thickness")


def _require_worth(choices: Mapping[str, Choice], most: int | None) -> None:
    """Raises a LossError where even the cheapest `choices` of all units delete more than `most` patches."""
    least = sum(choice.weight for choice in choices.values())
    if most is not None and DELETION * (most + 1) <= least < np.inf:
        raise LossError(int(least // DELETION))


def _ordered(
    problem: Problem, scene: Scene, choices: Mapping[str, Choice], worth: int | None = None
) -> tuple[Ordered, float]:
    """The folds of all units in their order, and what any order counts at least; `choices` is the cheapest of each.

    Better ones than the greedy order are only looked for among those that delete no more than `worth` patches.
    """
    require_choices(problem, choices)
    ordered = bottom_up(problem, scene, choices) or greedy(problem, scene, choices)
    floor = {name: choice.weight for name, choice in choices.items()}
    if not ordered.refusals and weight(ordered) - sum(floor.values()) <= NO_MORE:
        return ordered, sum(floor.values())
    if problem.options.ordering == "greedy":
        bound = sum(floor.values()) if ordered.refusals else lower_bound(problem, scene, ordered, floor)
    else:
        known = None if ordered.refusals else improved(problem, ordered, choices)
        limit = np.inf if worth is None else DELETION * (worth + 1)
        found, bound = optimal(problem, scene, known, floor, limit)
        ordered = found or ordered
    if ordered.refusals:
        raise FoldingError(_refused(ordered))
    return ordered, bound


def posed(scaffold: Scaffold, thickness: Thickness, work: Work | None = None) -> Problem:
    """The problem that a scaffold poses, to be solved within the work or else the recipe's time limit."""
    placed = {site.patch.name: site for site in sites(scaffold, thickness)}
    units = decompose(scaffold)
    tree = unit_tree(tuple(base.name for base in scaffold.bases), units)
    plates = {base.name: anatomy.base_boxes(base, thickness) for base in scaffold.bases}
    corners = {name: bounds(plate) for name, plate in plates.items()}
    furniture = stacked([*plates.values(), *(slab(site, thickness) for site in placed.values())])
    low, high = bounds(furniture)
    problem = Problem(
        scaffold, scaffold.recipe.fold, thickness, placed, units, tree, {p: u for u in units for p in u.patches},
        {part.name: part for part in scaffold.recipe.parts},
        {base.name: anatomy.faces(base, thickness) for base in scaffold.bases},
        {name: (lower.min(0), upper.max(0)) for name, (lower, upper) in corners.items()},
        furniture, (low.min(0), high.max(0)),
        work=work or Work(scaffold.recipe.fold.time_limit),
    )  # fmt: skip
    return replace(problem, twins=twins(problem))


def _refused(ordered: Ordered) -> str:
    told = [f"{', '.join(r.unit.patches[:4])}: {r.reason}" for r in ordered.refusals[:4]]
    return "no folding solution: " + "; ".join(told)


def solution(problem: Problem, least: float, ordered: Ordered) -> FoldSolution:
    """The solution that an order of folds makes, no order counting less than `least` in the search."""
    folds, interrupted = given_back(problem, ordered.folds)
    ordered = replace(ordered, folds=folds)
    chains = tuple(sorted((c for f in ordered.folds for c in f.chains), key=lambda c: c.patch))
    changed = [_modification(problem, fold, patch) for fold in ordered.folds for patch in fold.unit.patches]
    changed.sort(key=lambda m: m.patch)
    cost = sum(m.cost for m in changed)
    # What was spent beyond the bound, preferences left aside, is what another solution could save at most.
    spent = weight(ordered) - least
    bound = cost if spent < NO_MORE else max(cost - spent, 0.0)
    steps = _steps(problem, ordered.folds)
    notes = (*_notes(problem, ordered), *interrupted)
    return FoldSolution(problem.scaffold, problem.thickness, chains, tuple(changed), steps, cost, bound, notes)


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
