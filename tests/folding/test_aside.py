"""Slanted lanes are offered only where all of a unit's patches can go along, or where something has to go anyway."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding.aside import bring_back, set_aside
from foldfab.folding.congruent import repertoire
from foldfab.folding.options import DELETION
from foldfab.folding.ordering import floors
from foldfab.folding.problem import Problem
from foldfab.folding.repertoire import made_from_scratch
from foldfab.recipe.model import Part, Pattern

from .brute import cheaper

Make = Callable[..., Problem]


@pytest.mark.parametrize(("name", "patches"), [("corner", {"back", "side"}), ("two_lean", None), ("two_ways", None)])
def test_where_no_way_is_common_to_all_none_slants(problem: Make, name: str, patches: set[str] | None) -> None:
    made = problem(name)
    (unit,) = made.units
    own = repertoire(made, unit)
    assert set(own.aside) == (patches or set(unit.patches))
    for patch in unit.patches:
        assert own.plain[patch] and all(x.drag is None for x in own.plain[patch])
        assert own.aside[patch] and all(x.drag is not None for x in own.aside[patch])


@pytest.mark.parametrize("options", [{}, {"slanting": False}])
def test_what_can_slant_together_is_not_set_aside(problem: Make, options: dict[str, object]) -> None:
    made = problem("same_way", **options)
    own = repertoire(made, made.units[0])
    assert not own.aside
    slants = {x.variant.mechanism for many in own.plain.values() for x in many} == {"slanted"}
    assert slants == (not options)


def test_a_patch_that_can_only_slant_keeps_all_on_offer(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part], box: Callable[..., Part]
) -> None:
    """Whatever happens, one of the two goes."""
    side = wall_at("side", -60, 0, 84)
    rigid = replace(box("back", (0, 38, 42), (60, 4, 80)), hingeable=False)
    made = problem((board_at("ground", 0), board_at("ceiling", 84), side, rigid))
    own = repertoire(made, made.units[0])
    assert not own.aside and any(x.drag is not None for x in own.plain["side"])
    assert floors(made)[made.units[0].name].weight >= DELETION


def test_what_was_set_aside_comes_back_cheapest_first(problem: Make) -> None:
    made = problem("corner")
    (unit,) = made.units
    own = repertoire(made, unit)
    bring_back(own)
    assert not own.aside
    for many in own.plain.values():
        hinges = [x.variant.hinges for x in many]
        assert hinges == sorted(hinges) and {0, 1} <= set(hinges)
    before = dict(own.plain)
    bring_back(own)
    assert own.plain == before


def test_a_unit_that_loses_a_patch_slants_what_is_left(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part], box: Callable[..., Part]
) -> None:
    """With pins that leave the back nothing but to go, the side slants for nothing."""
    back = replace(box("back", (0, 38, 42), (60, 4, 80)), pin=Pattern(mechanism="deleted"))
    made = problem((board_at("ground", 0), board_at("ceiling", 84), wall_at("side", -60, 0, 84), back))
    (unit,) = made.units
    choice = floors(made)[unit.name]
    assert {p: x.variant.mechanism for p, (x, _) in choice.places.items()} == {"side": "slanted"}


@pytest.mark.parametrize("name", ["corner", "two_lean", "three_walls"])
def test_to_set_lanes_aside_costs_nothing(problem: Make, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    options = {"shrink_steps": 2, "max_hinges": 1}
    made = problem(name, **options)
    least = floors(made)[made.units[0].name].weight
    monkeypatch.setattr("foldfab.folding.congruent.set_aside", lambda *_: None)
    whole = problem(name, **options)
    assert floors(whole)[whole.units[0].name].weight == pytest.approx(least, abs=1e-6)
    assert np.isfinite(least) and cheaper(whole, least - 1e-4)[0] is None


def test_lanes_are_set_aside_once_for_all_copies(problem: Make) -> None:
    made = problem("corner")
    own = made_from_scratch(made, made.units[0])
    set_aside(made, own)
    again = dict(own.aside)
    set_aside(made, own)
    assert own.aside == again and all(many for many in own.plain.values())
