"""A recipe file becomes a Recipe, or one error that lists everything that is wrong with it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from pydantic import ValidationError

from foldfab.errors import Problem, RecipeError
from foldfab.recipe.build import Gathered, boxes, build
from foldfab.recipe.document import load, repeated_keys
from foldfab.recipe.fields import MILLIMETRES
from foldfab.recipe.form import FoldForm, RecipeForm
from foldfab.recipe.model import Recipe
from foldfab.recipe.names import folder_name, folder_name_problem, same_name
from foldfab.recipe.problems import EXPECTED, TOP, problems_of, shown

MOST_PROBLEMS = 500
"""More than these are counted, not listed."""


PartsOf = Callable[[RecipeForm, Path], Gathered]
"""What makes the parts of a recipe that names files of shapes: a room above this one."""


def read(path: Path, parts_of: PartsOf | None = None) -> Recipe:
    """The recipe in a JSON file; its name is by default the file's, without `.json`.

    Raises:
        RecipeError: every problem of the file at once, each with its place.
    """
    source = str(path)
    form = understood(load(path), source, path.stem)
    if parts_of is None or not names_files(form):
        return _of_boxes(form, path.stem, source)
    return build(form, form.name or path.stem, source, parts_of(form, path))


def parse(data: object, source: str, default_name: str) -> Recipe:
    """The recipe in JSON data; `source` is for messages, `default_name` for recipes that have none.

    Raises:
        RecipeError: every problem of the data at once, each with its place.
    """
    return _of_boxes(understood(data, source, default_name), default_name, source)


def names_files(form: RecipeForm) -> bool:
    """Whether some of its parts lie in other files."""
    return form.model is not None or any(part.mesh is not None for part in form.parts)


def understood(data: object, source: str, default_name: str) -> RecipeForm:
    """The form that JSON data fill in.

    Raises:
        RecipeError: every problem of the data at once, each with its place.
    """
    if not isinstance(data, dict):
        raise RecipeError(source, (Problem(TOP, f"should be {EXPECTED['']}, not {shown(data)}"),))
    form, problems = _form(data)
    problems += repeated_keys(data) + _missing(data) + _repeated_names(data.get("parts"))
    problems += _default_name(data, default_name)
    if form is None or problems:
        raise RecipeError(source, _limited(problems))
    return form


def _of_boxes(form: RecipeForm, default_name: str, source: str) -> Recipe:
    if names_files(form):
        text = "names a file, which is looked for beside a recipe's file; this is none"
        raise RecipeError(source, (Problem("parts" if form.model is None else "model", text),))
    return build(form, form.name or default_name, source, boxes(form))


def _form(data: dict[str, object]) -> tuple[RecipeForm | None, list[Problem]]:
    units = data.get("units", "mm")
    factor = MILLIMETRES.get(units, 1.0) if isinstance(units, str) else 1.0
    context = {"factor": factor, "globs": "model" in data, **_limits(data.get("fold"))}
    try:
        return RecipeForm.model_validate(data, context=context), []
    except ValidationError as error:
        return None, problems_of(error)


def _limits(fold: object) -> dict[str, int]:
    """What patterns are judged by, as far as the recipe says it well."""
    given = fold if isinstance(fold, dict) else {}
    limits = {}
    for name in ("shrink_steps", "max_hinges"):
        try:
            limits[name] = getattr(FoldForm.model_validate({name: given[name]} if name in given else {}), name)
        except ValidationError:
            continue
    return limits


def _missing(data: dict[str, object]) -> list[Problem]:
    """Without a model there have to be parts, each with a box or a mesh."""
    if "model" in data:
        return []
    parts = data.get("parts")
    if "parts" not in data:
        return [Problem("parts", f'is missing; give {EXPECTED["parts"]}, or a "model"')]
    if parts == []:
        return [Problem("parts", f"should be {EXPECTED['parts']}, not {shown(parts)}")]
    listed = enumerate(parts) if isinstance(parts, list) else ()
    bare = [index for index, part in listed if isinstance(part, dict) and not {"box", "mesh"} & part.keys()]
    return [Problem(f"parts[{index}].box", f'is missing; give {EXPECTED["box"]}, or a "mesh"') for index in bare]


def _repeated_names(parts: object) -> list[Problem]:
    """A problem for each part whose name, or nearly so, an earlier one has."""
    problems: list[Problem] = []
    seen: dict[str, tuple[int, str]] = {}
    for index, name in _names(parts):
        first, other = seen.setdefault(same_name(name), (index, name))
        if first != index:
            how = "repeats the name" if name == other else "differs only by case or spelling from the name"
            text = f"{how} {shown(other)} of parts[{first}]; every part needs a name of its own"
            problems.append(Problem(f"parts[{index}].name", text))
    return problems


def _names(parts: object) -> list[tuple[int, str]]:
    if not isinstance(parts, list):
        return []
    named = [(index, part.get("name")) for index, part in enumerate(parts) if isinstance(part, dict)]
    return [(index, name) for index, name in named if isinstance(name, str) and name.strip()]


def _default_name(data: dict[str, object], name: str) -> list[Problem]:
    """A problem where the recipe takes its name from a file whose name cannot be a folder's."""
    if "name" in data or folder_name_problem(name) is None:
        return []
    text = f'is missing, and {shown(name)} cannot be a folder\'s name; add "name": "{folder_name(name)}"'
    return [Problem("name", text)]


def _limited(problems: list[Problem]) -> tuple[Problem, ...]:
    if len(problems) <= MOST_PROBLEMS:
        return tuple(problems)
    rest = Problem(TOP, f"has {len(problems) - MOST_PROBLEMS} more problems; mend these first")
    return (*problems[:MOST_PROBLEMS], rest)
