"""A recipe along one direction: solved at the scale asked for, or the largest at which its print fits the printer."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from foldfab.errors import AbstractionError, FoldingError, LossError
from foldfab.geometry.arrays import Array
from foldfab.recipe.hinges import hinge_problem
from foldfab.recipe.model import Posture, Recipe
from foldfab.scaffold.directions import AXES, title

if TYPE_CHECKING:
    from foldfab.folding.model import FoldSolution
    from foldfab.folding.work import Work
    from foldfab.scaffold.model import Scaffold

MARGIN_THICKNESSES = 2.0
"""How much wider than the furniture's sheets the print may be on account of plates and knuckles, in K."""
THINNER = (3.0, 2.0)
"""Thicknesses of plates that are tried where thicker ones do not fold, mm; thinner ones do not print."""
HELD_SHARE = 0.125
"""A hinge holds where its clearance is at most this share of its plates' thickness."""
LEAST_SHARE = 0.25
"""Share of the time limit that each thickness of plates gets in any case."""
SCALE_ROUNDS = 6
"""How often the scale of a print is reduced until it fits the bed."""


def along(recipe: Recipe, direction: Array) -> FoldSolution:
    """The folding solution along the unit `direction` (3,), as large as it can be printed in its posture.

    Where the recipe leaves the thickness of plates open, they are made thinner until all of it folds.

    Raises:
        AbstractionError: the parts make no scaffold along it; the message names directions that would do.
        FoldingError: nothing folds, or it does not fit.
    """
    from foldfab.folding.work import Work

    if not recipe.print.may_thin:
        return _fitted(recipe, direction, Work(recipe.fold.time_limit))
    found, loses = _by_thickness(recipe, direction)
    best = min(found, key=_gone)
    if best.scaffold.recipe.print.thickness == recipe.print.thickness:
        return best
    lost = "parts would have to go" if loses else "it would not fold"
    why = f"plates are {best.thickness.panel:g} mm thick because with thicker ones {lost}"
    return replace(best, notes=(*best.notes, why))


def _by_thickness(recipe: Recipe, direction: Array) -> tuple[list[FoldSolution], bool]:
    """Solutions with thinner and thinner plates until all of it folds, thicker ones first and at least one; and whether
    parts have to go with thicker ones.

    Where parts have to go in any case, it is solved only once thinner plates are known to spare none of them.
    """
    from foldfab.folding.work import Work

    found: dict[float, FoldSolution] = {}
    put_off: dict[float, int] = {}
    refused: list[FoldingError] = []

    limit = left = recipe.fold.time_limit

    def attempt(panel: float, most: int | None, worth: int | None) -> None:
        nonlocal left
        work = Work(max(left, LEAST_SHARE * limit))
        try:
            found[panel] = _fitted(_with_plates(recipe, panel), direction, work, most, worth)
        except LossError as error:
            put_off[panel] = error.gone
        except FoldingError as error:
            refused.append(error)
        left -= work.spent

    for panel in _thicknesses(recipe):
        least = min(map(_gone, found.values()), default=1)
        attempt(panel, least - 1, least - 1 if found else None)
        if panel in found and not _gone(found[panel]):
            break
    for gone, panel in sorted((gone, -panel) for panel, gone in put_off.items()):
        every = max(gone, len(recipe.parts))
        least, best = min(((_gone(s), -k) for k, s in found.items()), default=(every, 0.0))
        # What loses as much is better with thicker plates.
        if (gone, panel) < (least, best):
            attempt(-panel, least, least)
    if not found:
        raise refused[-1]
    return [found[panel] for panel in sorted(found, reverse=True)], len(found) > 1 or bool(put_off)


def _thicknesses(recipe: Recipe) -> tuple[float, ...]:
    """The thicknesses of plates that are tried, mm: those in which hinges of its kind can be made and hold."""
    own = recipe.print
    able = [panel for panel in THINNER if own.clearance <= HELD_SHARE * panel]
    thinner = [panel for panel in able if panel < own.thickness and not hinge_problem(own.hinge, panel, None)]
    return (own.thickness, *thinner)


def _with_plates(recipe: Recipe, panel: float) -> Recipe:
    return replace(recipe, print=replace(recipe.print, thickness=panel, may_thin=False))


