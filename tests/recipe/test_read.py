"""What is read, and what is said about files that cannot be."""

from __future__ import annotations

import json
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foldfab.errors import RecipeError
from foldfab.recipe.build import Gathered
from foldfab.recipe.model import Pattern
from foldfab.recipe.read import MOST_PROBLEMS, parse, read

STOOL: dict[str, Any] = {
    "parts": [
        {"name": "seat", "box": {"center": [0, 0, 410], "size": [400, 400, 20]}},
        {"name": "leg", "box": {"center": [0, 0, 200], "size": [50, 400, 400]}},
    ]
}


def changed(*path: Any) -> dict[str, Any]:
    """The stool with the last argument put at the path before it."""
    *steps, last, value = path
    data = deepcopy(STOOL)
    target: Any = data
    for step in steps:
        target = target.setdefault(step, {}) if isinstance(target, dict) else target[step]
    target[last] = value
    return data


def problems(data: object, default_name: str = "stool") -> dict[str, str]:
    """By place, what parsing `data` complains about."""
    with pytest.raises(RecipeError) as caught:
        parse(data, "stool.json", default_name)
    assert caught.value.exit_status == 2
    return {problem.place: problem.text for problem in caught.value.problems}


BOX, PIN, FORBID = ("parts", 0, "box"), ("parts", 0, "pin"), ("parts", 0, "forbid")
BROKEN = [
    ([], "recipe", "object"),
    ("text", "recipe", "object"),
    ({}, "parts", "is missing"),
    (changed("parts", []), "parts", "1 to 2000"),
    (changed("parts", [STOOL["parts"][0]] * 20001), "parts", "a list of 20001"),
    (changed("parts", {}), "parts", "an object"),
    (changed("parts", 0, "seat"), "parts[0]", "an object such as"),
    (changed("parts", 0, {"name": "seat"}), "parts[0].box", "is missing"),
    (changed("parts", 0, {"box": STOOL["parts"][0]["box"]}), "parts[0].name", "is missing"),
    (changed("parts", 0, {"name": "seat", "mesh": "seat.obj"}), "parts", "names a file"),
    (changed("model", "stool.step"), "model", "names a file"),
    (changed("model", ""), "model", "should be a file's name"),
    (changed("parts", 0, "mesh", 5), "parts[0].mesh", "name of a file of shapes"),
    (changed("parts", 0, "mesh", "a.obj"), "parts[0]", "a box and a mesh"),
    (changed("parts", 0, "ignore", True), "parts[0]", "for bodies of a"),
    (changed("parts", 0, "merge", "all"), "parts[0]", "for bodies of a"),
    (changed("parts", 0, "merge", "a/b"), "parts[0].merge", "'-' instead"),
    (changed("parts", 0, "name", "leg*"), "parts[0].name", "'-' instead"),
    ({"model": "a.step", "parts": [{"name": "leg*", "ignore": True, "merge": "x"}]}, "parts[0]", "keep one"),
    ({"model": "a.step", "parts": [{"name": "leg*", "mesh": "x.obj"}]}, "parts[0]", "'-' instead"),
    (changed("parts", 0, "name", ""), "parts[0].name", "empty"),
    (changed("parts", 0, "name", "  "), "parts[0].name", "empty"),
    (changed("parts", 0, "name", " seat"), "parts[0].name", "blanks"),
    (changed("parts", 0, "name", "se\nat"), "parts[0].name", "control"),
    (changed("parts", 0, "name", "\ud800"), "parts[0].name", "control"),
    (changed("parts", 0, "name", "seat/2"), "parts[0].name", "'-' instead"),
    (changed("parts", 0, "name", "se\\at"), "parts[0].name", "'-' instead"),
    (changed("parts", 0, "name", "s" * 101), "parts[0].name", "101 characters"),
    (changed("parts", 0, "name", ".."), "parts[0].name", "dot"),
    (changed("parts", 0, "name", "NUL"), "parts[0].name", "Windows"),
    (changed("parts", 0, "name", 5), "parts[0].name", "text"),
    (changed("parts", 0, "name", "leg"), "parts[1].name", "repeats"),
    (changed("parts", 0, "name", "LEG"), "parts[1].name", "case"),
    (changed("parts", 0, "hingeable", "no"), "parts[0].hingeable", "true or false"),
    (changed("parts", 0, "hingable", False), "parts[0].hingable", 'did you mean "hingeable"'),
    (changed("parts", 0, "size", [1, 2, 3]), "parts[0].size", "belongs in box"),
    (changed("pin", {"hinges": 1}), "pin", "belongs in parts[]"),
    (changed("parts", 0, "hinges", 1), "parts[0].hinges", "belongs in pin"),
    (changed(*BOX, "forbid", []), "parts[0].box.forbid", "belongs in parts[]"),
    (changed(*PIN, []), "parts[0].pin", 'an object such as {"mechanism"'),
    (changed(*PIN, {}), "parts[0].pin", "empty, so it would pin nothing"),
    (changed(*PIN, {"hinges": None}), "parts[0].pin", "empty, so it would pin nothing"),
    (changed(*PIN, {"hinge": 1}), "parts[0].pin.hinge", 'did you mean "hinges"'),
    (changed(*PIN, {"hinges": 10}), "parts[0].pin.hinges", "whole number from 0 to 9, not 10"),
    (changed(*PIN, {"hinges": -1}), "parts[0].pin.hinges", "from 0 to 9"),
    (changed(*PIN, {"hinges": True}), "parts[0].pin.hinges", "whole number"),
    (changed(*PIN, {"hinges": 4}), "parts[0].pin.hinges", "4 is more than fold.max_hinges 3 allows"),
    (changed(*PIN, {"mechanism": "slant"}), "parts[0].pin.mechanism", '"in-place", "slanted", "deleted"'),
    (changed(*PIN, {"side": "left"}), "parts[0].pin.side", '"l" or "r"'),
    (changed(*PIN, {"window": 1}), "parts[0].pin.window", "two shares of the width"),
    (changed(*PIN, {"window": [0, 0.2, 1]}), "parts[0].pin.window", "a list of 3"),
    (changed(*PIN, {"window": [0, 1.2]}), "parts[0].pin.window[1]", "from 0 to 1, not 1.2"),
    (changed(*PIN, {"window": [-0.2, 1]}), "parts[0].pin.window[0]", "from 0 to 1"),
    (changed(*PIN, {"window": [0.4, 0.4]}), "parts[0].pin.window", "begin before it ends"),
    (changed(*PIN, {"window": [0, 0.25]}), "parts[0].pin.window", "the nearest window is [0, 0.2]"),
    (changed(*PIN, {"mechanism": "deleted", "side": "l"}), "parts[0].pin", '"deleted" and for side'),
    (changed(*PIN, {"mechanism": "slanted", "hinges": 1}), "parts[0].pin", "slanted gets none"),
    (changed(*PIN, {"mechanism": "in-place", "hinges": 0}), "parts[0].pin", "without hinges"),
    (changed(*FORBID, {}), "parts[0].forbid", "a list of at most 100 patterns"),
    (changed(*FORBID, [{"side": "l"}] * 101), "parts[0].forbid", "a list of 101"),
    (changed(*FORBID, [1]), "parts[0].forbid[0]", "an object such as"),
    (changed(*FORBID, [{"side": "l"}, {}]), "parts[0].forbid[1]", "empty, so it would forbid everything"),
    (changed(*FORBID, [{"window": [0, 0.5]}]), "parts[0].forbid[0].window", "[0, 0.4]"),
    (changed(*FORBID, [{"hinges": 5}]), "parts[0].forbid[0].hinges", "max_hinges 3"),
    (changed(*FORBID, [{"mechanism": "deleted", "hinges": 1}]), "parts[0].forbid[0]", "taken away"),
    (changed(*FORBID, [{"sides": "l"}]), "parts[0].forbid[0].sides", 'did you mean "side"'),
    (changed(*BOX, "size", [400, 0, 20]), "parts[0].box.size[1]", "above 0"),
    (changed(*BOX, "size", [400, -1, 20]), "parts[0].box.size[1]", "above 0"),
    (changed(*BOX, "size", [400, float("nan"), 20]), "parts[0].box.size[1]", "NaN"),
    (changed(*BOX, "size", [float("inf"), 1, 20]), "parts[0].box.size[0]", "infinity"),
    (changed(*BOX, "size", [2e6, 1, 20]), "parts[0].box.size[0]", "unit"),
    (changed(*BOX, "size", [1e-5, 1, 20]), "parts[0].box.size[0]", "unit"),
    (changed(*BOX, "size", [400, 20]), "parts[0].box.size", "a list of 2"),
    (changed(*BOX, "size", ["400", 1, 1]), "parts[0].box.size[0]", "'400'"),
    (changed(*BOX, "center", [0, True, 0]), "parts[0].box.center[1]", "true"),
    (changed(*BOX, "center", [0, 0, -2e6]), "parts[0].box.center[2]", "1000000 mm"),
    (changed(*BOX, "center", [0, 0, 10**400]), "parts[0].box.center[2]", "finite"),
    (changed(*BOX, "axes", [[1, 0, 0], [0, 1, 0], [0, 0, -1]]), "parts[0].box.axes", "right-handed"),
    (changed(*BOX, "axes", [[1, 0, 0], [0.1, 1, 0], [0, 0, 1]]), "parts[0].box.axes", "right angles"),
    (changed(*BOX, "axes", [[2, 0, 0], [0, 1, 0], [0, 0, 1]]), "parts[0].box.axes", "unit rows"),
    (changed(*BOX, "axes", [[1e200, 0, 0], [0, 1, 0], [0, 0, 1]]), "parts[0].box.axes", "unit rows"),
    (changed(*BOX, "axes", [[1, 0, 0], [0, 1, 0]]), "parts[0].box.axes", "three rows"),
    (changed(*BOX, "axes", [[1, 0], [0, 1, 0], [0, 0, 1]]), "parts[0].box.axes[0]", "a row of three"),
    (changed(*BOX, "axes", [[1, 0, "z"], [0, 1, 0], [0, 0, 1]]), "parts[0].box.axes[0][2]", "finite number"),
    (changed("direction", [0, 0, 0]), "direction", "zero"),
    (changed("direction", "down"), "direction", '"-z"'),
    (changed("direction", [0, 1]), "direction", "three numbers"),
    (changed("direction", [0, float("nan"), 1]), "direction[1]", "NaN"),
    (changed("units", "furlong"), "units", '"mm"'),
    (changed("name", "a/b"), "name", "try 'a-b'"),
    (changed("name", ".stool"), "name", "dot"),
    (changed("name", "COM1"), "name", "Windows"),
    (changed("name", ""), "name", "empty"),
    (changed("name", "n" * 101), "name", "101"),
    (changed("about", "two\nlines"), "about", "one line"),
    (changed("fold", "alpha", 1.1), "fold.alpha", "from 0 to 1"),
    (changed("fold", "max_hinges", 0), "fold.max_hinges", "from 1 to 9"),
    (changed("fold", "max_hinges", 2.0), "fold.max_hinges", "whole number"),
    (changed("fold", "shrink_steps", 21), "fold.shrink_steps", "from 1 to 20"),
    (changed("fold", "slanting", 1), "fold.slanting", "true or false"),
    (changed("fold", "ordering", "best"), "fold.ordering", '"greedy" or "optimal", not \'best\''),
    (changed("fold", "collisions", True), "fold.collisions", '"swept" or "regions", not true'),
    (changed("fold", "symmetry", "yes"), "fold.symmetry", "true or false"),
    (changed("fold", "time_limit", 0), "fold.time_limit", "above 0, at most 3600, not 0"),
    (changed("fold", "time_limit", 3601), "fold.time_limit", "at most 3600"),
    (changed("fold", "time_limit", float("inf")), "fold.time_limit", "infinity"),
    (changed("fold", "time_limits", 1), "fold.time_limits", 'did you mean "time_limit"'),
    (changed("fold", "thickness", 4), "fold.thickness", "belongs in print"),
    (changed("print", "thickness", 0.5), "print.thickness", "from 2 to 20"),
    (changed("print", "shape", "round"), "print.shape", '"plain" or "own"'),
    (changed("print", "clearance", 0.01), "print.clearance", "0.15 to 1"),
    (changed("print", "posture", "sideways"), "print.posture", "folded"),
    (changed("print", "scale", "big"), "print.scale", "fit"),
    (changed("print", "scale", 0), "print.scale", "number"),
    (changed("print", "printer", "mk9"), "print.printer", "prusa-mk4"),
    (changed("print", "printer", {"name": "mine"}), "print.printer.build_volume", "is missing"),
    (
        changed("print", "printer", {"name": "mine", "build_volume": [1, 200, 200]}),
        "print.printer.build_volume[0]",
        "20",
    ),
]


