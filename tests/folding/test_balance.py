"""What makes up the difference between stacks: thickness, then pads, then pockets that leave their bases sound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding.balance import agree, filled, stack, sunk
from foldfab.folding.basic import Variant
from foldfab.folding.model import POCKET_SKIN, FoldSolution
from foldfab.folding.problem import Problem
from foldfab.recipe.model import Part

Make = Callable[..., Problem]
Pair = Callable[..., tuple[Part, ...]]
ONE, THREE = Variant("in-place", 1, "l"), Variant("in-place", 3, "l")


def test_thickness_within_its_limit_comes_before_pads() -> None:
    assert filled(ONE, 4.0, 4.0, by_thickness=True) == replace(ONE, extra=2.0)
    assert filled(ONE, 4.1, 4.0, by_thickness=True) == replace(ONE, pads=(0.0, 4.1))
    assert filled(ONE, 4.0, 4.0, by_thickness=False) == replace(ONE, pads=(0.0, 4.0))
    assert filled(replace(ONE, pads=(1.0, 2.0)), 4.1, 4.0, by_thickness=True).pads == (1.0, pytest.approx(6.1))


def test_rounding_is_nothing_to_make_up() -> None:
    assert filled(ONE, 1e-12, 4.0, by_thickness=True) == filled(ONE, -1e-12, 4.0, by_thickness=False) == ONE


def depths(made: Problem, **wanted: Variant) -> list[dict[str, tuple[float, float]]]:
    """By chain, how deep its pockets at the anchor and at the far base are, in each of the ways that are tried."""
    wanted = wanted or {"one": ONE, "three": THREE}
    return [{p: (round(-v.pads[0], 6), round(-v.pads[1], 6)) for p, v in way.items()} for way in sunk(made, wanted)]


def test_the_highest_sinks_as_deep_as_skins_allow(problem: Make, pair: Pair) -> None:
    """Two pockets in opposite faces of a plate of 4 mm leave 1.2 mm between them."""
    (found,) = depths(problem(pair(74)))
    assert found == {"one": (0, 0), "three": (1.4, 1.4)}
    assert 4.0 - 2 * found["three"][0] == pytest.approx(POCKET_SKIN)


def test_first_only_as_deep_as_thickness_wants(problem: Make, pair: Pair) -> None:
    """13.5 mm are beside 8.9, of which panels of 4 mm make up 4: 0.6 mm are lacking."""
    made = problem(pair(36, 4.0, 3.0))
    first, second = depths(made)
    assert first == {"one": (0, 0), "three": (0.6, 0)}
    assert second == {"one": (0, 0), "three": (1.2, 1.2)}  # no more than 0.4 of its panels
    (way, _) = sunk(made, {"one": ONE, "three": THREE})
    assert stack(made, "three", way["three"]) == pytest.approx(8.9 + 4.0)


def test_all_of_the_highest_sink_to_one_height_and_no_lower_than_others(problem: Make, pair: Pair) -> None:
    walls = pair(74, 4.2, 4.0, hinges=(3, 3))
    (found,) = depths(problem(walls), one=THREE, three=THREE)
    # They differ by 0.8 mm, so that the higher one sinks by that.
    assert found == {"one": (0.8, 0), "three": (0, 0)}


def test_equal_stacks_do_not_sink(problem: Make, pair: Pair) -> None:
    assert depths(problem(pair(74)), one=THREE, three=THREE) == []


def test_nothing_sinks_where_it_stands_on_a_pad(problem: Make, pair: Pair) -> None:
    assert depths(problem(pair(74)), one=ONE, three=replace(THREE, pads=(4.3, 0.0))) == [
        {"one": (0, 0), "three": (-4.3, 1.4)}
    ]


@pytest.mark.parametrize(("boards", "expected"), [(2.0, (0.4, 0.4)), (6.0, (1.6, 1.6)), (1.5, None)])
def test_plates_decide_how_deep(problem: Make, pair: Pair, boards: float, expected: tuple[float, float] | None) -> None:
    """Half of what a skin leaves of a plate, and 0.4 of the panels."""
    parts = tuple(replace(p, thickness=boards) if p.name in ("ground", "ceiling") else p for p in pair(74))
    found = depths(problem(parts))
    assert [way["three"] for way in found] == ([expected] if expected else [])


def test_a_base_at_two_heights_or_askew_has_no_pockets(problem: Make, pair: Pair, box: Callable[..., Part]) -> None:
    step = box("step", (0, 0, 6.0), (30, 80, 8))
    spin = np.array([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    askew = box("askew", (0, 0, 0), (60, 60, 4), spin)
    for more in (step, askew):
        made = problem((*pair(74), more))
        assert [b.parts for b in made.scaffold.bases if more.name in b.parts]
        (found,) = depths(made)
        assert found["three"] == (0, 1.4)


def test_where_pins_come_along_the_axis_there_are_no_pockets(problem: Make, pair: Pair) -> None:
    made = problem(pair(74))
    assert depths(made) and not depths(replace(made, thickness=replace(made.thickness, hinge="filament")))


def test_chains_agree_whose_play_covers_their_snaps(solution: Callable[..., FoldSolution], pair: Pair) -> None:
    chains = solution(pair(78), slanting=False).chains
    assert agree(chains, 0.3) and not agree(chains, 0.2)
    assert agree(chains[:1], 0.2) and agree((), 0.3)
    elsewhere = replace(chains[0], far="another")
    assert agree((elsewhere, chains[1]), 0.2)