def _gone(solution: FoldSolution) -> int:
    return sum(m.is_deleted for m in solution.modifications)


def _fitted(
    recipe: Recipe, direction: Array, work: Work, most: int | None = None, worth: int | None = None
) -> FoldSolution:
    """The solution with plates as they are; `work`, `most` and `worth` as in `foldfab.folding.solve`."""
    from foldfab.fabrication.room import share_of_bed
    from foldfab.folding.solve import solve
    from foldfab.folding.work import Work

    posture = settled_posture(recipe)
    if recipe.print.scale is not None:
        return _standing(solve(abstracted(recipe, direction, recipe.print.scale), work, most, worth), posture)
    scale = _fitting_scale(recipe, direction, posture)
    for _ in range(SCALE_ROUNDS):
        round_work = Work(work.limit)
        solution = _standing(solve(abstracted(recipe, direction, scale), round_work, most, worth), posture)
        work.charge(round_work.spent)
        share = share_of_bed(solution, posture)
        if share <= 1.0:
            return solution
        scale *= 0.99 / share
    raise FoldingError(
        f"{recipe.name}, {posture}, does not fit the {recipe.print.printer.name}; give a scale below {scale:.3g}"
    )


def settled_posture(recipe: Recipe) -> Posture:
    """The posture of a recipe that no longer leaves it open.

    Raises:
        FoldingError: it does.
    """
    if recipe.print.posture == "auto":
        raise FoldingError(f"{recipe.name}: its posture is auto; call foldfab.postures.settled_posture(recipe) first")
    return recipe.print.posture


def _standing(solution: FoldSolution, posture: Posture) -> FoldSolution:
    """The solution itself, if it can be printed in its posture."""
    from foldfab.fabrication.posture import edge_problem

    problem = edge_problem(solution) if posture == "edge" else None
    if problem:
        raise FoldingError(f"{solution.scaffold.recipe.name}: {problem}")
    return solution


def abstracted(recipe: Recipe, direction: Array, scale: float) -> Scaffold:
    """The scaffold along `direction` at `scale`, with why it is that direction where it was chosen for the maker.

    Raises:
        AbstractionError: there is none; the message names directions that would do.
    """
    from foldfab.scaffold.abstract import abstract

    try:
        made = abstract(recipe, direction, scale)
        return replace(made, notes=(recipe.why, *made.notes)) if recipe.why else made
    except AbstractionError as error:
        able = [name for name, axis in AXES.items() if name[0] == "-" and _has_scaffold(recipe, axis, scale)]
        advice = f"try --direction {' or '.join(able)}" if able else "no axis direction gives a scaffold"
        raise AbstractionError(f"{recipe.name} along {title(direction)}: {error}; {advice}", error.parts) from error


def _has_scaffold(recipe: Recipe, axis: tuple[int, int, int], scale: float) -> bool:
    from foldfab.scaffold.abstract import abstract

    try:
        return bool(abstract(recipe, np.array(axis, dtype=np.float64), scale).patches)
    except AbstractionError:
        return False


def _fitting_scale(recipe: Recipe, direction: Array, posture: Posture) -> float:
    """About the largest scale at which the furniture fits the bed in its posture, either way round."""
    from foldfab.fabrication.room import largest_scale
    from foldfab.scaffold.frame import canonical, straight

    thickest = max(recipe.print.thickness, recipe.print.base_thickness or 0.0)
    bed = np.array(recipe.print.printer.build_volume) - MARGIN_THICKNESSES * thickest
    if (bed <= 0).any():
        raise FoldingError(f"the {recipe.print.printer.name} is too small for plates of {thickest:g} mm")
    turn = straight(recipe) if posture == "open" else canonical(recipe, direction)
    return largest_scale(recipe, posture, _size(recipe, turn), bed)


def _size(recipe: Recipe, turn: Array) -> Array:
    """(3,) true size of the furniture's bounds in axes turned by `turn` (3, 3), mm."""
    reach = np.array([np.abs(turn @ p.axes.T) @ p.size / 2 for p in recipe.parts])
    center = np.array([turn @ p.center for p in recipe.parts])
    size: Array = (center + reach).max(0) - (center - reach).min(0)
    return size
