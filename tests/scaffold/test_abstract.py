"""Furniture becomes a scaffold that no rigid motion changes, or an error that names the parts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.errors import AbstractionError
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Part, Recipe
from foldfab.scaffold.abstract import abstract
from foldfab.scaffold.model import Scaffold

Box = Callable[..., Part]
Make = Callable[..., Scaffold]
NAMES = ("t_scaffold", "slanted_h", "box_with_table", "passage", "chair", "three_walls")


def test_a_scaffold_remembers_its_recipe_direction_and_scale(recipe: Callable[..., Recipe]) -> None:
    made = recipe("h_scaffold")
    found = abstract(made, np.array([0.0, 0.0, -1.0]), 1.5)
    assert found.recipe is made and found.scale == 1.5
    assert found.rotation == pytest.approx(np.eye(3))
    assert found.patch("leg").length == pytest.approx(1.5 * 84)
    assert found.base("ceiling").bottom == pytest.approx(1.5 * 84)


def test_patches_are_sorted_by_name_and_bases_belong_to_the_scaffold(
    scaffold: Make, furniture: dict[str, tuple[Part, ...]]
) -> None:
    for name in furniture:
        made = scaffold(name)
        assert [p.name for p in made.patches] == sorted(p.name for p in made.patches)
        assert {base for p in made.patches for base in p.bases} <= {base.name for base in made.bases}


def test_parts_that_float_are_named(scaffold: Make, furniture: dict[str, tuple[Part, ...]], board_at: Box) -> None:
    with pytest.raises(AbstractionError, match=r"far does not touch the rest") as caught:
        scaffold((*furniture["h_scaffold"], board_at("far", 200)))
    assert caught.value.parts == ("far",)


def test_a_gap_within_a_hundredth_of_a_part_still_joins(scaffold: Make, board_at: Box, box: Box) -> None:
    made = scaffold((board_at("ground", 0), box("leg", (0, 0, 40.6), (4, 60, 76))))
    assert made.patch("leg").lower == "ground"


def test_a_part_that_folds_but_touches_no_base_is_named(scaffold: Make, box: Box, board_at: Box, wall_at: Box) -> None:
    loose = box("loose", (17, 0, 40), (30, 4, 40))
    with pytest.raises(AbstractionError, match="loose would fold but touches no base") as caught:
        scaffold((board_at("ground", 0), wall_at("leg", 0, 0, 80), loose))
    assert caught.value.parts == ("loose",)


def test_a_rail_that_only_touches_what_folds_becomes_a_base(
    scaffold: Make, box: Box, board_at: Box, wall_at: Box
) -> None:
    legs = (wall_at("left", -40, 0, 80), wall_at("right", 40, 0, 80))
    rail = box("rail", (0, 0, 40), (80, 4, 16))
    made = scaffold((*legs, rail, board_at("top", 80)))
    assert "rail" in {base.name for base in made.bases}
    assert [p.name for p in made.patches] == ["left.1", "left.2", "right.1", "right.2"]


def test_a_back_that_only_touches_its_seat_folds_with_it(scaffold: Make, box: Box) -> None:
    legs = [box(f"leg-{x}-{z}", (x, -40, z), (4, 80, 4)) for x in (-40, 40) for z in (2, 78)]
    seat, back = box("seat", (0, 2, 40), (84, 4, 80)), box("back", (-40, 44, 40), (4, 80, 80))
    made = scaffold((*legs, seat, back))
    assert [base.parts for base in made.bases] == [("leg--40-2", "leg-40-2"), ("leg--40-78", "leg-40-78")]
    assert made.patch("back").bases == made.patch("seat").bases == tuple(base.name for base in made.bases)
    assert made.notes == ()


def test_ends_that_meet_at_corners_alone_are_one_base_where_nothing_else_is(scaffold: Make, box: Box) -> None:
    back, rear = box("back", (40, -40, 40), (4, 79, 80)), box("rear", (40, 40, 40), (4, 79, 80))
    seat, front = box("seat", (0, 0, 40), (76, 4, 80)), box("front", (-40, 40, 40), (4, 79, 80))
    made = scaffold((back, rear, seat, front))
    low, high = made.bases
    assert {patch.name: patch.bases for patch in made.patches} == dict.fromkeys(
        ("back", "front", "rear", "seat"), (low.name, high.name)
    )


def test_a_base_that_slopes_is_told(scaffold: Make, box: Box, wall_at: Box) -> None:
    seat = replace(
        box("seat", (0, 0, 80), (120, 40, 4)), axes=np.array([[0.966, 0, 0.259], [0, 1, 0], [-0.259, 0, 0.966]])
    )
    made = scaffold((seat, wall_at("leg", 0, 0, 80)))
    assert any("seat slopes by 31" in note for note in made.notes)


def test_furniture_without_a_base_is_an_error(scaffold: Make, wall_at: Box) -> None:
    with pytest.raises(AbstractionError, match="no base"):
        scaffold((wall_at("lonely", 0, 0, 80),))


def test_the_error_about_furniture_without_a_base_names_its_parts(scaffold: Make, wall_at: Box) -> None:
    with pytest.raises(AbstractionError) as caught:
        scaffold((wall_at("lonely", 0, 0, 80),))
    assert caught.value.parts == ("lonely",)


def facts(scaffold: Scaffold) -> list[object]:
    """What no rigid motion may change."""
    patches = [
        (p.name, p.parts, p.lower, p.upper, round(p.width, 6), round(p.length, 6), round(p.up[2], 6))
        for p in scaffold.patches
    ]
    bases = [(b.name, b.parts, len(b.outlines), round(b.top - scaffold.bases[0].bottom, 6)) for b in scaffold.bases]
    return [patches, bases]


def moved(recipe: Recipe, turn: Array, shift: Array) -> Recipe:
    assert recipe.direction is not None
    parts = tuple(Part(p.name, turn @ p.center + shift, p.size, p.axes @ turn.T, p.hingeable) for p in recipe.parts)
    return replace(recipe, parts=parts, direction=turn @ recipe.direction)


@given(st.sampled_from(NAMES), st.integers(0, 2**32 - 1))
@settings(deadline=None, derandomize=True, max_examples=40)
def test_a_rigid_motion_of_furniture_and_direction_changes_nothing(
    recipe: Callable[..., Recipe], scaffold: Make, name: str, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    there = moved(recipe(name), turn, rng.uniform(-500, 500, 3))
    assert facts(scaffold(there)) == facts(scaffold(name))


@pytest.mark.parametrize("name", NAMES)
def test_true_size_times_scale_is_all_that_counts(recipe: Callable[..., Recipe], scaffold: Make, name: str) -> None:
    small = recipe(name)
    large = replace(small, parts=tuple(replace(p, center=8 * p.center, size=8 * p.size) for p in small.parts))
    assert large.direction is not None
    assert facts(abstract(large, large.direction, 0.125)) == facts(scaffold(name))
