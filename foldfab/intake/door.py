"""Whatever furniture comes in as: a recipe, a file of shapes, a folder of STL files, or an object of build123d."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

from foldfab.errors import Problem, RecipeError
from foldfab.intake.files import is_shapes
from foldfab.intake.model import Wishes
from foldfab.intake.scale import check
from foldfab.recipe.build import Gathered
from foldfab.recipe.edit import without
from foldfab.recipe.find import find
from foldfab.recipe.form import RecipeForm
from foldfab.recipe.model import Recipe
from foldfab.recipe.read import read as read_recipe

if TYPE_CHECKING:
    import build123d


def load(source: str | Path | build123d.Shape, wishes: Wishes) -> Recipe:
    """The furniture in `source`.

    Raises:
        RecipeError: every problem with it, or with what is wished of it.
        MissingLibraryError: a library that the file's format needs is absent.
    """
    check(wishes)
    if not isinstance(source, str | Path):
        from foldfab.intake.read import from_cad

        return from_cad(source, wishes)
    path = find(str(source))
    if is_shapes(path):
        from foldfab.intake.read import read

        return read(path, wishes)

    named_files = False

    def parts_of(form: RecipeForm, file: Path) -> Gathered:
        nonlocal named_files
        from foldfab.intake.read import parts_of as made

        named_files = True
        return made(form, file, wishes)

    recipe = read_recipe(path, parts_of)
    if named_files:
        return recipe
    _refuse(replace(wishes, ignore=()))
    return without(recipe, wishes.ignore) if wishes.ignore else recipe


def _refuse(wishes: Wishes) -> None:
    """Raises: RecipeError: something is wished of shapes where there are none."""
    given = [field.name for field in fields(wishes) if getattr(wishes, field.name) != field.default]
    text = "is for files of shapes, and this recipe has none"
    if given:
        raise RecipeError("command line", tuple(Problem(f"--{name.replace('_', '-')}", text) for name in given))