@pytest.mark.parametrize(("data", "place", "words"), BROKEN)
def test_says_where_and_what(data: object, place: str, words: str) -> None:
    assert words in problems(data)[place]


def test_all_problems_at_once() -> None:
    data = changed("fold", "alpha", 2)
    data["direction"] = [0, 0, 0]
    data["parts"][0]["box"]["size"] = [0, 1, 1]
    data["parts"][1]["name"] = "Seat"
    assert set(problems(data)) == {"fold.alpha", "direction", "parts[0].box.size[0]", "parts[1].name"}


def test_counts_what_is_too_much_to_list() -> None:
    found = problems({f"key {i}": i for i in range(MOST_PROBLEMS + 10)})
    assert "11 more" in found["recipe"]


def test_parts_of_files_come_from_a_room_above(tmp_path: Path) -> None:
    file = tmp_path / "stool.json"
    file.write_text('{"model": "stool.step", "parts": [{"name": "leg*", "hingeable": false}]}', encoding="utf-8")
    part = parse(STOOL, "stool.json", "stool").parts[0]
    recipe = read(file, lambda form, path: Gathered((part,), (f"{form.model} of {path.name}",)))
    assert (recipe.name, recipe.parts, recipe.notes) == ("stool", (part,), ("stool.step of stool.json",))


