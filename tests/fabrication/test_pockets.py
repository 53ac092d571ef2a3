"""What a stop passes in a third body is cut out there, unless a hinge is in the way."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.build import build
from foldfab.fabrication.inspect import instants
from foldfab.fabrication.levers import levers
from foldfab.fabrication.mounts import mount
from foldfab.fabrication.passing import Passage
from foldfab.fabrication.places import Plane
from foldfab.fabrication.pockets import pocket
from foldfab.fabrication.printed import printed
from foldfab.fabrication.trial import Trial
from foldfab.folding.model import FoldSolution

PLATE = solids.box((0, 0, 0), (40, 40, 3))
FLAT = Plane(np.zeros(3), np.eye(3))
GAP = 0.3


def test_a_shallow_pocket_is_as_deep_as_it_must_be() -> None:
    assert holes(1.5) == pytest.approx((19.7, 24.3, 1.2))


def test_a_pocket_that_leaves_a_skin_goes_through() -> None:
    assert holes(1.0)[2] < 0.0


def test_a_pocket_close_to_an_edge_is_opened_there() -> None:
    low, high, _ = holes(1.5, at=35.0)
    assert (low, high) == pytest.approx((34.7, 40.2))
    assert holes(1.5, at=34.8)[1] == pytest.approx(39.1)


def test_no_pocket_is_cut_where_a_hinge_is() -> None:
    taken = [solids.box((20, 18, 1.5), (24, 22, 5))]
    for at, is_free in ((26.0, True), (24.0, False)):
        hinge = np.array([[at, 18, 2], [at + 4, 30, 5.0]])
        assert (pocket(PLATE, FLAT, taken, GAP, [hinge]) is not None) is is_free


def test_a_pocket_lies_along_the_plate_of_its_body() -> None:
    sin, cos = np.sin(0.5), np.cos(0.5)
    plane = Plane(np.array([1.0, 2.0, 3.0]), np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]]))
    leant = solids.placed(PLATE, plane.origin, plane.across)
    taken = [solids.placed(solids.box((20, 18, 1.5), (24, 22, 5)), plane.origin, plane.across)]
    hole = pocket(leant, plane, taken, GAP, [])
    assert hole is not None
    low, high = solids.bounds(plane.laid(printed(hole)))
    assert (low[0], high[0], low[2]) == pytest.approx((19.7, 24.3, 1.2))


def test_a_tongue_that_stands_up_folded_gets_a_pocket_in_the_base_that_comes_down_on_it(
    solution: Callable[..., FoldSolution],
) -> None:
    made = build(solution("same_way", thickness=3.0), "open")
    bare = {body.name: solids.from_mesh(body.vertices, body.faces) for body in made.bodies}
    low, high = solids.bounds(bare["ceiling"])
    low[2] = high[2] - 2.9
    filled = {**bare, "ceiling": solids.union([bare["ceiling"], solids.box(low, high)])}
    chain = made.solution.chain("far")
    stop = mount(made.solution, chain, 0)
    tongue = stop.placed(next(levers(stop, is_latched=False)))
    for solid in (bare, filled):
        fitted = Trial(made, solid).fitted(tongue)
        assert fitted is not None
        assert set(fitted.pockets) == (set() if solid is bare else {"ceiling"})
        trial = Trial(made, solid)
        trial.take(fitted)
        passage = Passage(made.solution, instants(made))
        met = [
            passage.meets("far", printed(tongue.added), "ceiling", s["ceiling"], above=0.005)
            for s in (solid, trial.made)
        ]
        assert met == [solid is filled, False]


def holes(bottom: float, at: float = 20.0) -> tuple[float, float, float]:
    """From where to where in x, and how deep down, a pocket reaches for what takes 4 mm from `at` on."""
    hole = pocket(PLATE, FLAT, [solids.box((at, 18, bottom), (at + 4, 22, 3))], GAP, [])
    assert hole is not None
    low, high = solids.bounds(printed(hole))
    return float(low[0]), float(high[0]), float(low[2])
