"""The verb: a file of shapes, or a build123d object, becomes a Recipe; and a recipe's own files become its parts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from foldfab.errors import Problem, RecipeError
from foldfab.intake.contacts import contacts, told
from foldfab.intake.files import shapes
from foldfab.intake.inside import inside
from foldfab.intake.limits import fail
from foldfab.intake.loose import loose
from foldfab.intake.meshes import joined
from foldfab.intake.model import Body, Shapes, Wishes
from foldfab.intake.naming import part_name
from foldfab.intake.understand import Grouping, Understood, named, parts
from foldfab.recipe.build import Gathered, box_part, flagged
from foldfab.recipe.edit import check_patterns
from foldfab.recipe.fields import MILLIMETRES
from foldfab.recipe.form import PartForm, RecipeForm
from foldfab.recipe.model import FoldOptions, Part, PrintOptions, Recipe
from foldfab.recipe.names import fits, folder_name, folder_name_problem, same_name
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


def parts_of(form: RecipeForm, path: Path, wishes: Wishes) -> Gathered:
    """The parts of a recipe that names files of shapes: those of its model with their flags, and those of its own.

    Raises:
        RecipeError: a file is absent, outside the recipe's folder or damaged, or a part is not in the model.
    """
    default = form.units if "units" in form.model_fields_set else None
    own = [part for part in form.parts if part.box is not None or part.mesh is not None]
    held, names = Understood((), (), ()), [part.name for part in own]
    if form.model is not None:
        held, bodies = _of_model(path, form, replace(wishes, default_units=default))
        names += bodies
    check_patterns(wishes.ignore, names)
    found, notes = list(held.parts), list(held.notes)
    for index, part in enumerate(form.parts):
        if any(fits(part.name, pattern) for pattern in wishes.ignore):
            continue
        if part.box is not None:
            found.append(box_part(part, part.box, MILLIMETRES[form.units], form.fold.shrink_steps))
        elif part.mesh is not None:
            asked = replace(wishes, default_units=form.units, split_shells=False, smallest=0.0)
            made = _of_mesh(inside(path, part.mesh, f"parts[{index}].mesh"), part.name, asked, notes)
            found.append(flagged(made, part, form.fold.shrink_steps))
    if not found:
        fail(path, "nothing is left of it; ignore less")
    _check_names(path, found)
    met = contacts(tuple(found), held.hardware)
    return Gathered(tuple(found), (*notes, *told(met)), met)


def _of_model(path: Path, form: RecipeForm, wishes: Wishes) -> tuple[Understood, list[str]]:
    """The model's parts with their flags, and the names of its bodies."""
    file = inside(path, str(form.model), "model")
    bodies, first = named(file, shapes(file), wishes)
    names = [body.name for body in bodies]
    flags = {i: part for i, part in enumerate(form.parts) if part.box is None and part.mesh is None}
    _check_flags(path, flags, names)
    merged = {part.name: part.merge for part in flags.values() if part.merge is not None}
    ignored = (*wishes.ignore, *(part.name for part in flags.values() if part.ignore))
    kept = tuple(part.name for part in flags.values() if not part.ignore)
    heaps = frozenset(part.name for part in flags.values() if part.by_contact)
    held = parts(file, bodies, wishes, Grouping(ignored, tuple(merged.items()), heaps, kept))
    found = held.parts
    for flag in flags.values():
        is_meant = _meant(flag, held)
        found = tuple(flagged(p, flag, form.fold.shrink_steps) if p.name in is_meant else p for p in found)
    return replace(held, parts=found, notes=(*first, *held.notes)), names


def _meant(flag: PartForm, held: Understood) -> set[str]:
    """The names of the parts that an entry of the recipe is about."""
    if flag.merge is not None:
        return {name for name, asked in held.made.items() if asked == part_name(flag.merge)}
    return {part.name for part in held.parts if fits(part.name, flag.name)}


def _of_mesh(file: Path, name: str, wishes: Wishes, notes: list[str]) -> Part:
    """All bodies of a file as one part."""
    held = shapes(file)
    whole = Body(name, joined([body.mesh for body in held.bodies]))
    bodies, first = named(file, replace(held, bodies=(whole,)), wishes)
    found = parts(file, bodies, wishes, Grouping())
    notes += [f"{name}: {note}" for note in (*first, *found.notes)]
    return replace(found.parts[0], name=name)


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
    check_patterns(wishes.ignore, [body.name for body in bodies])
    found = parts(source, bodies, wishes, Grouping(ignored=wishes.ignore))
    met = contacts(found.parts, found.hardware)
    lost = loose(found.parts, met)
    stated = met.among({part.name for part in found.parts} - lost.names)
    return Recipe(
        name=name if folder_name_problem(name) is None else folder_name(name),
        direction=None,
        parts=tuple(part for part in found.parts if part.name not in lost.names),
        fold=FoldOptions(),
        print=PrintOptions(printer=DEFAULT_PRINTER),
        source=source,
        notes=(*notes, *found.notes, *told(stated), *lost.notes),
        touching=tuple(sorted(stated.touching)),
        apart=tuple(sorted(stated.apart)),
    )
