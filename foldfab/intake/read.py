"""The verb: a file of shapes, or a build123d object, becomes a Recipe; and a recipe's own files become its parts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from foldfab.errors import Problem, RecipeError
from foldfab.intake.files import shapes
from foldfab.intake.inside import inside
from foldfab.intake.limits import fail
from foldfab.intake.meshes import joined
from foldfab.intake.model import Body, Shapes, Wishes
from foldfab.intake.understand import Grouping, fits, named, parts
from foldfab.recipe.build import box_part, flagged
from foldfab.recipe.form import MILLIMETRES, PartForm, RecipeForm
from foldfab.recipe.model import FoldOptions, Part, PrintOptions, Recipe
from foldfab.recipe.names import folder_name, folder_name_problem, same_name
from foldfab.recipe.printers import DEFAULT_PRINTER
from foldfab.recipe.problems import shown

if TYPE_CHECKING:
    import build123d

_MOST_NAMES = 30
"""More parts than these are counted, not listed."""


def read(path: Path, wishes: Wishes) -> Recipe:
    """The furniture in a file of shapes, or in a folder of STL files, with all options at their defaults.

    Raises:
        RecipeError: it cannot be read or understood.
        MissingLibraryError: a library that its format needs is absent.
    """
    name = path.resolve().name if path.is_dir() else path.stem
    return _recipe(name, str(path), shapes(path), wishes)


def from_cad(shape: build123d.Shape, wishes: Wishes) -> Recipe:
    """The furniture in a build123d object, named by its label.

    Raises:
        RecipeError: it holds no solids.
    """
    from foldfab.intake.solids import read as read_solids

    name = shape.label or "furniture"
    return _recipe(name, name, read_solids(shape, name), wishes)


def parts_of(form: RecipeForm, path: Path, wishes: Wishes) -> tuple[tuple[Part, ...], tuple[str, ...]]:
    """The parts of a recipe that names files of shapes: those of its model with their flags, and those of its own.

    Raises:
        RecipeError: a file is absent, outside the recipe's folder or damaged, or a part is not in the model.
    """
    found: list[Part] = []
    notes: list[str] = []
    default = form.units if "units" in form.model_fields_set else None
    if form.model is not None:
        found += _of_model(path, form, replace(wishes, default_units=default), notes)
    for index, own in enumerate(form.parts):
        if own.box is not None:
            found.append(box_part(own, own.box, MILLIMETRES[form.units], form.fold.shrink_steps))
        elif own.mesh is not None:
            asked = replace(wishes, default_units=form.units, split_shells=False, smallest=0.0)
            part = _of_mesh(inside(path, own.mesh, f"parts[{index}].mesh"), own.name, asked, notes)
            found.append(flagged(part, own, form.fold.shrink_steps))
    _check_names(path, found)
    return tuple(found), tuple(notes)


def _of_model(path: Path, form: RecipeForm, wishes: Wishes, notes: list[str]) -> list[Part]:
    file = inside(path, str(form.model), "model")
    bodies, told = named(file, shapes(file), wishes)
    flags = {i: part for i, part in enumerate(form.parts) if part.box is None and part.mesh is None}
    _check_flags(path, flags, [body.name for body in bodies])
    merged = {part.name: part.merge for part in flags.values() if part.merge is not None}
    ignored = tuple(part.name for part in flags.values() if part.ignore)
    kept = tuple(part.name for part in flags.values() if not part.ignore)
    found, more = parts(file, bodies, wishes, Grouping(ignored, tuple(merged.items()), kept))
    notes += [*told, *more]
    for flag in flags.values():
        pattern = merged.get(flag.name, flag.name)
        found = tuple(flagged(p, flag, form.fold.shrink_steps) if fits(p.name, pattern) else p for p in found)
    return list(found)


def _of_mesh(file: Path, name: str, wishes: Wishes, notes: list[str]) -> Part:
    """All bodies of a file as one part."""
    held = shapes(file)
    whole = Body(name, joined([body.mesh for body in held.bodies]))
    bodies, told = named(file, replace(held, bodies=(whole,)), wishes)
    found, more = parts(file, bodies, wishes, Grouping())
    notes += [f"{name}: {note}" for note in (*told, *more)]
    return replace(found[0], name=name)


def _check_flags(path: Path, flags: dict[int, PartForm], names: list[str]) -> None:
    """Raises: RecipeError: entries that fit no body of the model."""
    rest = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
    known = ", ".join(names[:_MOST_NAMES]) + rest
    problems = [
        Problem(f"parts[{index}].name", f"{shown(flag.name)} fits no body of the model; there are {known}")
        for index, flag in flags.items()
        if not any(fits(name, flag.name) for name in names)
    ]
    if problems:
        raise RecipeError(str(path), tuple(problems))


def _check_names(path: Path, found: list[Part]) -> None:
    """Raises: RecipeError: a part of the recipe has the name of one of the model, or there is none at all."""
    seen: set[str] = set()
    for part in found:
        key = same_name(part.name)
        if key in seen:
            fail(path, f"{shown(part.name)} stands in the model and among parts with a box or mesh; rename it", "parts")
        seen.add(key)


def _recipe(name: str, source: str, held: Shapes, wishes: Wishes) -> Recipe:
    bodies, notes = named(source, held, wishes)
    found, more = parts(source, bodies, wishes, Grouping())
    return Recipe(
        name=name if folder_name_problem(name) is None else folder_name(name),
        direction=None,
        parts=found,
        fold=FoldOptions(),
        print=PrintOptions(printer=DEFAULT_PRINTER),
        source=source,
        notes=(*notes, *more),
    )
