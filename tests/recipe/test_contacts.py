"""What a recipe says of parts that touch, or do not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.recipe.contacts import Contacts, beside, reach
from foldfab.recipe.model import Recipe
from foldfab.recipe.read import parse
from foldfab.recipe.write import as_text, to_json

PARTS = [
    {"name": name, "box": {"center": [0, 0, z], "size": [400, 400, 20]}}
    for z, name in enumerate(("top", "leg 1", "leg 2", "Shelf [2]"))
]


def read(**contacts: Any) -> Recipe:
    return parse({"parts": PARTS, **contacts}, "table.json", "table")


def test_names_and_patterns_in_either_order() -> None:
    made = read(touching=[["top", "leg*"]], apart=[["TOP", "Shelf [2]"], ["leg ?", "leg ?"]])
    assert made.touching == (("leg 1", "top"), ("leg 2", "top"))
    assert made.apart == (("Shelf [2]", "top"), ("leg 1", "leg 2"))


def test_written_and_read_again() -> None:
    made = read(touching=[["top", "leg*"]], apart=[["leg 1", "leg 2"]])
    again = parse(to_json(made), "again.json", "again")
    assert (again.touching, again.apart) == (made.touching, made.apart)
    assert '"touching": [["leg 1", "top"], ["leg 2", "top"]]' in as_text(made)
    assert {"touching", "apart"}.isdisjoint(to_json(read()))


@pytest.mark.parametrize(
    ("contacts", "place", "says"),
    [
        ({"touching": [["top", "foot"]]}, "touching[0]", "'foot' fits no part"),
        ({"touching": [["top", "leg*"], ["a*", "b"]]}, "touching[1]", "'a*' and 'b' fits no part"),
        ({"apart": [["top", "top"]]}, "apart[0]", "means one part alone"),
        ({"apart": [["top", "leg*"]], "touching": [["leg 1", "top"]]}, "apart", "'leg 1' and 'top' stand in touching"),
        ({"touching": [["top"]]}, "touching[0]", 'two names such as ["top", "leg*"]'),
        ({"touching": [["top", 5]]}, "touching[0][1]", "a part's name, not 5"),
        ({"touching": "top"}, "touching", "a list of pairs"),
        ({"touching": [["top", "le/g"]]}, "touching[0][1]", "becomes a file's name"),
    ],
)
def test_what_is_wrong_is_said(contacts: dict[str, Any], place: str, says: str) -> None:
    with pytest.raises(RecipeError) as caught:
        read(**contacts)
    told = {problem.place: problem.text for problem in caught.value.problems}
    assert says in told[place]


def test_patterns_that_mean_too_many_pairs_are_refused() -> None:
    many = [{"name": f"a{i}", "box": {"center": [i, 0, 0], "size": [1, 1, 1]}} for i in range(200)]
    with pytest.raises(RecipeError, match=r"apart\[0\]: means more than 20000 pairs"):
        parse({"parts": many, "apart": [["*", "a*"]]}, "many.json", "many")


def test_what_is_stated_goes_before_what_was_measured() -> None:
    stated = Contacts(frozenset({("a", "b")}), frozenset({("c", "d")}))
    measured = Contacts(frozenset({("c", "d"), ("e", "f")}), frozenset({("a", "b"), ("g", "h")}))
    whole = Contacts(frozenset({("a", "b"), ("e", "f")}), frozenset({("c", "d"), ("g", "h")}))
    assert beside(stated, measured) == whole


def test_parts_touch_within_a_share_of_the_median_part() -> None:
    assert reach(np.array([[10, 400, 20], [500, 1, 1], [9, 9, 9000]])) == 10
