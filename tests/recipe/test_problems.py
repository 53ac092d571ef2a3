"""Every key of the form has its words."""

from __future__ import annotations

import math

from foldfab.recipe.problems import EXPECTED, FORMS, keys, place, shown


def test_every_key_says_what_would_be_right() -> None:
    for form in FORMS.values():
        assert set(keys(form)) <= set(EXPECTED)


def test_place() -> None:
    assert place(()) == "recipe"
    assert place(("parts", 2, "box", "size")) == "parts[2].box.size"
    assert place(("a b", "c")) == "['a b'].c"


def test_shown_is_short() -> None:
    for value in ("x" * 1000, 10**50, list(range(1000)), {"a": 1}, math.nan, None, 1.5):
        assert len(shown(value)) <= 45
