"""The corridor: a recipe file becomes a print folder. The only module that knows the order of the rooms.

recipe   = load("bench.json")
solution = foldabilize(recipe)
assembly = fabricate(solution)
write(assembly, Path("prints/bench"))
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from foldfab.errors import AbstractionError, FoldingError, Problem, RecipeError
from foldfab.fitting import abstracted, along, settled_posture
from foldfab.recipe.model import Posture, Recipe

if TYPE_CHECKING:
    import build123d

    from foldfab.directions import Row
    from foldfab.export.report import Report
    from foldfab.fabrication.model import Assembly
    from foldfab.folding.model import FoldSolution
    from foldfab.validity.model import Verdict, Violation

Progress = Callable[[str], None]
"""Called with what is being done, one short line."""


def load(
    source: str | Path | build123d.Shape, *, units: str | None = None, up: str | None = None,
    split_shells: bool = False, smallest: float | None = None, ignore: Collection[str] = (), **overrides: Any,
) -> Recipe:  # fmt: skip
    """The furniture in a recipe, in a file of shapes, or in a build123d object, with options put over it.

    Args:
        source: a recipe's file or one that foldfab ships; a STEP, GLB, glTF, OBJ, 3MF, STL, URDF or MJCF file; a
            folder of STL files; or a build123d object.
        units: of a file of shapes, "mm", "cm", "m" or "in"; what it states, or a guess that is noted, where missing.
        up: the axis of a file of shapes that points up, "x", "y" or "z"; that of its format where missing.
        split_shells: whether shells of one body that do not touch are parts of their own.
        smallest: mm; bodies no longer than this are hardware and left out.
        ignore: names of parts that are left out, with * and ? for those that are alike.
        overrides: options of the command line, by name.

    Raises:
        RecipeError: every problem with the file or the options, each with its place.
        MissingLibraryError: a library that the file's format needs is absent.
    """
    from foldfab.intake.door import load as opened
    from foldfab.intake.model import Wishes
    from foldfab.recipe.clearance import calibrated
    from foldfab.recipe.edit import override

    asked = Wishes(units=units, up=up, split_shells=split_shells, smallest=smallest, ignore=tuple(ignore))
    recipe = opened(source, asked)
    return calibrated(override(recipe, **overrides) if overrides else recipe)


def coupon(folder: Path | str, printer: str, *, thickness: str | float, posture: str) -> Path:
    """Writes a print folder `coupon` with the same hinge in a row of clearances; returns it.

    Raises:
        RecipeError: there is no such printer, thickness or posture.
        FabricationError: no hinge of that thickness holds.
        PrintFolderError: the folder cannot be written, or the coupon does not fit the printer.
    """
    from foldfab.export.coupon import write_coupon
    from foldfab.fabrication.coupon import coupon as made
    from foldfab.recipe.edit import known_print, known_printer

    options = known_print(thickness=thickness, posture=posture)
    if options.posture not in ("open", "folded"):
        raise RecipeError("command line", (Problem("--posture", "a coupon is printed open or folded"),))
    return write_coupon(made(options.thickness, options.posture), known_printer(printer), Path(folder))


def calibrate(printer: str, clearance: float) -> Path:
    """Keeps the clearance (mm) that a printer prints hinges well with, from now on its default; returns the file.

    Raises:
        RecipeError: there is no such printer, or the clearance is out of range.
    """
    from foldfab.recipe.clearance import calibrate as keep
    from foldfab.recipe.edit import known_printer

    return keep(known_printer(printer).name, clearance)


def compose(kind: str, grid: str) -> Recipe:
    """Furniture of a kind arranged in a grid such as `4x4`, for measuring how the solver scales (section 6, Table 1).

    Raises:
        RecipeError: there is no such kind or grid.
    """
    from foldfab.recipe import compose as composites

    return composites.compose(kind, *composites.grid(grid))


def save(recipe: Recipe, file: Path | str) -> None:
    """Writes a recipe as JSON, one part a line."""
    from foldfab.recipe.write import as_text

    Path(file).write_text(as_text(recipe), encoding="utf-8")


def prepare() -> None:
    """Imports what solving needs, so that a time measured after it is the solver's own."""
    import foldfab.folding.solve
    import foldfab.scaffold.abstract  # noqa: F401


def foldabilize(recipe: Recipe) -> FoldSolution:
    """The cheapest folding solution of a recipe along its direction, or along the best one where it names none.

    Raises:
        AbstractionError: the parts make no scaffold along the direction; the message names directions that would do.
        FoldingError: nothing folds.
    """
    recipe = directed(with_pins(recipe))
    assert recipe.direction is not None
    return along(recipe, recipe.direction)


