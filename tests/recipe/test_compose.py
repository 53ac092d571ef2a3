"""Composites have the units and patches of Table 1, hang together, and fold as single pieces do."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.folding.solve import solve
from foldfab.folding.units import Unit, decompose
from foldfab.geometry.boxes import Boxes, close_pairs
from foldfab.geometry.groups import Groups
from foldfab.recipe.compose import KINDS, MOST_CELLS, compose, grid
from foldfab.recipe.fields import MOST_PARTS
from foldfab.recipe.model import Recipe
from foldfab.recipe.read import read
from foldfab.recipe.write import as_text
from foldfab.scaffold.abstract import abstract
from foldfab.scaffold.model import Scaffold

TABLE_1 = {
    "bench": ((3, 6), (12, 24), (27, 54), (48, 96)),
    "building": ((2, 5), (6, 18), (12, 39), (20, 68)),
    "hexagon": ((1, 10), (1, 36), (1, 78), (1, 136)),
    "shelf": ((5, 15), (10, 60), (15, 135), (20, 240)),
}
"""Units and foldable patches of 1 × 1 to 4 × 4, from the paper."""
GRIDS = ((1, 3), (2, 1), (2, 5), (3, 2), (4, 3), (5, 1), (6, 2))


def abstracted(recipe: Recipe) -> Scaffold:
    assert recipe.direction is not None and recipe.print.scale is not None
    return abstract(recipe, recipe.direction, recipe.print.scale)


@functools.cache
def made(kind: str, columns: int, rows: int) -> tuple[Scaffold, tuple[Unit, ...]]:
    """The scaffold and the units of a composite."""
    scaffold = abstracted(compose(kind, columns, rows))
    return scaffold, decompose(scaffold)


def counts(kind: str, columns: int, rows: int) -> tuple[int, int]:
    scaffold, units = made(kind, columns, rows)
    return len(units), len(scaffold.patches)


def expected(kind: str, n: int, m: int) -> tuple[int, int]:
    """Units and patches of n columns and m rows."""
    return {
        "bench": (3 * n * m, 6 * n * m),
        "building": (m * (n + 1), m * (4 * n + 1)),
        "hexagon": (1 if n > 1 else m, 2 * m * (4 * n + 1)),
        "shelf": (5 * m, 15 * n * m),
    }[kind]


def plain(scaffold: Scaffold) -> list[object]:
    """All that a scaffold says, comparable."""
    patches = [
        (p.name, p.parts, *p.center, *p.along, *p.up, p.width, p.length, p.lower, p.upper) for p in scaffold.patches
    ]
    bases = [
        (b.name, b.parts, b.bottom, b.top, *((o.part, *o.center, *o.along, *o.half, o.extent) for o in b.outlines))
        for b in scaffold.bases
    ]
    return [patches, bases, scaffold.notes]


@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", KINDS)
def test_units_and_patches_are_those_of_table_1(kind: str, n: int) -> None:
    assert counts(kind, n, n) == TABLE_1[kind][n - 1] == expected(kind, n, n)


@pytest.mark.parametrize("size", GRIDS)
@pytest.mark.parametrize("kind", KINDS)
def test_units_and_patches_of_any_grid(kind: str, size: tuple[int, int]) -> None:
    assert counts(kind, *size) == expected(kind, *size)


@pytest.mark.parametrize("kind", KINDS)
def test_all_parts_touch_the_rest_in_true_millimetres(kind: str) -> None:
    parts = compose(kind, 3, 2).parts
    boxes = Boxes(
        *(np.array(field) for field in zip(*((p.center, p.axes, p.size / 2 + 0.5) for p in parts), strict=True))
    )
    i, j = close_pairs(boxes, boxes)
    assert len(Groups(len(parts), zip(i.tolist(), j.tolist(), strict=True)).all()) == 1


@pytest.mark.parametrize("kind", KINDS)
def test_every_patch_is_an_h_scaffold_and_nothing_is_remarked(kind: str) -> None:
    scaffold, _ = made(kind, 3, 2)
    assert {len(patch.bases) for patch in scaffold.patches} == {2}
    assert scaffold.notes == ()


@pytest.mark.parametrize("kind", KINDS)
def test_a_cell_folds_and_loses_nothing(kind: str) -> None:
    solution = solve(made(kind, 1, 1)[0])
    assert not any(modification.is_deleted for modification in solution.modifications)
    assert all(modification.window == (0.0, 1.0) for modification in solution.modifications)


@pytest.mark.parametrize("kind", KINDS)
def test_a_composite_is_the_same_every_time_and_after_reading(kind: str, tmp_path: Path) -> None:
    recipe = compose(kind, 3, 2)
    assert as_text(recipe) == as_text(compose(kind, 3, 2))
    file = tmp_path / "composite.json"
    file.write_text(as_text(recipe), encoding="utf-8")
    again = read(file)
    assert (again.name, again.about, again.fold, again.print) == (recipe.name, recipe.about, recipe.fold, recipe.print)
    assert plain(abstracted(again)) == plain(made(kind, 3, 2)[0])


@pytest.mark.parametrize("kind", KINDS)
def test_names_are_unique_and_the_largest_can_be_read(kind: str) -> None:
    parts = compose(kind, MOST_CELLS, MOST_CELLS).parts
    assert len({part.name for part in parts}) == len(parts) <= MOST_PARTS


@pytest.mark.parametrize("size", [(0, 3), (3, 0), (MOST_CELLS + 1, 1), (1, MOST_CELLS + 1), (-1, 2)])
def test_a_wrong_grid_is_told(size: tuple[int, int]) -> None:
    with pytest.raises(RecipeError, match=rf"grid: should have 1 to 32 columns .*, not {size[0]}x{size[1]}"):
        compose("bench", *size)


def test_a_wrong_kind_and_a_wrong_grid_are_told_at_once() -> None:
    with pytest.raises(RecipeError, match="bench, building, hexagon, shelf, not 'chair'") as caught:
        compose("chair", 0, 3)
    assert [problem.place for problem in caught.value.problems] == ["kind", "grid"]


@pytest.mark.parametrize("text", ["4x3", "4×3", " 4 x 3 "])
def test_a_grid_is_columns_and_rows(text: str) -> None:
    assert grid(text) == (4, 3)


@pytest.mark.parametrize("text", ["", "4", "4x", "4by3", "-4x3", "4x3x2", "4.0x3", "x".join(["9" * 9] * 2)])
def test_what_is_no_grid_is_told(text: str) -> None:
    with pytest.raises(RecipeError, match="columns x rows, such as 4x4"):
        grid(text)
