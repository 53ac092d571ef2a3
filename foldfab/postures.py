"""Which posture a print is best in: each one built at the same scale and sliced, or a rule where there is no slicer."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, get_args

from foldfab import pipeline
from foldfab.errors import FoldfabError, MissingLibraryError
from foldfab.recipe.model import Posture, Recipe

if TYPE_CHECKING:
    from foldfab.fabrication.model import Assembly

POSTURES: tuple[Posture, ...] = get_args(Posture)
IN_PLACE: tuple[Posture, ...] = ("edge", "folded", "open")
"""What `auto` chooses from, by rule in this order: what is printed in one piece needs no assembling."""
SCALE_SLACK = 0.99
"""A scale at which one posture just fits, and another by its solids all but does, is taken a little smaller."""
SAME_SUPPORT = 1.0
"""Grams of support that are not worth another posture."""


@dataclass(frozen=True, slots=True)
class Row:
    """One posture of a recipe: what the slicer says of it, or why it does not print so."""

    posture: Posture
    problem: str = ""
    seconds: int = 0
    filament_g: float = 0.0
    support_g: float = 0.0
    height_mm: float = 0.0
    files: int = 0
    propped: int = 0
    """Parts that are printed with a prop to be broken off."""


def compared(recipe: Recipe, tell: Callable[[str], None] = lambda text: None) -> tuple[Row, ...]:
    """All postures at one scale: that of the recipe or, where it is to fit, the largest at which all in-place ones do.

    Raises:
        MissingLibraryError: PrusaSlicer is not installed.
        FoldfabError: the recipe does not fold.
    """
    from foldfab.slicing.program import find_slicer

    find_slicer()
    recipe = _scaled(pipeline.directed(recipe))
    rows = []
    for posture in POSTURES:
        tell(f"printing it {posture}")
        rows.append(_row(recipe, posture))
    return tuple(rows)


def settled(recipe: Recipe, tell: Callable[[str], None] = lambda text: None) -> Recipe:
    """The recipe with a posture instead of `auto`, and why it is that one."""
    if recipe.print.posture != "auto":
        return recipe
    # All postures of one fold are compared, and the direction is looked for once.
    recipe = pipeline.directed(recipe)
    try:
        rows = [row for row in compared(recipe, tell) if row.posture in IN_PLACE and not row.problem]
        if not rows:
            return _chosen(recipe, "open", "nothing else prints in one piece")
        best = min(rows, key=lambda r: (round(r.support_g / SAME_SUPPORT), r.seconds, r.height_mm))
        told = ", ".join(f"{r.posture} {r.support_g:.1f} g of support and {r.seconds / 3600:.1f} h" for r in rows)
        return _chosen(recipe, best.posture, f"least support, then least time, by PrusaSlicer: {told}")
    except MissingLibraryError:
        return _ruled(recipe)


def _ruled(recipe: Recipe) -> Recipe:
    """Without a slicer: on edge where nothing needs a prop there, else flat."""
    try:
        made = _built(_scaled(recipe), "edge")
    except FoldfabError:
        return _chosen(recipe, "folded", "no slicer is installed to ask, and it cannot stand on edge")
    if made.propped:
        return _chosen(recipe, "folded", "no slicer is installed to ask, and on edge parts would begin in the air")
    return _chosen(recipe, "edge", "no slicer is installed to ask; on edge all gaps are sideways and all parts stand")


def _chosen(recipe: Recipe, posture: Posture, why: str) -> Recipe:
    told = f"posture {posture} was chosen: {why}"
    return replace(recipe, print=replace(recipe.print, posture=posture, why=told))


def _scaled(recipe: Recipe) -> Recipe:
    if recipe.print.scale is not None:
        return recipe
    scales = []
    for posture in IN_PLACE:
        wanted = replace(recipe, print=replace(recipe.print, posture=posture))
        try:
            scales.append(pipeline.foldabilize(wanted).scaffold.scale)
        except FoldfabError:
            if posture == "open":
                raise
    return replace(recipe, print=replace(recipe.print, scale=SCALE_SLACK * min(scales)))


def _built(recipe: Recipe, posture: Posture) -> Assembly:
    wanted = replace(recipe, print=replace(recipe.print, posture=posture))
    return pipeline.fabricate(pipeline.foldabilize(wanted))


def _row(recipe: Recipe, posture: Posture) -> Row:
    from foldfab.slicing.program import slice_print

    try:
        made = _built(recipe, posture)
        with tempfile.TemporaryDirectory() as folder:
            files = [p for p in pipeline.write(made, Path(folder) / recipe.name) if p.suffix == ".3mf"]
            reports = [slice_print(file, recipe.print.printer, support=True) for file in files]
    except MissingLibraryError:
        raise
    except FoldfabError as error:
        return Row(posture, " ".join(str(error).split()))
    return Row(
        posture,
        seconds=sum(r.seconds for r in reports),
        filament_g=sum(r.filament_g for r in reports),
        support_g=sum(r.support_g for r in reports),
        height_mm=max(r.height_mm for r in reports),
        files=len(reports),
        propped=len(made.propped),
    )
