"""Values from the command line."""

from __future__ import annotations

from typing import Any

import pytest

from foldfab.errors import RecipeError
from foldfab.recipe.edit import override
from foldfab.recipe.model import Recipe
from foldfab.recipe.read import parse

RECIPE = parse({"parts": [{"name": "a", "box": {"center": [0, 0, 0], "size": [1, 1, 1]}}]}, "a.json", "a")


def test_nothing_given_changes_nothing() -> None:
    same = override(RECIPE)
    assert (same.direction, same.fold, same.print) == (RECIPE.direction, RECIPE.fold, RECIPE.print)


def test_text_becomes_values() -> None:
    recipe = override(
        RECIPE,
        direction="0,0,-2",
        printer="200x200x180",
        scale="1:5",
        clearance="0.25",
        thickness="3",
        posture="folded",
        alpha="1",
        max_hinges="5",
        shrink_steps="4",
        slanting=False,
        stay_in_box=True,
        ordering="optimal",
        collisions="regions",
        symmetry=True,
        time_limit="30",
    )
    assert recipe.direction == pytest.approx([0, 0, -1])
    assert recipe.print.printer.build_volume == (200, 200, 180)
    assert (recipe.print.scale, recipe.print.clearance, recipe.print.thickness) == (0.2, 0.25, 3.0)
    assert (recipe.fold.alpha, recipe.fold.max_hinges, recipe.fold.shrink_steps) == (1.0, 5, 4)
    assert (recipe.fold.slanting, recipe.fold.stay_in_box, recipe.print.posture) == (False, True, "folded")
    assert (recipe.fold.ordering, recipe.fold.collisions, recipe.fold.symmetry) == ("optimal", "regions", True)
    assert recipe.fold.time_limit == 30.0 and isinstance(recipe.fold.time_limit, float)


def test_back_to_fit_and_auto() -> None:
    fixed = override(RECIPE, scale=0.5, direction="-x")
    assert fixed.direction == pytest.approx([-1, 0, 0])
    free = override(fixed, scale="fit", direction="auto")
    assert (free.print.scale, free.direction) == (None, None)


@pytest.mark.parametrize(
    ("values", "place", "words"),
    [
        ({"alpha": "2"}, "--alpha", "from 0 to 1"),
        ({"alpha": "much"}, "--alpha", "'much'"),
        ({"alpha": "nan"}, "--alpha", "NaN"),
        ({"max_hinges": "2.5"}, "--max-hinges", "whole number"),
        ({"shrink_steps": 0}, "--shrink-steps", "from 1 to 20"),
        ({"ordering": "fastest"}, "--ordering", '"greedy" or "optimal", not \'fastest\''),
        ({"ordering": "1"}, "--ordering", '"greedy" or "optimal"'),
        ({"collisions": "none"}, "--collisions", '"swept" or "regions"'),
        ({"symmetry": "yes"}, "--symmetry", "true or false"),
        ({"time_limit": "0"}, "--time-limit", "above 0, at most 3600"),
        ({"time_limit": "5000"}, "--time-limit", "at most 3600"),
        ({"time_limit": "soon"}, "--time-limit", "'soon'"),
        ({"thickness": "0"}, "--thickness", "from 2 to 20"),
        ({"clearance": "5"}, "--clearance", "0.15 to 1"),
        ({"posture": "sideways"}, "--posture", "folded"),
        ({"printer": "mk9"}, "--printer", "prusa-mk4"),
        ({"printer": "1x1x1"}, "--printer", "sides"),
        ({"scale": "1:0"}, "--scale", "fit"),
        ({"scale": "-1"}, "--scale", "number"),
        ({"direction": "0,0,0"}, "--direction", "zero"),
        ({"direction": "down"}, "--direction", '"-z"'),
        ({"direction": "1,a,0"}, "--direction", "'a'"),
        ({"direction": "1,0"}, "--direction", "three numbers"),
    ],
)
def test_says_which_option_is_wrong(values: dict[str, Any], place: str, words: str) -> None:
    with pytest.raises(RecipeError) as caught:
        override(RECIPE, **values)
    (problem,) = caught.value.problems
    assert problem.place == place
    assert words in problem.text


def test_all_wrong_options_at_once() -> None:
    with pytest.raises(RecipeError) as caught:
        override(RECIPE, alpha=3, thickness=0, printer="none", rigid=["b"])
    places = [problem.place for problem in caught.value.problems]
    assert places == ["--alpha", "--thickness", "--printer", "--rigid"]


def named(*names: str) -> Recipe:
    """A recipe with parts of those names."""
    box = {"center": [0, 0, 0], "size": [1, 1, 1]}
    return parse({"parts": [{"name": name, "box": box} for name in names]}, "a.json", "a")


def test_rigid_parts() -> None:
    recipe = override(named("seat", "back", "leg"), rigid=["leg", "seat", "leg"])
    assert {part.name: part.hingeable for part in recipe.parts} == {"seat": False, "back": True, "leg": False}


def test_unknown_rigid_parts_are_one_problem() -> None:
    with pytest.raises(RecipeError) as caught:
        override(named("Seat", "back", "leg"), rigid=["seat", "back", "bakc", "wheel", "wheel"])
    (problem,) = caught.value.problems
    assert problem.place == "--rigid"
    assert problem.text == (
        "no part is named 'seat' (did you mean Seat?) or 'bakc' (did you mean back?) or 'wheel'; "
        "there are Seat, back, leg"
    )


PIN = {"hinges": 3, "window": [0, 0.4]}


@pytest.mark.parametrize(
    ("values", "place", "text"),
    [
        (
            {"shrink_steps": 4},
            "--shrink-steps",
            "contradicts parts[0].pin.window: [0, 0.4] does not lie on the cuts of fold.shrink_steps 4, "
            "which are multiples of 1/4; the nearest window is [0, 0.5]",
        ),
        (
            {"max_hinges": "2"},
            "--max-hinges",
            "contradicts parts[0].pin.hinges: 3 is more than fold.max_hinges 2 allows",
        ),
        (
            {"rigid": ["seat"]},
            "--rigid",
            'contradicts parts[0].pin: asks for hinges 3, which the part cannot have because it is "hingeable": false',
        ),
        ({"max_hinges": 10}, "--max-hinges", "should be a whole number from 1 to 9, not 10"),
    ],
)
def test_options_that_contradict_a_pin(values: dict[str, Any], place: str, text: str) -> None:
    box = {"center": [0, 0, 0], "size": [1, 1, 1]}
    recipe = parse({"parts": [{"name": "seat", "box": box, "pin": PIN}]}, "a.json", "a")
    with pytest.raises(RecipeError) as caught:
        override(recipe, **values)
    (problem,) = caught.value.problems
    assert (problem.place, problem.text) == (place, text)


def test_options_that_contradict_what_is_forbidden() -> None:
    part = {"name": "seat", "box": {"center": [0, 0, 0], "size": [1, 1, 1]}, "forbid": [{"side": "l"}, PIN]}
    recipe = parse({"parts": [part]}, "a.json", "a")
    assert override(recipe, rigid=["seat"], shrink_steps=10).parts[0].forbid == recipe.parts[0].forbid
    with pytest.raises(RecipeError, match=r"contradicts parts\[0\].forbid\[1\].window"):
        override(recipe, shrink_steps=3)


def test_many_parts_are_counted() -> None:
    with pytest.raises(RecipeError, match=r"p29, and 970 more$"):
        override(named(*(f"p{i}" for i in range(1000))), rigid=["wheel"])