def test_defaults() -> None:
    recipe = parse(STOOL, "stool.json", "stool")
    assert (recipe.name, recipe.direction, recipe.about, recipe.print.scale) == ("stool", None, "", None)
    assert recipe.print.printer.name == "prusa-mk4"
    assert recipe.parts[0].hingeable


def test_the_solvers_own_options() -> None:
    fold = parse(STOOL, "stool.json", "stool").fold
    assert (fold.ordering, fold.collisions, fold.symmetry, fold.time_limit) == ("optimal", "swept", False, 2.0)
    given = {"ordering": "optimal", "collisions": "regions", "symmetry": True, "time_limit": 30}
    fold = parse({**STOOL, "fold": given}, "stool.json", "stool").fold
    assert (fold.ordering, fold.collisions, fold.symmetry, fold.time_limit) == ("optimal", "regions", True, 30.0)


def test_pinned_and_forbidden() -> None:
    seat, leg = parse(STOOL, "stool.json", "stool").parts
    assert (seat.pin, seat.forbid) == (leg.pin, leg.forbid) == (None, ())
    data = changed(*PIN, {"hinges": 1, "window": [0, 0.3333]})
    data["parts"][0]["forbid"] = [{"mechanism": "slanted"}, {"side": "l"}]
    data["fold"] = {"shrink_steps": 3}
    seat = parse(data, "stool.json", "stool").parts[0]
    assert seat.pin == Pattern(hinges=1, window=(0.0, 1 / 3))
    assert seat.forbid == (Pattern("slanted"), Pattern(side="l"))


