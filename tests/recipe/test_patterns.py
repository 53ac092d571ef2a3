"""What a pattern may say."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from foldfab.recipe.model import Pattern
from foldfab.recipe.patterns import (
    hinges_problem,
    is_covered,
    pattern_problem,
    rigid_problem,
    snapped,
    window_problem,
)

POSSIBLE = [
    Pattern("in-place", 1, "l", (0.0, 0.4)),
    Pattern("slanted", 0, "r"),
    Pattern("slanted", window=(0.2, 1.0)),
    Pattern("deleted"),
    Pattern(hinges=0),
]
IMPOSSIBLE = [
    (Pattern("deleted", hinges=0), "hinges"),
    (Pattern("deleted", side="l", window=(0.0, 1.0)), "side, window"),
    (Pattern("slanted", hinges=2), "2 hinges"),
    (Pattern("in-place", hinges=0), "slanted"),
]


@pytest.mark.parametrize("pattern", POSSIBLE)
def test_possible(pattern: Pattern) -> None:
    assert pattern_problem(pattern) is None


@pytest.mark.parametrize(("pattern", "words"), IMPOSSIBLE)
def test_impossible(pattern: Pattern, words: str) -> None:
    assert words in (pattern_problem(pattern) or "")


@pytest.mark.parametrize(
    ("window", "steps", "nearest"),
    [
        ([0, 0.3], 5, (0, 0.4)),
        ([0.1, 0.9], 4, (0, 1)),
        ([0.39, 0.41], 5, (0.4, 0.6)),
        ([0.99, 1], 5, (0.8, 1)),
        ([0, 0.01], 5, (0, 0.2)),
        ([0.2, 0.9], 1, (0, 1)),
    ],
)
def test_a_window_between_cuts_names_the_nearest(window: list[float], steps: int, nearest: tuple[float, float]) -> None:
    assert snapped(window, steps) == pytest.approx(nearest)
    problem = window_problem(window, steps) or ""
    assert f"shrink_steps {steps}" in problem
    assert problem.endswith(f"nearest window is [{nearest[0]:g}, {nearest[1]:g}]")


@given(st.integers(1, 20), st.data())
def test_windows_on_cuts(steps: int, data: st.DataObject) -> None:
    low = data.draw(st.integers(0, steps - 1))
    high = data.draw(st.integers(low + 1, steps))
    exact = (low / steps, high / steps)
    rounded = (round(exact[0], 3), round(exact[1], 3))
    assert window_problem(rounded, steps) is None
    assert snapped(rounded, steps) == exact


@given(st.floats(0, 1), st.floats(0, 1), st.integers(1, 20))
def test_the_nearest_window_is_one(one: float, other: float, steps: int) -> None:
    nearest = snapped(sorted((one, other)), steps)
    assert 0 <= nearest[0] < nearest[1] <= 1
    assert window_problem(nearest, steps) is None


def test_windows_that_end_before_they_begin() -> None:
    for window in ([0.4, 0.4], [0.6, 0.2]):
        assert "begin before it ends" in (window_problem(window, None) or "")


def test_what_is_not_known_is_not_judged() -> None:
    assert window_problem([0.1, 0.2], None) is None
    assert hinges_problem(9, None) is None


def test_hinges() -> None:
    assert hinges_problem(3, 3) is None
    assert hinges_problem(4, 3) == "4 is more than fold.max_hinges 3 allows"


def test_rigid_parts() -> None:
    assert "hinges 2" in (rigid_problem(Pattern(hinges=2)) or "")
    assert "in-place" in (rigid_problem(Pattern("in-place")) or "")
    assert rigid_problem(Pattern("slanted", 0)) is None


def test_covered() -> None:
    pin = Pattern("in-place", 1)
    assert is_covered(pin, Pattern(hinges=1))
    assert is_covered(pin, Pattern("in-place"))
    assert not is_covered(pin, Pattern(hinges=1, side="l"))
    assert not is_covered(pin, Pattern(hinges=3))
