"""Bodies that meet, at a sample or only between two, and bodies that only touch."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.geometry.arrays import Array
from foldfab.validity.collisions import Meeting, meetings
from foldfab.validity.configuration import spanning_tree
from foldfab.validity.model import Body, Folding, Hinge, Linkage

Sheets, Hinges, Foldings, Lumps = Callable[..., Body], Callable[..., Hinge], Callable[..., Folding], Callable[..., Body]


def met(folding: Folding) -> list[Meeting]:
    """The meetings of a folding."""
    return meetings(folding, spanning_tree(folding.linkage))


def swing(to: float) -> Callable[[Array], Array]:
    """One hinge that turns evenly."""
    return lambda times: times[:, None] * to


@pytest.mark.parametrize("thickness", [0.0, 0.1, 4.0])
@pytest.mark.parametrize("moments", [2, 3, 20])
def test_a_leaf_that_swings_through_a_post(
    thickness: float, moments: int, sheet: Sheets, hinge: Hinges, folding: Foldings, lump: Lumps
) -> None:
    """Samples as far as a quarter turn apart do not miss it."""
    ground = lump(sheet("ground", (0, 0), (60, 0), base=True), sheet("post", (30, 8), (30, 30), thickness, base=True))
    leaf = sheet("leaf", (10, 3), (10, 60), thickness)
    found = met(folding([ground, leaf], [hinge("ground", "leaf", 10, 3)], swing(np.pi / 2), moments))
    assert [(m.first, m.second) for m in found] == [("ground", "leaf")]
    assert found[0].depth > 0.05


def test_a_leaf_that_lies_down_touches_only(sheet: Sheets, hinge: Hinges, folding: Foldings) -> None:
    ground, leaf = sheet("ground", (0, 0), (60, 0), base=True), sheet("leaf", (10, 0), (10, 30))
    assert met(folding([ground, leaf], [hinge("ground", "leaf", 10, 0)], swing(np.pi / 2))) == []


def test_a_leaf_that_folds_through_what_carries_it(sheet: Sheets, hinge: Hinges, folding: Foldings) -> None:
    ground, leaf = sheet("ground", (0, 0), (60, 0), 4.0, base=True), sheet("leaf", (10, 5), (10, 35), 4.0)
    held = hinge("ground", "leaf", 10, 5, 4.0)
    assert met(folding([ground, leaf], [held], swing(np.pi / 2))) == []
    found = met(folding([ground, leaf], [held], swing(np.pi / 2 + 0.3)))
    assert [(m.first, m.second) for m in found] == [("ground", "leaf")]
    assert 0.8 < found[0].time < 1.0


def test_knuckles_may_interleave_and_nothing_else(sheet: Sheets, hinge: Hinges, folding: Foldings) -> None:
    foot, leaf = sheet("foot", (10, 0), (10, 7), 4.0, base=True), sheet("leaf", (10, 5), (10, 35), 4.0)
    assert met(folding([foot, leaf], [hinge("foot", "leaf", 10, 5, 4.0)], swing(np.pi / 2))) == []
    assert met(folding([foot, leaf], [hinge("foot", "leaf", 10, 5, 1.0)], swing(np.pi / 2)))


def test_sheets_that_pass_through_each_other_while_parallel(
    table: Linkage, sheet: Sheets, folding: Foldings, lump: Lumps
) -> None:
    shelf = lump(table.bodies[0], sheet("shelf", (44, 21.7), (70, 21.7)))
    whole = folding([shelf, *table.bodies[1:]], table.hinges, lambda t: np.repeat(t[:, None] * np.pi / 2, 4, 1), 8)
    pairs = {(m.first, m.second) for m in met(whole)}
    assert ("ground", "top") in pairs
    beside = lump(table.bodies[0], sheet("shelf", (-30, 21.7), (-1, 21.7)))
    clear = folding([beside, *table.bodies[1:]], table.hinges, whole.angles, 8)
    assert met(clear) == []


@pytest.mark.parametrize("over", [-0.01, 0.2])
def test_what_sheets_cover_of_each_other_is_told_at_the_moment_of_passing(
    over: float, table: Linkage, sheet: Sheets, folding: Foldings, lump: Lumps
) -> None:
    """The top comes down on an arc: halfway between two samples its edge is a quarter of a millimetre further on."""
    edge = 40 * np.sqrt(1 - (21.7 / 40) ** 2)
    ground = lump(table.bodies[0], sheet("shelf", (3, 21.7), (edge + over, 21.7), y=30.0))
    top = lump(table.bodies[1], sheet("top", (0, 40), (60, 40), y=30.0))
    whole = folding(
        [ground, top, *table.bodies[2:]], table.hinges, lambda t: np.repeat(t[:, None] * np.pi / 2, 4, 1), 8
    )
    found = [(m.first, m.second, round(m.depth, 3)) for m in met(whole)]
    assert found == ([("ground", "top", over)] if over > 0 else [])


def test_what_meets_at_the_start_and_does_not_move(sheet: Sheets, hinge: Hinges, folding: Foldings) -> None:
    ground, leaf = sheet("ground", (0, 0), (60, 0)), sheet("leaf", (10, -5), (10, 30))
    found = met(folding([ground, leaf], [hinge("ground", "leaf", 10, 0)], swing(0.0)))
    assert [(m.time, round(m.depth, 6)) for m in found] == [(0.0, 5.0)]


def test_two_that_never_come_near(table: Linkage, folding: Foldings) -> None:
    assert met(folding(table.bodies, table.hinges, lambda t: np.repeat(t[:, None] * np.pi / 2, 4, 1))) == []
