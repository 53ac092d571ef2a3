"""Base patches: connected coplanar parts and edges, but never a single edge."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from foldfab.recipe.model import Part, Recipe
from foldfab.recipe.read import read
from foldfab.scaffold.abstract import abstract
from foldfab.scaffold.model import Scaffold

Box = Callable[..., Part]
Make = Callable[..., Scaffold]
ROOT = Path(__file__).resolve().parents[2]


def names(scaffold: Scaffold) -> list[str]:
    return [base.name for base in scaffold.bases]


def test_bases_are_sorted_by_height(scaffold: Make) -> None:
    made = scaffold("box_with_table")
    assert names(made) == ["ground", "top", "ceiling"]
    assert [base.bottom for base in made.bases] == [0, 44, 104]


def test_a_single_edge_is_the_tip_of_a_t_scaffold_and_no_base(scaffold: Make) -> None:
    assert names(scaffold("t_scaffold")) == ["ground"]
    assert names(scaffold("table")) == ["top"]


def test_two_boards_that_meet_along_an_edge_make_a_base_of_it(scaffold: Make) -> None:
    made = scaffold("roof")
    ridge = made.bases[1]
    assert len(made.bases) == 2 and ridge.parts == ()
    assert {patch.upper for patch in made.patches} == {ridge.name}
    assert {outline.part for outline in ridge.outlines} == {"left", "right"}


def test_boards_that_meet_only_at_a_corner_of_their_edges_make_no_base(
    scaffold: Make, box: Box, board_at: Box, wall_at: Box
) -> None:
    made = scaffold((board_at("ground", 0), wall_at("side", 0, 0, 80), box("back", (0, 30, 40), (60, 4, 76))))
    assert names(made) == ["ground"]
    assert all(patch.upper is None for patch in made.patches)


def test_boards_side_by_side_are_one_base_named_after_the_largest(scaffold: Make, board_at: Box, wall_at: Box) -> None:
    made = scaffold((board_at("a", 0, 80, x=-40), board_at("b", 0, 120, x=60.5), wall_at("leg", 0, 0, 80)))
    assert names(made) == ["b"]
    assert made.bases[0].parts == ("a", "b")
    assert {outline.part for outline in made.bases[0].outlines} == {"a", "b"}


def test_rods_joined_by_an_edge_of_a_wall_are_one_base(scaffold: Make, box: Box) -> None:
    wall = box("wall", (0, 0, 40), (120, 4, 76))
    rods = tuple(box(name, (x, 0, 0), (6, 60, 5)) for name, x in (("left", -50), ("right", 50)))
    made = scaffold((wall, *rods))
    assert len(made.bases) == 1
    assert {outline.part for outline in made.bases[0].outlines} == {"left", "right", "wall"}


def test_an_outline_covers_its_part(scaffold: Make) -> None:
    (outline,) = scaffold("box_with_table").base("top").outlines
    assert sorted(outline.half) == [40.0, 40.0] and outline.center.tolist() == [0.0, 0.0]


def test_a_tilted_seat_is_a_base_at_the_height_of_its_middle(
    scaffold: Make, box: Box, board_at: Box, wall_at: Box
) -> None:
    sin, cos = np.sin(0.2), np.cos(0.2)
    seat = box("seat", (0, 0, 84), (100, 80, 4), np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]]))
    made = scaffold((board_at("ground", 0), seat, wall_at("leg", 0, 0, 84)))
    assert names(made) == ["ground", "seat"]
    assert made.base("seat").bottom == made.base("seat").top == 84


def test_the_shipped_bench_has_the_four_bases_and_six_patches_of_the_paper() -> None:
    recipe: Recipe = read(ROOT / "recipes" / "bench.json")
    assert recipe.direction is not None
    made = abstract(recipe, recipe.direction, 0.2)
    assert len(made.bases) == 4 and len(made.patches) == 6
    assert all(len(patch.bases) == 2 for patch in made.patches)
    assert {patch.name for patch in made.patches} == {f"{part}.{i}" for part in ("seat", "back") for i in (1, 2, 3)}


def test_a_base_of_edges_keeps_its_name_wherever_the_furniture_stands(
    scaffold: Make, furniture: dict[str, tuple[Part, ...]], box: Box
) -> None:
    lifted = tuple(box(p.name, p.center + np.array([0, 0, 100.0]), p.size, p.axes) for p in furniture["roof"])
    assert names(scaffold(lifted)) == names(scaffold("roof"))
