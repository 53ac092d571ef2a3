"""A recipe's form becomes a Recipe: millimetres, exact axes, a unit direction."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.recipe.clearance import profile
from foldfab.recipe.contacts import BY_BOXES, Contacts, beside, resolved
from foldfab.recipe.fields import MILLIMETRES
from foldfab.recipe.form import BoxForm, FoldForm, PartForm, PatternForm, PrinterForm, PrintForm, RecipeForm
from foldfab.recipe.model import USUAL_THICKNESS, FoldOptions, Part, Pattern, Printer, PrintOptions, Recipe
from foldfab.recipe.patterns import snapped
from foldfab.recipe.printers import PRINTERS

_EXACT = 1e-12
"""Closer than this to unit length or right angles is left as it is: reading what was written changes nothing."""
_QUARTER_TURN = 1e-9


@dataclass(frozen=True, slots=True)
class Gathered:
    """The parts of a recipe, whatever files they came from."""

    parts: tuple[Part, ...]
    notes: tuple[str, ...] = ()
    """What had to be supposed or left out."""
    contacts: Contacts = BY_BOXES
    """What was found out about which of them touch."""


def build(form: RecipeForm, name: str, source: str, gathered: Gathered) -> Recipe:
    """The recipe that a valid form describes, with the parts that were made of it.

    Raises:
        RecipeError: what it states about contacts fits no parts.
    """
    stated = resolved(form.touching, form.apart, gathered.parts, source)
    contacts = beside(stated, gathered.contacts)
    return Recipe(
        name=name,
        direction=unit_direction(form.direction),
        parts=gathered.parts,
        fold=_fold(form.fold),
        print=build_print(form.print),
        about=form.about,
        source=source,
        notes=gathered.notes,
        touching=tuple(sorted(contacts.touching)),
        apart=tuple(sorted(contacts.apart)),
    )


def boxes(form: RecipeForm) -> Gathered:
    """The parts of a form all of whose parts are boxes."""
    factor, steps = MILLIMETRES[form.units], form.fold.shrink_steps
    return Gathered(tuple(box_part(part, part.box, factor, steps) for part in form.parts if part.box is not None))


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


def box_part(form: PartForm, box: BoxForm, factor: float, steps: int) -> Part:
    """The part that is a box, with its flags; `factor` is the mm of a unit, `steps` the recipe's shrink_steps."""
    part = Part(
        name=form.name,
        center=np.array(box.center) * factor,
        size=np.array(box.size) * factor,
        axes=np.eye(3) if box.axes is None else rotation(box.axes),
    )
    return flagged(part, form, steps)


def flagged(part: Part, form: PartForm, steps: int) -> Part:
    """The part with every flag that a form sets."""
    flags: dict[str, Any] = {
        "hingeable": form.hingeable,
        "pin": None if form.pin is None else _pattern(form.pin, steps),
        "forbid": tuple(_pattern(pattern, steps) for pattern in form.forbid),
        "thickness": None if form.thickness is None else float(form.thickness),
        "look": form.shape,
    }
    said = form.model_fields_set | ({"look"} if "shape" in form.model_fields_set else set())
    return replace(part, **{key: value for key, value in flags.items() if key in said})


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


def build_print(form: PrintForm) -> PrintOptions:
    """The options of a print that a valid form describes."""
    is_auto = form.clearance == "auto"
    clearance = profile(form.nozzle, form.layer, form.material) if is_auto else float(form.clearance)
    return PrintOptions(
        printer=_printer(form.printer),
        thickness=USUAL_THICKNESS if form.thickness == "auto" else float(form.thickness),
        may_thin=form.thickness == "auto",
        base_thickness=None if form.base_thickness is None else float(form.base_thickness),
        own_thickness=form.own_thickness,
        clearance=clearance,
        clearance_from="profile" if is_auto else "recipe",
        nozzle=float(form.nozzle),
        layer=float(form.layer),
        material=form.material,
        posture=form.posture,
        hinge=form.hinge,
        shape=form.shape,
        latch=form.latch,
        scale=None if form.scale == "fit" else float(form.scale),
    )


def _printer(choice: str | PrinterForm) -> Printer:
    if isinstance(choice, str):
        return PRINTERS[choice]
    x, y, z = choice.build_volume
    return Printer(choice.name, (float(x), float(y), float(z)))
