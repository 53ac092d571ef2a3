"""What each style of hinge needs, and what is said where it lacks."""

from __future__ import annotations

import pytest

from foldfab.errors import RecipeError
from foldfab.recipe.edit import override
from foldfab.recipe.hinges import STYLES, HingeKind, hinge_problem
from foldfab.recipe.model import FoldOptions, PrintOptions, Recipe
from foldfab.recipe.printers import DEFAULT_PRINTER


@pytest.mark.parametrize("kind", list(STYLES))
def test_thin_plates_are_refused_with_what_would_do(kind: HingeKind) -> None:
    least = STYLES[kind].least_thickness
    assert hinge_problem(kind, least, "plate") is None
    if kind != "cone":
        told = hinge_problem(kind, least - 0.1, "open")
        assert told is not None
        assert f"at least {least:g} mm" in told
        assert "the hinge cone" in told


def test_parts_that_are_printed_apart_are_not_advised_to_have_cones() -> None:
    assert (hinge_problem("filament", 3.0, "plate") or "").endswith("a thickness of 4 or more, or another posture")
    assert (hinge_problem("screw-m3", 4.0, "plate") or "").endswith("the hinge filament or screw-m2 or clip")


@pytest.mark.parametrize("posture", ["open", "folded", "edge"])
def test_pins_that_are_put_in_later_hold_nothing_in_place(posture: str) -> None:
    refused = [kind for kind in STYLES if hinge_problem(kind, 6.0, posture)]
    assert refused == ["filament", "screw-m2", "screw-m3"]
    assert "posture plate" in (hinge_problem("filament", 6.0, posture) or "")


def test_the_command_line_is_judged_with_the_recipes_own_values() -> None:
    recipe = Recipe("r", None, (), FoldOptions(), PrintOptions(printer=DEFAULT_PRINTER, thickness=3.0))
    with pytest.raises(RecipeError) as caught:
        override(recipe, hinge="clip")
    (problem,) = caught.value.problems
    assert problem.place == "--hinge"
    assert "at least 4 mm, these are 3 mm" in problem.text
    assert override(recipe, hinge="clip", thickness="4").print.hinge == "clip"
    with pytest.raises(RecipeError):
        override(override(recipe, hinge="clip", thickness="4"), thickness="3")
