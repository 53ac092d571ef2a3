"""Foldable patches touch bases only at their ends: sheets are cut at the bases they cross, stubs are trimmed."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold

Box = Callable[..., Part]
Make = Callable[..., Scaffold]


def ends(scaffold: Scaffold) -> dict[str, tuple[str | None, str | None]]:
    return {patch.name: (patch.lower, patch.upper) for patch in scaffold.patches}


def test_a_leg_on_a_board_is_a_t_scaffold(scaffold: Make) -> None:
    made = scaffold("t_scaffold")
    assert ends(made) == {"leg": ("ground", None)}
    assert made.patches[0].bases == ("ground",)


def test_legs_under_a_board_are_t_scaffolds_that_hang(scaffold: Make) -> None:
    assert ends(scaffold("table")) == {"left": (None, "top"), "right": (None, "top")}


def test_a_wall_between_two_boards_is_an_h_scaffold(scaffold: Make) -> None:
    made = scaffold("h_scaffold")
    assert ends(made) == {"leg": ("ground", "ceiling")}
    assert made.patches[0].bases == ("ground", "ceiling")
    assert (made.patches[0].width, made.patches[0].length) == pytest.approx((60, 84))


def test_a_leaning_wall_keeps_its_length(scaffold: Make) -> None:
    (leg,) = scaffold("slanted_h").patches
    assert leg.length == pytest.approx((84**2 + 30**2) ** 0.5)
    assert leg.up == pytest.approx([30 / leg.length, 0, 84 / leg.length])


def test_a_wall_is_cut_where_it_crosses_a_board(scaffold: Make) -> None:
    made = scaffold("passage")
    assert ends(made) == {"side.1": ("low", "middle"), "side.2": ("middle", "high")}
    assert [patch.length for patch in made.patches] == pytest.approx([64, 64])
    assert {patch.parts for patch in made.patches} == {("side",)}


def test_what_sticks_out_a_little_is_trimmed(scaffold: Make, box: Box, board_at: Box) -> None:
    made = scaffold((board_at("ground", 0), board_at("top", 70), box("side", (0, 0, 40), (4, 60, 76))))
    assert ends(made) == {"side": ("ground", "top")}
    assert made.patches[0].length == pytest.approx(70)


def test_what_sticks_out_a_lot_folds_by_itself(scaffold: Make, box: Box, board_at: Box) -> None:
    made = scaffold((board_at("ground", 0), board_at("top", 70), box("side", (0, 0, 60), (4, 60, 116))))
    assert ends(made) == {"side.1": ("ground", "top"), "side.2": ("top", None)}
    assert made.patches[1].length == pytest.approx(48)


def test_a_patch_names_the_recipe_parts_that_it_abstracts(scaffold: Make, board_at: Box, wall_at: Box) -> None:
    made = scaffold((board_at("ground", 0), board_at("top", 84), wall_at("a", 0, 0, 84), wall_at("b", 4, 0, 84)))
    assert [patch.parts for patch in made.patches] == [("a", "b")]


def test_pieces_of_a_part_never_take_the_name_of_another_part(scaffold: Make, furniture: dict[str, tuple[Part, ...]],
                                                              wall_at: Box) -> None:  # fmt: skip
    made = scaffold((*furniture["passage"], wall_at("side.1", 40, 64, 128)))
    names = [patch.name for patch in made.patches] + [base.name for base in made.bases]
    assert len(names) == 6
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("name", ["h_scaffold", "box_with_table", "passage", "roof", "chair"])
def test_every_patch_ends_on_the_heights_of_its_bases(scaffold: Make, name: str) -> None:
    made = scaffold(name)
    for patch in made.patches:
        for base, sign in ((patch.lower, -1), (patch.upper, 1)):
            height = patch.center[2] + sign * patch.up[2] * patch.length / 2
            assert base is None or height == pytest.approx(made.base(base).top)
