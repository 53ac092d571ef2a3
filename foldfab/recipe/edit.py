"""A Recipe with some of its options replaced by those of the command line, under the same rules."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from foldfab.errors import Problem, RecipeError
from foldfab.recipe.build import build_print, unit_direction
from foldfab.recipe.clearance import profile
from foldfab.recipe.fields import Direction
from foldfab.recipe.form import FoldForm, Form, PrintForm
from foldfab.recipe.model import USUAL_THICKNESS, Part, Pattern, Printer, PrintOptions, Recipe
from foldfab.recipe.names import fits, same_name
from foldfab.recipe.patterns import hinges_problem, rigid_problem, window_problem
from foldfab.recipe.printers import printer as find_printer
from foldfab.recipe.problems import problems_of, shown

SOURCE = "command line"
_FLOATS = ("alpha", "time_limit")
"""Options of the fold that are numbers but not counts."""
_MOST_NAMES = 30
"""More parts than these are counted, not listed."""


class _DirectionForm(Form):
    direction: Direction = "auto"


def override(
    recipe: Recipe, *, direction: str | None = None, printer: str | None = None, rigid: Collection[str] = (),
    **options: str | float | bool | None,
) -> Recipe:  # fmt: skip
    """`recipe` with every value replaced that is not None, and the parts named in `rigid` no longer hingeable.

    Args:
        recipe: what is changed.
        direction: an axis such as "-x", a vector such as "0,0,-1", or "auto".
        printer: a known printer, or a build volume such as "200x200x180".
        rigid: names of parts.
        options: by name, those of `fold` and `print`. Numbers may come as text; a scale is "fit", a number, or a ratio
            such as "1:5".

    Raises:
        RecipeError: every value that is not allowed, with the option's name as its place.
        TypeError: there is no option of that name.
    """
    if "scale" in options:
        options["scale"] = _ratio(options["scale"])
    fold, made = _of(FoldForm, options), _of(PrintForm, options)
    if unknown := options.keys() - fold.keys() - made.keys() - {k for k, v in options.items() if v is None}:
        raise TypeError(f"there is no option {sorted(unknown)}")
    way = {} if direction is None else {"direction": _vector(direction)}
    wrong = _check(FoldForm, fold)
    problems = _check(_DirectionForm, way) + wrong + _check(PrintForm, _with_own(recipe, made))
    problems += [*_check_printer(printer), *_check_rigid(recipe, rigid)]
    problems += _check_patterns(recipe, {} if wrong else fold, rigid)
    if problems:
        raise RecipeError(SOURCE, tuple(problems))
    parts = tuple(replace(part, hingeable=False) if part.name in rigid else part for part in recipe.parts)
    return _replaced(replace(recipe, parts=parts), way, fold, made, printer)


def _of(form: type[Form], options: Mapping[str, Any]) -> dict[str, Any]:
    """The options that are fields of a form and given, with numbers for the texts that hold one."""
    present = {key: value for key, value in options.items() if value is not None and key in form.model_fields}
    return {key: _number(value) if isinstance(value, str) else value for key, value in present.items()}


def _with_own(recipe: Recipe, options: dict[str, Any]) -> dict[str, Any]:
    """The options with the recipe's own that others are judged by."""
    if not options.keys() & {"thickness", "posture", "hinge"}:
        return options
    own = recipe.print
    return {"thickness": own.thickness, "posture": own.posture, "hinge": own.hinge, **options}


def _replaced(
    recipe: Recipe, way: dict[str, Any], fold: dict[str, Any], options: dict[str, Any], printer: str | None
) -> Recipe:
    fold = {key: float(value) if key in _FLOATS else value for key, value in fold.items()}
    options = {key: float(value) if type(value) is int else value for key, value in options.items()}
    if options.get("scale") == "fit":
        options["scale"] = None
    if printer is not None:
        options["printer"] = find_printer(printer)
    options |= _thickness(options) | _clearance(recipe, options)
    return replace(
        recipe,
        direction=unit_direction(way["direction"]) if way else recipe.direction,
        fold=replace(recipe.fold, **fold),
        print=replace(recipe.print, **options),
    )


def _thickness(options: dict[str, Any]) -> dict[str, Any]:
    """The thickness, and whether it is for foldfab to say."""
    if "thickness" not in options:
        return {}
    is_auto = options["thickness"] == "auto"
    return {"thickness": USUAL_THICKNESS if is_auto else options["thickness"], "may_thin": is_auto}


def _clearance(recipe: Recipe, options: dict[str, Any]) -> dict[str, Any]:
    """The clearance and where it comes from; by profile anew where it is not the recipe's own."""
    if options.get("clearance", "auto") != "auto":
        return {"clearance_from": "command line"}
    if "clearance" not in options and recipe.print.clearance_from != "profile":
        return {}
    machine = [options.get(name, getattr(recipe.print, name)) for name in ("nozzle", "layer", "material")]
    return {"clearance": profile(*machine), "clearance_from": "profile"}