def directed(recipe: Recipe) -> Recipe:
    """The recipe with the best direction, and why it is that one, where it names none.

    Raises:
        AbstractionError: its parts do not hang together.
        FoldingError: it folds along no direction that is tried.
    """
    from foldfab.directions import settled

    if recipe.direction is None:
        _require_connected(recipe)
    return settled(with_pins(recipe))


def directions(recipe: Recipe, tell: Progress = lambda text: None) -> tuple[Row, ...]:
    """What becomes of a recipe along each direction that is tried, best first.

    Raises:
        AbstractionError: its parts do not hang together.
        FoldingError: the plates are too thin for the hinges of the posture.
    """
    from foldfab.directions import ranked

    _require_connected(recipe)
    return ranked(with_pins(recipe), tell)


def with_pins(recipe: Recipe) -> Recipe:
    """The recipe with hinges that can be put together by hand, where it is to be printed in loose parts.

    Raises:
        FoldingError: the plates are too thin for them.
    """
    from foldfab.recipe.hinges import hinge_problem

    if recipe.print.posture != "plate" or recipe.print.hinge != "cone":
        return recipe
    problem = hinge_problem("filament", recipe.print.thickness, "plate")
    if problem:
        raise FoldingError(f"{recipe.name}: printed apart, its hinges are pinned with filament; {problem}")
    return replace(recipe, print=replace(recipe.print, hinge="filament"))


def alternatives(recipe: Recipe, count: int) -> tuple[FoldSolution, ...]:
    """The best `count` folding solutions, or as many as there are, best first: of one direction at one scale.

    Raises:
        AbstractionError, FoldingError: as for `foldabilize`.
    """
    from foldfab.folding.alternatives import alternatives as ranked

    best = foldabilize(recipe).scaffold
    # Not `best` itself, which may be disconnected where parts must not be split.
    return ranked(abstracted(best.recipe, best.direction, best.scale), count)


def verify(solution: FoldSolution) -> tuple[Violation, ...]:
    """Why a solution is not valid in the sense of section 4, with thickness and without; empty where it is.

    Found from the solution alone, apart from the search.
    """
    return examine(solution).violations


def examine(solution: FoldSolution) -> Verdict:
    """The same, with what was looked at."""
    from foldfab.validity.verify import verdict

    return verdict(solution)


def fabricate(solution: FoldSolution, *, posture: Posture | None = None, progress: Progress | None = None) -> Assembly:
    """The printed bodies of a solution, inspected.

    Raises:
        FabricationError: the print would not work; the message says which part and what to change.
    """
    from foldfab.fabrication.build import build

    tell = (lambda what, share: progress(f"{what} {share:.0%}")) if progress else None
    return build(solution, posture or settled_posture(solution.scaffold.recipe), tell)


def write(assembly: Assembly, folder: Path | str, *, step: bool = False) -> list[Path]:
    """Writes the print folder, whole or not at all, and returns its files; with `step`, a STEP file for CAD too.

    Raises:
        PrintFolderError: the folder cannot be written.
        FabricationError, MissingLibraryError: the STEP file cannot be made.
    """
    from foldfab.export.write import write as write_folder

    return write_folder(assembly, Path(folder), step=step)


def require_cad() -> None:
    """Finds out early that CAD solids cannot be made here.

    Raises:
        MissingLibraryError: build123d, or a system library that it needs, is absent.
    """
    from foldfab.fabrication.analytic import require

    require()


def compound(assembly: Assembly) -> build123d.Compound:
    """The print as build123d knows it: named, coloured solids that revolute joints connect, open, in the recipe's axes.

    Raises:
        FabricationError, MissingLibraryError: it cannot be made.
    """
    from foldfab.export.step import compound as made

    return made(assembly)


def printable(folder: Path | str) -> str:
    """What slicers may stumble over in a print that was written: the table of its `printability.txt`."""
    return (Path(folder) / "printability.txt").read_text(encoding="utf-8").rstrip()


def check(folder: Path | str, *, slicer: str | None = None) -> Report:
    """Inspects a print folder from its files alone; with `slicer`, PrusaSlicer is asked too.

    `slicer` is its path, or empty for the one that is installed.

    Raises:
        PrintFolderError: it is no print folder.
        MissingLibraryError: PrusaSlicer is asked for and not there.
    """
    from foldfab.export.check import inspect_folder

    if slicer is None:
        return inspect_folder(Path(folder))
    from foldfab.slicing.program import find_slicer

    return inspect_folder(Path(folder), find_slicer(slicer))


def shipped() -> tuple[Path, ...]:
    """The recipes that foldfab ships, sorted."""
    from foldfab.recipe.find import shipped as found

    return found()


def _require_connected(recipe: Recipe) -> None:
    """Raises: AbstractionError: its parts do not hang together, whatever the direction."""
    from foldfab.scaffold.abstract import check_connected

    try:
        check_connected(recipe)
    except AbstractionError as error:
        raise AbstractionError(f"{recipe.name}: {error}", error.parts) from error
