"""What would help furniture that does not fold: every change that is named does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from foldfab import advice, pipeline
from foldfab.advice import what_would_help
from foldfab.errors import FoldfabError
from foldfab.recipe.model import Part, Pattern, Recipe


def test_plates_that_are_too_thick(
    recipe: Callable[..., Recipe], board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    thick = recipe((board_at("ground", 0), board_at("top", 26), wall_at("leg", 0, 0, 26)), slanting=False)
    thick = replace(thick, print=replace(thick.print, thickness=6.0))
    with pytest.raises(FoldfabError, match="cannot carry hinges"):
        pipeline.foldabilize(thick)
    assert "with plates of 3 mm" in what_would_help(thick)


def test_parts_that_are_too_thick_themselves(
    recipe: Callable[..., Recipe], board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    thick = recipe((board_at("ground", 0), board_at("top", 26), wall_at("leg", 0, 0, 26)), slanting=False)
    parts = tuple(replace(p, size=p.size * [2.0, 1.0, 1.0]) if p.name == "leg" else p for p in thick.parts)
    own = replace(thick, parts=parts, print=replace(thick.print, own_thickness=True))
    with pytest.raises(FoldfabError, match=r"cannot carry hinges|no folding solution"):
        pipeline.foldabilize(own)
    assert "with plates of 4 mm instead of their own" in what_would_help(own)


def test_what_is_pinned_is_named_and_let_go(
    recipe: Callable[..., Recipe], furniture: dict[str, tuple[Part, ...]]
) -> None:
    parts = tuple(replace(p, pin=Pattern(hinges=9)) if p.name == "leg" else p for p in furniture["h_scaffold"])
    with pytest.raises(FoldfabError, match="pinned or forbidden for leg"):
        pipeline.foldabilize(recipe(parts))
    assert "if leg is left free" in what_would_help(recipe(parts))


def test_every_change_that_is_named_helps(
    recipe: Callable[..., Recipe], furniture: dict[str, tuple[Part, ...]]
) -> None:
    rigid = tuple(replace(p, hingeable=p.name != "leg") for p in furniture["h_scaffold"])
    made = recipe(rigid, slanting=False)
    with pytest.raises(FoldfabError):
        pipeline.foldabilize(made)
    named = what_would_help(made)
    assert {"with slanting allowed", "if leg may get a hinge"} <= set(named)
    for text, changed in advice._changes(made):
        if text in named:
            assert pipeline.foldabilize(changed).cost >= 0


def leg_rigid(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    return tuple(replace(p, hingeable=p.name != "leg") for p in parts)


@pytest.mark.parametrize(
    ("options", "expected", "refused"),
    [
        ({"slanting": False}, {"with slanting allowed", "if leg may get a hinge"}, "leg must not be split"),
        ({"stay_in_box": True}, {"if it may leave its bounding box", "if leg may get a hinge"}, "the bounding box"),
    ],
)
def test_advice_names_what_works_and_nothing_that_does_not(
    recipe: Callable[..., Recipe], furniture: dict[str, tuple[Part, ...]], options: dict[str, bool],
    expected: set[str], refused: str,
) -> None:  # fmt: skip
    """Each change is solved anew: what is named folds, and what is not named does not."""
    made = recipe(leg_rigid(furniture["h_scaffold"]), **options)
    with pytest.raises(FoldfabError, match=refused):
        pipeline.foldabilize(made)
    named = what_would_help(made)
    assert expected <= set(named)
    for text, changed in advice._changes(made):
        if text in named:
            assert pipeline.verify(pipeline.foldabilize(changed)) == ()
        elif text.replace("+", "-") not in named:
            with pytest.raises(FoldfabError):
                pipeline.foldabilize(changed)


def test_a_wrong_direction_is_told_with_one_that_does(
    recipe: Callable[..., Recipe], furniture: dict[str, tuple[Part, ...]]
) -> None:
    made = recipe(furniture["three_walls"], direction=(-1.0, 0.0, 0.0))
    with pytest.raises(FoldfabError, match="back would fold but touches no base"):
        pipeline.foldabilize(made)
    assert what_would_help(made) == ("along -z",)


def test_up_is_not_named_beside_down(recipe: Callable[..., Recipe], furniture: dict[str, tuple[Part, ...]]) -> None:
    made = recipe(leg_rigid(furniture["h_scaffold"]), slanting=False)
    along = [text for text in what_would_help(made) if text.startswith("along")]
    assert along and not any(text.startswith("along +") for text in along)


def test_large_furniture_is_not_tried_part_by_part(
    recipe: Callable[..., Recipe], furniture: dict[str, tuple[Part, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = recipe(leg_rigid(furniture["h_scaffold"]), slanting=False)
    monkeypatch.setattr(advice, "MOST_PARTS", 2)
    named = what_would_help(made)
    assert "with slanting allowed" in named and not any(text.startswith("if leg") for text in named)


def test_advice_outlives_furniture_that_pins_make_impossible(
    recipe: Callable[..., Recipe], furniture: dict[str, tuple[Part, ...]]
) -> None:
    """Either of two walls that lean towards each other may slant, but not both."""
    slanted = Pattern(mechanism="slanted")
    parts = tuple(replace(p, pin=slanted if p.name in ("near", "far") else None) for p in furniture["two_ways"])
    assert {"if near is left free", "if far is left free"} <= set(what_would_help(recipe(parts)))