def _number(text: str) -> int | float | str:
    """The number that a text holds, the text itself where it holds none."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _ratio(scale: str | float | bool | None) -> str | float | bool | None:
    """The number behind 1:5 or 1/5, anything else as it came."""
    ratio = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*[:/]\s*(\d+(?:\.\d+)?)\s*", scale) if isinstance(scale, str) else None
    if ratio is None or float(ratio[2]) == 0:
        return scale
    return float(ratio[1]) / float(ratio[2])


def _vector(direction: str) -> str | list[int | float | str]:
    text = direction.strip()
    return [_number(entry.strip()) for entry in text.strip("[]()").split(",")] if "," in text else text


def _check(form: type[Form], given: dict[str, Any]) -> list[Problem]:
    try:
        form.model_validate(given)
    except ValidationError as error:
        return [Problem(_option(problem.place), problem.text) for problem in problems_of(error)]
    return []


def without(recipe: Recipe, patterns: Collection[str]) -> Recipe:
    """The recipe without the parts whose names fit a pattern.

    Raises:
        RecipeError: a pattern fits no part, or all are gone.
    """
    check_patterns(patterns, [part.name for part in recipe.parts])
    parts = tuple(part for part in recipe.parts if not any(fits(part.name, pattern) for pattern in patterns))
    if not parts:
        raise RecipeError(SOURCE, (Problem("--ignore", "leaves nothing; ignore less"),))
    left = {part.name for part in parts}
    touching, apart = ([pair for pair in pairs if left.issuperset(pair)] for pairs in (recipe.touching, recipe.apart))
    return replace(recipe, parts=parts, touching=tuple(touching), apart=tuple(apart))


def check_patterns(patterns: Collection[str], names: list[str]) -> None:
    """Raises: RecipeError: what is to be ignored fits no name."""
    unknown = [shown(pattern) for pattern in patterns if not any(fits(name, pattern) for name in names)]
    if unknown:
        text = f"{' and '.join(unknown)} fits no part; there are {_listed(names)}"
        raise RecipeError(SOURCE, (Problem("--ignore", text),))


def known_printer(text: str) -> Printer:
    """The printer of that name or build volume.

    Raises:
        RecipeError: there is none.
    """
    problems = _check_printer(text)
    if problems:
        raise RecipeError(SOURCE, tuple(problems))
    return find_printer(text)


def known_print(**options: Any) -> PrintOptions:
    """The options of a print from texts, on the default printer.

    Raises:
        RecipeError: every value that is not allowed.
    """
    given = _of(PrintForm, options)
    problems = _check(PrintForm, given)
    if problems:
        raise RecipeError(SOURCE, tuple(problems))
    return build_print(PrintForm.model_validate(given))


def _check_printer(text: str | None) -> list[Problem]:
    try:
        if text is not None:
            find_printer(text)
    except ValueError as error:
        return [Problem("--printer", str(error))]
    return []


def _check_rigid(recipe: Recipe, rigid: Collection[str]) -> list[Problem]:
    names = [part.name for part in recipe.parts]
    unknown = [_unknown_part(name, names) for name in dict.fromkeys(rigid) if name not in names]
    if not unknown:
        return []
    return [Problem("--rigid", f"no part is named {' or '.join(unknown)}; there are {_listed(names)}")]


def _listed(names: list[str]) -> str:
    rest = [f"and {len(names) - _MOST_NAMES} more"] if len(names) > _MOST_NAMES else []
    return ", ".join([*names[:_MOST_NAMES], *rest])


def _check_patterns(recipe: Recipe, fold: dict[str, Any], rigid: Collection[str]) -> list[Problem]:
    """A problem for each pinned or forbidden modification that an option has made impossible."""
    found: list[tuple[str, str, str | None]] = []
    for where, part, pattern in _patterns(recipe):
        if pattern.window is not None:
            text = window_problem(pattern.window, fold.get("shrink_steps"))
            found.append(("--shrink-steps", f"{where}.window", text))
        if pattern.hinges is not None:
            found.append(("--max-hinges", f"{where}.hinges", hinges_problem(pattern.hinges, fold.get("max_hinges"))))
        if part.name in rigid and pattern is part.pin:
            found.append(("--rigid", where, rigid_problem(pattern)))
    return [Problem(option, f"contradicts {where}: {text}") for option, where, text in found if text]


def _patterns(recipe: Recipe) -> Iterator[tuple[str, Part, Pattern]]:
    """All that is pinned or forbidden, with its place and part."""
    for index, part in enumerate(recipe.parts):
        if part.pin is not None:
            yield f"parts[{index}].pin", part, part.pin
        for number, pattern in enumerate(part.forbid):
            yield f"parts[{index}].forbid[{number}]", part, pattern


def _unknown_part(name: str, names: list[str]) -> str:
    """The name, and those that may have been meant."""
    keys = {same_name(known): known for known in names}
    close = [keys[key] for key in get_close_matches(same_name(name), keys, n=3)]
    return f"{shown(name)} (did you mean {' or '.join(close)}?)" if close else shown(name)


def _option(place: str) -> str:
    """`max_hinges` as it is written on the command line."""
    return "--" + place.split("[")[0].replace("_", "-")
