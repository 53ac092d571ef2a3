"""What a stop passes in a third body is cut out there, unless a hinge is in the way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.build import build
from foldfab.fabrication.inspect import instants
from foldfab.fabrication.levers import levers
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.mounts import Stop, mount
from foldfab.fabrication.passing import Passage
from foldfab.fabrication.places import Plane
from foldfab.fabrication.pockets import pocket
from foldfab.fabrication.printed import printed
from foldfab.fabrication.solids import Solid
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


@pytest.fixture(scope="module")
def made(solution: Callable[..., FoldSolution]) -> Assembly:
    """A ceiling of 3 mm that swings over on two walls."""
    return build(solution("same_way", thickness=3.0), "open")


@pytest.fixture(scope="module")
def bare(made: Assembly) -> dict[str, Solid]:
    """Its solids, with the pockets that they have."""
    return {body.name: solids.from_mesh(body.vertices, body.faces) for body in made.bodies}


@pytest.fixture(scope="module")
def filled(bare: dict[str, Solid]) -> dict[str, Solid]:
    """The same without pockets in the ceiling."""
    low, high = solids.bounds(bare["ceiling"])
    low[2] = high[2] - 2.9
    return {**bare, "ceiling": solids.union([bare["ceiling"], solids.box(low, high)])}


@pytest.fixture(scope="module")
def tongue(made: Assembly) -> Stop:
    """What stops one of the walls on the ground."""
    here = mount(made.solution, made.solution.chain("far"), 0)
    return here.placed(next(levers(here, is_latched=False)))


def test_a_tongue_that_stands_up_folded_gets_a_pocket_in_the_base_that_comes_down_on_it(
    made: Assembly, bare: dict[str, Solid], filled: dict[str, Solid], tongue: Stop
) -> None:
    passage = Passage(made.solution, instants(made))
    for solid in (bare, filled):
        trial = Trial(made, solid)
        fitted = trial.fitted(tongue)
        assert fitted is not None
        assert set(fitted.pockets) == (set() if solid is bare else {"ceiling"})
        trial.take(fitted)
        pair = [s["ceiling"] for s in (solid, trial.made)]
        met = [passage.meets("far", printed(tongue.added), "ceiling", s, above=0.005) for s in pair]
        assert met == [solid is filled, False]


def test_a_pocket_that_takes_the_stop_of_another_hinge_is_not_cut(
    made: Assembly, bare: dict[str, Solid], filled: dict[str, Solid], tongue: Stop
) -> None:
    # With the slots that a filled ceiling lacks.
    slotted = {**bare, "ceiling": solids.union([bare["ceiling"], *pieces_far_from_slots(made, bare, filled)])}
    trial = Trial(made, slotted)
    fitted = trial.fitted(tongue)
    assert fitted is not None and set(fitted.pockets) == {"ceiling"}
    assert trial.has_room(fitted)
    hinge = next(joint for joint in made.joints if joint.name == "near~ceiling")
    reach = np.array([12, 1, 8])
    around = solids.box(hinge.axis.min(0) - reach, hinge.axis.max(0) + reach)
    spoilt = {**fitted.changed, "ceiling": solids.cut(fitted.changed["ceiling"], [around])}
    assert not trial.has_room(replace(fitted, changed=spoilt))


def pieces_far_from_slots(made: Assembly, bare: dict[str, Solid], filled: dict[str, Solid]) -> list[Solid]:
    """What fills the pockets of the ceiling and not the slots around its hinges."""
    ends = [joint.axis for joint in made.joints if "ceiling" in joint.parts]
    reach = np.array([8, 1, 8])
    slots = [solids.box(axis.min(0) - reach, axis.max(0) + reach) for axis in ends]
    return [solids.cut(filled["ceiling"], [bare["ceiling"], *slots])]


def holes(bottom: float, at: float = 20.0) -> tuple[float, float, float]:
    """From where to where in x, and how deep down, a pocket reaches for what takes 4 mm from `at` on."""
    hole = pocket(PLATE, FLAT, [solids.box((at, 18, bottom), (at + 4, 22, 3))], GAP, [])
    assert hole is not None
    low, high = solids.bounds(printed(hole))
    return float(low[0]), float(high[0]), float(low[2])
