"""What single change would make furniture fold that does not: each is tried, and what works is named."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from foldfab import pipeline
from foldfab.errors import FoldfabError
from foldfab.recipe.model import Part, Recipe
from foldfab.scaffold.directions import AXES, lines

MOST_PARTS = 60
"""Furniture with more parts is not tried part by part."""
MORE_HINGES = 2
FINER = 2
"""By how many hinges more, and by how many times finer shrinking, a patch is tried."""
THINNEST = 2.0
"""mm; thinner plates cannot be printed."""


def what_would_help(recipe: Recipe) -> tuple[str, ...]:
    """The single changes with which a recipe that does not fold would, each a few words; at worst a solve for each."""
    found: list[str] = []
    for text, changed in _changes(recipe):
        # Up folds where down does, most of the time; one of the two is enough to know.
        if text.replace("+", "-") not in found and _folds(changed):
            found.append(text)
    return tuple(found)


def _folds(recipe: Recipe) -> bool:
    """Whether it folds along its direction, or along any that is tried where it names none."""
    if recipe.direction is None:
        ways = [way for line in lines(recipe) for way in (line.direction, 0.0 - line.direction)]
        return any(_folds(replace(recipe, direction=way)) for way in ways)
    try:
        pipeline.foldabilize(recipe)
    except FoldfabError:
        return False
    return True


def _changes(recipe: Recipe) -> Iterator[tuple[str, Recipe]]:
    fold = recipe.fold
    if not fold.slanting:
        yield "with slanting allowed", replace(recipe, fold=replace(fold, slanting=True))
    if fold.stay_in_box:
        yield "if it may leave its bounding box", replace(recipe, fold=replace(fold, stay_in_box=False))
    if recipe.print.own_thickness:
        plain = replace(recipe.print, own_thickness=False)
        yield f"with plates of {plain.thickness:g} mm instead of their own", replace(recipe, print=plain)
    yield from _freed(recipe)
    more = replace(fold, max_hinges=fold.max_hinges + MORE_HINGES)
    yield f"with up to {more.max_hinges} hinges a part", replace(recipe, fold=more)
    finer = replace(fold, shrink_steps=FINER * fold.shrink_steps)
    yield f"with windows of {finer.shrink_steps} steps", replace(recipe, fold=finer)
    thin = max(THINNEST, recipe.print.thickness / 2)
    if thin < recipe.print.thickness and not recipe.print.may_thin:
        yield f"with plates of {thin:g} mm", replace(recipe, print=replace(recipe.print, thickness=thin))
    for name, axis in AXES.items():
        other = np.array(axis, dtype=np.float64)
        if recipe.direction is not None and np.abs(other - recipe.direction).max() > 1e-6:
            yield f"along {name}", replace(recipe, direction=other)


def _freed(recipe: Recipe) -> Iterator[tuple[str, Recipe]]:
    """The recipe with what is asked of one part let go."""
    if len(recipe.parts) > MOST_PARTS:
        return
    for i, part in enumerate(recipe.parts):
        if not part.hingeable:
            yield f"if {part.name} may get a hinge", _with(recipe, i, replace(part, hingeable=True))
        if part.pin is not None or part.forbid:
            yield f"if {part.name} is left free", _with(recipe, i, replace(part, pin=None, forbid=()))


def _with(recipe: Recipe, index: int, part: Part) -> Recipe:
    return replace(recipe, parts=(*recipe.parts[:index], part, *recipe.parts[index + 1 :]))
