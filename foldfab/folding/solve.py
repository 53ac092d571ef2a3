"""The verb of this room: a Scaffold becomes a FoldSolution (section 5, eq. 2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from foldfab.errors import FoldingError
from foldfab.folding import anatomy, basic
from foldfab.folding.congruent import repertoire
from foldfab.folding.improve import improved, weight
from foldfab.folding.model import FoldSolution, Modification, Step, Thickness
from foldfab.folding.optimum import NO_MORE, PLAYING, lower_bound, optimal
from foldfab.folding.options import options_of
from foldfab.folding.ordering import Ordered, floors, greedy, travel
from foldfab.folding.problem import Problem, demanding
from foldfab.folding.prospects import unhindered
from foldfab.folding.rehearsal import first_clash
from foldfab.folding.repertoire import extend
from foldfab.folding.scene import open_scene
from foldfab.folding.site import sites, slab
from foldfab.folding.soundness import disconnected, hangs_together, rigid_patches
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
    _require_variants(problem)
    _require_allowed(problem)
    least: float | None = None
    for _ in range(REHEARSALS):
        ordered, bound = _ordered(problem)
        # What a rehearsal forbids belongs to one order; the bound is over all options.
        least = bound if least is None else least
        bound = min(bound, least)
        met = first_clash(problem, open_scene(problem), ordered.folds)
        if met is None:
            return solution(problem, bound, ordered)
        problem = replace(problem, banned=problem.banned | {met}, repertoires={}, poses={}, solved={}, hopeless={})
    told = ", ".join(sorted({patch for patch, _ in problem.banned}))
    raise FoldingError(f"no folding solution found: {told} stay in the way of what folds before; try another thickness")


def _ordered(problem: Problem) -> tuple[Ordered, float]:
    """The folds of all units in their order, and what any order counts at least."""
    scene, choices = open_scene(problem), floors(problem)
    _require_choices(problem, choices)
    ordered = greedy(problem, scene, choices)
    floor = {name: choice.weight for name, choice in choices.items()}
    if not ordered.refusals and weight(ordered) - sum(floor.values()) <= NO_MORE:
        return ordered, sum(floor.values())
    if problem.options.ordering == "greedy":
        bound = sum(floor.values()) if ordered.refusals else lower_bound(problem, scene, ordered, floor)
    else:
        before = len(problem.plays)
        known = None if ordered.refusals else improved(problem, ordered, choices)
        work = problem.options.time_limit - PLAYING * (len(problem.plays) - before)
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


def _require_choices(problem: Problem, choices: Mapping[str, Choice]) -> None:
    """Where a unit is left no choice at all, what was asked of its parts cannot be had together."""
    for unit in problem.units:
        asked = sorted({part.name for p in unit.patches for part in demanding(problem, p)})
        if asked and not np.isfinite(choices[unit.name].weight):
            raise FoldingError(
                f"what is pinned or forbidden for {', '.join(asked)} cannot be had together: they fold in one unit, "
                "and whatever they may do, two of them exclude each other"
            )


def _require_allowed(problem: Problem) -> None:
    """What the recipe pins or forbids has to leave every patch something that it can do."""
    for unit in problem.units:
        asked = [p for p in unit.patches if demanding(problem, p)]
        own = repertoire(problem, unit)
        for patch in asked:
            while own.later[patch]:
                extend(problem, own, patch)
        options = options_of(problem, unhindered(problem, own), np.zeros(3)) if asked else {}
        for patch in asked:
            if not np.isfinite(options[patch].weight).any():
                names = ", ".join(part.name for part in demanding(problem, patch))
                able = sorted({(x.variant.mechanism, x.variant.hinges) for x in own.plain[patch] if not x.is_out})
                told = ", ".join(
                    f"{how} with {count} hinge{'s' * (count > 1)}" if count else how for how, count in able
                )
                raise FoldingError(
                    f"what is pinned or forbidden for {names} leaves {patch} nothing that it can do; "
                    f"it can fold {told or 'not at all'}, or be narrowed or deleted where that is not ruled out"
                )


def _require_variants(problem: Problem) -> None:
    """Patches without any option of their own have to go; where the furniture needs them, say so at once."""
    lost = [p for unit in problem.units for p in unit.patches if not repertoire(problem, unit).plain[p]]
    if not lost or hangs_together(problem.scaffold, set(lost)):
        return
    rigid = [p for p in lost if not problem.sites[p].patch.hingeable and problem.sites[p].far is not None]
    if rigid:
        raise FoldingError(
            f"{', '.join(rigid[:4])} must not be split, cannot slant here and cannot be disconnected without cutting "
            "the furniture in two; allow slanting or a hinge"
        )
    told = [f"{p} ({problem.sites[p].clear:.1f} mm high)" for p in lost[:4]]
    raise FoldingError(
        f"at scale 1:{1 / problem.scaffold.scale:.3g} {', '.join(told)} cannot carry hinges, and without them the "
        f"furniture falls apart; print larger or with plates thinner than {problem.thickness.panel:g} mm"
    )


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
            if chain.panel > problem.thickness.panel + 0.01:
                notes.append(f"{chain.patch} is {chain.panel:.1f} mm thick so that the stack closes flat")
            if sum(chain.pads) > 0.01:
                notes.append(
                    f"{chain.patch} stands on plinths of {sum(chain.pads):.1f} mm so that the stack closes flat"
                )
            site = problem.sites[chain.patch]
            if float(np.ptp(chain.span)) > float(np.ptp(site.span)) + 0.01:
                notes.append(
                    f"{chain.patch} is widened to {float(np.ptp(chain.span)):.1f} mm, the least width of a hinge"
                )
    return (*problem.scaffold.notes, *notes)
