"""A recipe's form becomes a Recipe: millimetres, exact axes, a unit direction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.recipe.form import MILLIMETRES, FoldForm, PartForm, PatternForm, PrinterForm, PrintForm, RecipeForm
from foldfab.recipe.model import FoldOptions, Part, Pattern, Printer, PrintOptions, Recipe
from foldfab.recipe.patterns import snapped
from foldfab.recipe.printers import PRINTERS

_EXACT = 1e-12
"""Closer than this to unit length or right angles is left as it is: reading what was written changes nothing."""
_QUARTER_TURN = 1e-9


def build(form: RecipeForm, name: str, source: str) -> Recipe:
    """The recipe that a valid form describes."""
    factor = MILLIMETRES[form.units]
    return Recipe(
        name=name,
        direction=unit_direction(form.direction),
        parts=tuple(_part(part, factor, form.fold.shrink_steps) for part in form.parts),
        fold=_fold(form.fold),
        print=_print(form.print),
        about=form.about,
        source=source,
    )


def unit_direction(direction: str | list[float]) -> Array | None:
    """(3,) unit vector of a named axis or of a vector that is not zero; None for "auto"."""
    if direction == "auto":
        return None
    if isinstance(direction, str):
        vector = np.zeros(3)
        vector["xyz".index(direction[-1])] = -1.0 if direction.startswith("-") else 1.0
        return vector
    vector = np.array(direction) / np.abs(direction).max() if _is_extreme(direction) else np.array(direction)
    length = float(np.linalg.norm(vector))
    return vector if abs(length - 1) <= _EXACT else vector / length


def rotation(rows: list[list[float]]) -> Array:
    """(3, 3) the exact rotation closest to nearly orthonormal right-handed rows."""
    matrix = np.array(rows)
    if np.abs(matrix - matrix.round()).max() <= _QUARTER_TURN:
        return matrix.round()
    if np.abs(matrix @ matrix.T - np.eye(3)).max() <= _EXACT:
        return matrix
    left, _, right = np.linalg.svd(matrix)
    return np.asarray(left @ right)


def _is_extreme(vector: list[float]) -> bool:
    """Whether squares of its entries leave the range of floats."""
    return not 1e-100 < max(abs(entry) for entry in vector) < 1e100


def _part(form: PartForm, factor: float, steps: int) -> Part:
    return Part(
        name=form.name,
        center=np.array(form.box.center) * factor,
        size=np.array(form.box.size) * factor,
        axes=np.eye(3) if form.box.axes is None else rotation(form.box.axes),
        hingeable=form.hingeable,
        pin=None if form.pin is None else _pattern(form.pin, steps),
        forbid=tuple(_pattern(pattern, steps) for pattern in form.forbid),
    )


def _pattern(form: PatternForm, steps: int) -> Pattern:
    """The pattern with its window exactly on the cuts."""
    pattern = form.pattern
    return pattern if pattern.window is None else replace(pattern, window=snapped(pattern.window, steps))


def _fold(form: FoldForm) -> FoldOptions:
    return FoldOptions(
        alpha=float(form.alpha),
        max_hinges=form.max_hinges,
        shrink_steps=form.shrink_steps,
        slanting=form.slanting,
        stay_in_box=form.stay_in_box,
        ordering=form.ordering,
        collisions=form.collisions,
        symmetry=form.symmetry,
        time_limit=float(form.time_limit),
    )


def _print(form: PrintForm) -> PrintOptions:
    return PrintOptions(
        printer=_printer(form.printer),
        thickness=float(form.thickness),
        clearance=float(form.clearance),
        posture=form.posture,
        hinge=form.hinge,
        latch=form.latch,
        scale=None if form.scale == "fit" else float(form.scale),
    )


def _printer(choice: str | PrinterForm) -> Printer:
    if isinstance(choice, str):
        return PRINTERS[choice]
    x, y, z = choice.build_volume
    return Printer(choice.name, (float(x), float(y), float(z)))
