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