def test_a_pin_that_its_part_cannot_follow() -> None:
    data = changed(*PIN, {"hinges": 1})
    data["parts"][0]["hingeable"] = False
    assert '"hingeable": false' in problems(data)["parts[0].pin"]


def test_a_pin_that_is_forbidden() -> None:
    data = changed(*PIN, {"hinges": 1, "side": "l"})
    data["parts"][0]["forbid"] = [{"hinges": 3}, {"side": "l"}]
    assert problems(data) == {"parts[0].forbid[1]": "forbids all that pin asks for"}


def test_patterns_are_not_judged_by_options_that_are_wrong() -> None:
    data = changed("fold", {"shrink_steps": 0, "max_hinges": "5"})
    data["parts"][0]["pin"] = {"hinges": 5, "window": [0, 0.123]}
    assert set(problems(data)) == {"fold.shrink_steps", "fold.max_hinges"}


def test_units_are_converted() -> None:
    recipe = parse(changed("units", "in"), "stool.json", "stool")
    assert recipe.parts[0].size == pytest.approx([10160, 10160, 508])


def test_direction_becomes_a_unit_vector() -> None:
    assert parse(changed("direction", "-y"), "", "a").direction == pytest.approx([0, -1, 0])
    for vector in ([0, 3, 4], [0, 3e-200, 4e-200], [0, 3e200, 4e200]):
        assert parse(changed("direction", vector), "", "a").direction == pytest.approx([0, 0.6, 0.8])


def test_nearly_orthonormal_axes_become_exact() -> None:
    recipe = parse(changed(*BOX, "axes", [[0.7071, 0.7071, 0], [-0.7071, 0.7071, 0], [0, 0, 1]]), "", "a")
    axes = recipe.parts[0].axes
    assert np.abs(axes @ axes.T - np.eye(3)).max() < 1e-14


def test_a_file_name_that_is_no_folder_name() -> None:
    assert "my-chair" in problems(STOOL, "my chair")["name"]


def test_name_is_the_stem(tmp_path: Path) -> None:
    path = tmp_path / "stool.v2.json"
    path.write_text(json.dumps(STOOL), encoding="utf-8-sig")
    assert read(path).name == "stool.v2"


keys_of_a_recipe = st.sampled_from(
    ["name", "parts", "box", "center", "size", "axes", "print", "printer", "fold", "scale", "direction", "<own>", "x y"]
)
json_values = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys_of_a_recipe, inner, max_size=4),
    max_leaves=12,
)


@given(json_values)
def test_nothing_but_recipe_errors(data: object) -> None:
    with pytest.raises(RecipeError):
        parse({"parts": [data], "print": data, "direction": data}, "any.json", "any")
