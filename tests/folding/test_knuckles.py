"""Interrupted hinges get back what has room."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from foldfab.folding import anatomy
from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part
from foldfab.validity.verify import violations


@pytest.fixture(scope="module")
def made(solution: Callable[..., FoldSolution], butting: tuple[Part, ...]) -> FoldSolution:
    found: FoldSolution = solution(butting, slanting=False)
    return found


def test_only_the_piece_in_the_way_stays_free(made: FoldSolution) -> None:
    (mark,) = made.chain("back").breaks
    # Pieces of 20 mm, and half the gap of 0.3 mm on both sides.
    assert mark == pytest.approx((-10.15, 10.15))
    assert made.chain("back").stretches(1) == (pytest.approx((-50, -10.15)), pytest.approx((10.15, 50)))


def test_boxes_are_told_by_stretches(made: FoldSolution) -> None:
    chain = made.chain("back")
    feet = anatomy.anchor_feet(chain, made.thickness)
    assert sorted((feet.center @ chain.along - chain.root @ chain.along).tolist()) == pytest.approx([-30.075, 30.075])
    assert len(anatomy.moving_boxes(chain, made.thickness, anatomy.OPEN_AND_FOLDED)[0]) == 2 + 2
    whole = replace(chain, breaks=())
    assert len(anatomy.moving_boxes(whole, made.thickness, anatomy.OPEN_AND_FOLDED)[0]) == 2 + 1


def test_with_all_knuckles_it_would_be_invalid(made: FoldSolution) -> None:
    chains = tuple(replace(c, breaks=()) for c in made.chains)
    found = violations(replace(made, chains=chains))
    assert {v.kind for v in found} == {"collision"} and all({"side"} & {p[:4] for p in v.parts} for v in found)


@pytest.mark.parametrize(
    ("breaks", "told"),
    [(((-46.0, 46.0),), "too little to hold it"), (((10.0, 20.0), (-20.0, -10.0)), "do not ascend")],
)
def test_breaks_that_are_wrong_are_found(
    made: FoldSolution, breaks: tuple[tuple[float, float], ...], told: str
) -> None:
    chains = tuple(replace(c, breaks=breaks) if c.patch == "back" else c for c in made.chains)
    assert any(told in v.text for v in violations(replace(made, chains=chains)))
