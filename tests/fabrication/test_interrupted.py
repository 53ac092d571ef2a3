"""Hinges that are interrupted, as solids."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.build import build
from foldfab.fabrication.hinges import knuckles
from foldfab.fabrication.joinery import with_breaks
from foldfab.fabrication.model import Assembly, Body
from foldfab.folding.model import FoldSolution, Thickness
from foldfab.recipe.model import Part, Printer


@pytest.fixture(scope="module")
def interrupted(solution: Callable[..., FoldSolution], butting: tuple[Part, ...]) -> FoldSolution:
    found: FoldSolution = solution(butting, slanting=False)
    return found


@pytest.fixture(scope="module")
def made(interrupted: FoldSolution) -> Assembly:
    return build(interrupted, "open")


def test_it_works_and_says_where(made: Assembly, assert_printable: Callable[[Body], None]) -> None:
    assert not [finding for finding in made.findings if finding.is_fatal]
    told = [finding.text for finding in made.findings if "interrupted" in finding.text]
    assert told == ["hinges of back interrupted at 0.4-0.6 where side would meet their knuckles"]
    for body in made.bodies:
        assert_printable(body)


def test_there_are_knuckles_on_both_sides_and_none_between(made: Assembly) -> None:
    chain = made.solution.chain("back")
    low = next(body for body in made.bodies if body.name == chain.anchor)
    ground = solids.from_mesh(low.vertices, low.faces)

    def feet(start: float, end: float) -> float:
        """What stands on the plate around the back's first axis, from there to there along it, mm³."""
        ends = chain.root + np.outer([start, end], chain.along)
        half = 2.0 * (np.abs(chain.across) + np.abs(chain.rise))
        return solids.overlap(ground, solids.box(ends.min(0) - half, ends.max(0) + half))

    assert feet(-10, 10) == 0
    assert feet(-50, -10.2) > 10 and feet(10.2, 50) > 10


def test_both_stretches_have_as_many_knuckles_as_their_width_wants(interrupted: FoldSolution) -> None:
    chain = interrupted.chain("back")
    marks = knuckles(chain.hinge_spans[1], interrupted.thickness, chain.breaks)
    alone = knuckles(np.array(chain.stretches(1)[0]), interrupted.thickness)
    assert len(marks.carrier) == 2 * len(alone.carrier) and len(marks.follower) == 2 * len(alone.follower)


def test_breaks_beyond_a_hinge_add_nothing_to_it() -> None:
    thickness = Thickness(4.0, 0.3)
    marks = knuckles(np.array([10.0, 40.0]), thickness, ((-50.0, -10.0),))
    assert marks == replace(knuckles(np.array([10.0, 40.0]), thickness), free=marks.free)


def test_seams_take_no_knuckle_back(interrupted: FoldSolution) -> None:
    scaffold = interrupted.scaffold
    small = replace(scaffold.recipe.print, printer=Printer("small", (90.0, 90.0, 90.0)), scale=1.0)
    asked = replace(interrupted, scaffold=replace(scaffold, recipe=replace(scaffold.recipe, print=small)))
    chain = with_breaks(asked, "plate").chain("back")
    low, high = interrupted.chain("back").breaks[0]
    assert any(a <= low and high <= b for a, b in chain.breaks)
