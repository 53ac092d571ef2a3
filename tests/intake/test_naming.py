"""Names of parts from names of other programs."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from foldfab.intake.naming import is_nameless, part_name, unique
from foldfab.recipe.names import part_name_problem, same_name


@given(st.lists(st.text(), max_size=20))
def test_any_names_become_safe_and_unique(names: list[str]) -> None:
    found = unique(names)
    assert [part_name_problem(name) for name in found] == [None] * len(names)
    assert len({same_name(name) for name in found}) == len(names)


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Side left", "Side left"),
        ("../../etc/passwd", "-..-etc-passwd"),
        ("C:\\a", "C-a"),
        ("NUL", "NUL-1"),
        (" a\nb. ", "a-b"),
        ("", "part"),
        ("...", "part"),
        ("Brett für oben", "Brett für oben"),
        ("x" * 300, "x" * 100),
    ],
)
def test_names(text: str, name: str) -> None:
    assert part_name(text) == name


def test_numbers_where_names_repeat() -> None:
    assert unique(["leg", "LEG", "leg-2", "leg"]) == ["leg", "LEG-3", "leg-2", "leg-4"]


@pytest.mark.parametrize("text", ["", " ", "SOLID", "Compound", "=>[0:1:1:2]"])
def test_no_names(text: str) -> None:
    assert is_nameless(text)
    assert not is_nameless(f"{text} leg")


def test_a_number_leaves_long_names_short_enough_in_bytes() -> None:
    """66 letters of three bytes each: as long as a name may be, without a number."""
    found = unique(["ࠀ" * 66] * 12)
    assert [part_name_problem(name) for name in found] == [None] * 12 and len(set(found)) == 12
