"""One direction at the scale that fits, and plates as thin as it takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from foldfab import fitting
from foldfab.errors import FoldingError, LossError
from foldfab.export.bed import on_bed
from foldfab.fabrication.build import build
from foldfab.fabrication.inspect import printed_extent
from foldfab.fitting import along
from foldfab.folding.model import FoldSolution
from foldfab.folding.work import Work
from foldfab.geometry.arrays import Array
from foldfab.pipeline import load
from foldfab.recipe.model import FoldOptions, Part, Pattern, Posture, PrintOptions, Recipe
from foldfab.recipe.printers import DEFAULT_PRINTER

DOWN = np.array([0.0, 0.0, -1.0])


@pytest.fixture
def low_table(box: Callable[..., Part]) -> Callable[..., Recipe]:
    """A board on a wall between boards whose middles are `height` mm of print apart."""

    def make(height: float, **options: object) -> Recipe:
        parts = (
            box("ground", (0, 0, 0), (80, 60, 2)),
            box("top", (0, 0, height), (80, 60, 2)),
            box("wall", (0, 0, height / 2), (2, 60, height - 2)),
        )
        made = PrintOptions(printer=DEFAULT_PRINTER, scale=1.0, clearance=0.25, may_thin=True)
        return Recipe("low", DOWN, parts, FoldOptions(), replace(made, **options))  # type: ignore[arg-type]

    return make


def told(recipe: Recipe) -> list[str]:
    return [note for note in along(recipe, DOWN).notes if "thick because" in note]


@pytest.mark.parametrize(("height", "panel"), [(40.0, 4.0), (15.0, 3.0), (11.5, 2.0)])
def test_plates_are_as_thin_as_it_takes(low_table: Callable[..., Recipe], height: float, panel: float) -> None:
    solution = along(low_table(height), DOWN)
    assert solution.thickness.panel == panel
    assert solution.scaffold.recipe.print.thickness == panel and not solution.scaffold.recipe.print.may_thin


def test_thinner_plates_are_told_of(low_table: Callable[..., Recipe]) -> None:
    assert told(low_table(40.0)) == []
    assert told(low_table(15.0)) == ["plates are 3 mm thick because with thicker ones it would not fold"]


def test_what_the_recipe_says_is_not_thinned(low_table: Callable[..., Recipe]) -> None:
    with pytest.raises(FoldingError, match="thinner than 4 mm"):
        along(low_table(15.0, may_thin=False), DOWN)


def test_what_is_too_low_for_the_thinnest_plates_is_refused(low_table: Callable[..., Recipe]) -> None:
    with pytest.raises(FoldingError, match="cannot carry hinges"):
        along(low_table(8.0), DOWN)


def test_plates_are_not_made_so_thin_that_hinges_come_apart(low_table: Callable[..., Recipe]) -> None:
    with pytest.raises(FoldingError, match="cannot carry hinges"):
        along(low_table(11.5, clearance=0.3), DOWN)


def test_hinges_that_need_thick_plates_keep_them_thick(low_table: Callable[..., Recipe]) -> None:
    with pytest.raises(FoldingError, match="thinner than 4 mm"):
        along(low_table(15.0, hinge="clip"), DOWN)


@pytest.mark.parametrize(("whole_at", "panel"), [((3.0, 2.0), 3.0), ((2.0,), 2.0), ((), 4.0)])
def test_plates_are_thinned_so_that_nothing_has_to_go(
    low_table: Callable[..., Recipe], monkeypatch: pytest.MonkeyPatch, whole_at: tuple[float, ...], panel: float
) -> None:
    """Where even the thinnest plates spare no part, they stay as thick as usual."""
    fitted = fitting._fitted

    def losing(recipe: Recipe, direction: Array, *rest: Any) -> FoldSolution:
        found = fitted(recipe, direction, *rest)
        gone = tuple(replace(m, mechanism="deleted") for m in found.modifications)
        return found if recipe.print.thickness in whole_at else replace(found, modifications=gone)

    monkeypatch.setattr(fitting, "_fitted", losing)
    solution = along(low_table(40.0), DOWN)
    assert solution.thickness.panel == panel
    why = f"plates are {panel:g} mm thick because with thicker ones parts would have to go"
    assert (why in solution.notes) == (panel < 4.0)


@pytest.mark.parametrize(("lost", "tried", "panel"), [
    ({4.0: 1, 3.0: 0}, [4.0, 3.0], 3.0),
    ({4.0: 2, 3.0: 1, 2.0: 1}, [4.0, 3.0, 2.0, 3.0], 3.0),
    ({4.0: 1, 3.0: 1, 2.0: 1}, [4.0, 3.0, 2.0, 4.0], 4.0),
])  # fmt: skip
def test_plates_that_certainly_cost_parts_are_looked_at_last(
    low_table: Callable[..., Recipe], monkeypatch: pytest.MonkeyPatch, lost: dict[float, int], tried: list[float],
    panel: float,
) -> None:  # fmt: skip
    """And only where thinner ones spare no part, or none of them folds at all."""
    fitted, asked = fitting._fitted, []

    def losing(recipe: Recipe, direction: Array, work: Work, most: int | None, worth: int | None) -> FoldSolution:
        asked.append(recipe.print.thickness)
        gone = lost[recipe.print.thickness]
        if gone > (most or 0):
            raise LossError(gone)
        found = fitted(recipe, direction, work)
        changed = tuple(replace(m, mechanism="deleted") for m in found.modifications[:gone])
        return replace(found, modifications=changed + found.modifications[gone:])

    monkeypatch.setattr(fitting, "_fitted", losing)
    solution = along(low_table(40.0), DOWN)
    assert asked == tried and solution.thickness.panel == panel
    why = f"plates are {panel:g} mm thick because with thicker ones parts would have to go"
    assert (why in solution.notes) == (panel < 4.0)


def test_all_thicknesses_share_the_time_limit(
    low_table: Callable[..., Recipe], monkeypatch: pytest.MonkeyPatch
) -> None:
    limits = []

    def losing(recipe: Recipe, direction: Array, work: Work, *_: int | None) -> FoldSolution:
        limits.append(work.limit)
        work.charge(1.4)
        raise FoldingError("no")

    monkeypatch.setattr(fitting, "_fitted", losing)
    with pytest.raises(FoldingError, match="no"):
        along(low_table(40.0), DOWN)
    assert limits == pytest.approx([2.0, 0.6, 0.5])


def test_more_patches_may_have_to_go_than_there_are_parts(
    box: Callable[..., Part], low_table: Callable[..., Recipe]
) -> None:
    """Shelves cut each wall into three."""
    shelves = [box(f"shelf{k}", (0, 0, 40.0 * k), (160, 60, 2)) for k in range(4)]
    walls = [box(f"wall{k}", (40.0 * k - 60, 0, 60), (2, 60, 122)) for k in range(4)]
    gone = [replace(wall, pin=Pattern(mechanism="deleted")) for wall in walls[1:]]
    recipe = replace(low_table(40.0), parts=(*shelves, walls[0], *gone))
    solution = along(recipe, DOWN)
    assert sum(m.is_deleted for m in solution.modifications) == 9 > len(recipe.parts)
    assert solution.thickness.panel == 4.0


@pytest.mark.parametrize("posture", ["open", "folded", "edge"])
def test_furniture_that_stands_askew_in_its_file_is_printed_as_large(posture: Posture) -> None:
    recipe = load("bench-legs", posture=posture, scale="fit")
    sin, cos = np.sin(np.radians(20.0)), np.cos(np.radians(20.0))
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    parts = tuple(replace(p, center=turn @ p.center, axes=p.axes @ turn.T) for p in recipe.parts)
    still, askew = (along(one, DOWN) for one in (recipe, replace(recipe, parts=parts)))
    assert askew.scaffold.scale == pytest.approx(still.scaffold.scale)
    extents = [printed_extent(build(solution, posture)) for solution in (still, askew)]
    assert extents[1] == pytest.approx(extents[0], abs=0.01)
    heaps = [np.vstack([shell.vertices for shell in on_bed(build(s, posture))]) for s in (still, askew)]
    assert np.ptp(heaps[1], axis=0) == pytest.approx(np.ptp(heaps[0], axis=0), abs=0.01)
