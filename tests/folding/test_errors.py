"""What does not fold is a FoldingError that names the patches and says what to try."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from foldfab.errors import FoldingError
from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

Make = Callable[..., FoldSolution]
Parts = dict[str, tuple[Part, ...]]


def rigid(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    return tuple(replace(part, hingeable=False) for part in parts)


def test_furniture_of_boards_only_has_nothing_to_fold(solution: Make, furniture: Parts) -> None:
    with pytest.raises(FoldingError, match="nothing folds along this direction"):
        solution(furniture["h_scaffold"][:1])


def test_patches_too_short_for_their_hinges_are_named_with_their_height(solution: Make) -> None:
    with pytest.raises(
        FoldingError, match=r"leg \(54.0 mm high\) cannot carry hinges.*; print larger or with plates thinner"
    ):
        solution("h_scaffold", thickness=30.0)


def test_an_unhingeable_wall_that_may_not_slant_is_named(solution: Make, furniture: Parts) -> None:
    with pytest.raises(FoldingError, match="leg"):
        solution(rigid(furniture["h_scaffold"]), slanting=False)


def test_an_unhingeable_wall_that_may_not_slant_is_not_called_too_short(solution: Make, furniture: Parts) -> None:
    with pytest.raises(FoldingError) as caught:
        solution(rigid(furniture["h_scaffold"]), slanting=False)
    assert "long enough" not in str(caught.value)


def test_the_error_says_which_patches_cannot_fold(solution: Make, furniture: Parts, board_at: Callable[..., Part],
                                                  wall_at: Callable[..., Part]) -> None:  # fmt: skip
    """A rigid wall holds the top; a leg on the ground folds alone."""
    parts = (*rigid(furniture["h_scaffold"]), wall_at("flap", 60, 0, 54))
    with pytest.raises(FoldingError) as caught:
        solution(parts, slanting=False)
    assert "leg" in str(caught.value) and "flap" not in str(caught.value)
