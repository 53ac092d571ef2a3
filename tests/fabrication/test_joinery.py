"""Furniture whose parts are longer than the bed: pieces in their place, hinges shared among them, seams that hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from foldfab.errors import FabricationError
from foldfab.fabrication import solids
from foldfab.fabrication.build import build
from foldfab.fabrication.hinges import knuckles
from foldfab.fabrication.inspect import extent
from foldfab.fabrication.joinery import with_breaks
from foldfab.fabrication.model import Assembly, Body
from foldfab.fabrication.solids import Solid
from foldfab.folding.model import FoldSolution
from foldfab.folding.solve import solve
from foldfab.recipe.model import FoldOptions, Part, Printer, PrintOptions, Recipe
from foldfab.scaffold.abstract import abstract

SMALL = Printer("small", (120.0, 100.0, 100.0))
DOWN = np.array([0.0, 0.0, -1.0])
PARTS = (
    Part("ground", np.array([0, 0, 0]), np.array([160, 200, 4]), np.eye(3)),
    Part("roof", np.array([0, 0, 84]), np.array([160, 200, 4]), np.eye(3)),
    Part("wall", np.array([0, 0, 42]), np.array([4, 180, 80]), np.eye(3)),
)


@cache
def folded(scale: float | None = 1.0) -> FoldSolution:
    printing = PrintOptions(printer=SMALL, scale=scale, posture="plate", hinge="filament")
    return solve(abstract(Recipe("shelter", DOWN, PARTS, FoldOptions(slanting=False), printing), DOWN, 1.0))


@pytest.fixture(scope="module")
def made() -> Assembly:
    return build(folded(), "plate")


def solid(body: Body) -> Solid:
    return solids.from_mesh(body.vertices, body.faces)


def test_every_part_is_cut_into_pieces_under_its_name(made: Assembly) -> None:
    assert set(made.pieces) == {"ground", "roof", "wall/1", "wall/2"}
    names = [body.name for body in made.bodies]
    assert sorted(n for pieces in made.pieces.values() for n in pieces) == names
    assert names[:2] == ["ground:1", "ground:2"]
    told = [f.text for f in made.findings if f.code == "cut"]
    assert "wall/1 is longer than the bed: 2 pieces, joined by 1 dovetail with a gap of 0.15 mm" in told


def test_pieces_are_sound_and_fit(made: Assembly, assert_printable: Callable[[Body], None]) -> None:
    for body in made.bodies:
        assert_printable(body)
        size = np.sort(np.ptp(body.vertices, axis=0))[::-1]
        assert (size[:2] <= [120, 100]).all()
        assert np.allclose(made.poses[body.name], made.poses[body.name.partition(":")[0]])


def test_pieces_make_up_the_part_but_for_the_gaps(made: Assembly) -> None:
    whole = build(_uncut(with_breaks(folded(), "plate")), "plate")
    for body in whole.bodies:
        mine = [piece for piece in made.bodies if piece.name in made.pieces[body.name]]
        lost = body.volume - sum(piece.volume for piece in mine)
        seams = [j for j in made.joints if j.seam and set(j.parts) <= {piece.name for piece in mine}]
        lengths = sum(float(np.ptp(j.axis, axis=0).max()) * 2 * j.radius for j in seams)
        assert 0 < lost <= 4 * 0.15 * lengths
        for i, one in enumerate(mine):
            assert all(solids.overlap(solid(one), solid(two)) == 0 for two in mine[:i])


def _uncut(solution: FoldSolution) -> FoldSolution:
    """The same for a printer that it fits as it is."""
    scaffold = solution.scaffold
    printing = replace(scaffold.recipe.print, printer=Printer("large", (500.0, 500.0, 500.0)), scale=None)
    return replace(solution, scaffold=replace(scaffold, recipe=replace(scaffold.recipe, print=printing)))


def test_seams_hold_their_pieces_a_fit_apart(made: Assembly) -> None:
    seams = [joint for joint in made.joints if joint.seam is not None]
    assert seams
    for joint in seams:
        assert joint.seam is not None
        assert joint.range_deg == (0.0, 0.0)
        a, b = (solid(body) for name in joint.parts for body in made.bodies if body.name == name)
        assert solids.gap(a, b, 1.0) == pytest.approx(joint.seam.fit, abs=0.01)
        pull = 4 * joint.seam.fit * np.array(joint.seam.pull)
        assert solids.overlap(a, b.translate(pull.tolist())) > 0.02


def test_each_piece_hinges_on_the_pieces_that_its_knuckles_meet(made: Assembly) -> None:
    names = {joint.name for joint in made.hinges}
    assert {"wall/1:1~wall/2:1", "wall/1:2~wall/2:2"} <= names
    for joint in made.hinges:
        a, b = (solid(body) for name in joint.parts for body in made.bodies if body.name == name)
        # Bored knuckles of both are around the axis, and nowhere else are these two so near.
        ends = joint.axis + np.array([[0, 0.1, 0], [0, -0.1, 0]])
        block = solids.box(ends.min(axis=0) - joint.radius, ends.max(axis=0) + joint.radius)
        assert min(solids.overlap(a, block), solids.overlap(b, block)) > 10


def test_hinges_leave_a_stretch_free_where_panels_are_cut(made: Assembly) -> None:
    (chain,) = with_breaks(folded(), "plate").chains
    assert len(chain.breaks) == 1
    low, high = chain.breaks[0]
    assert low < 0 < high
    for hinge in range(3):
        marks = knuckles(chain.hinge_spans[hinge], made.solution.thickness, chain.breaks)
        assert all(b <= low + 1e-9 or a >= high - 1e-9 for a, b in marks.carrier + marks.follower)


def test_nothing_is_cut_where_no_scale_was_asked_for() -> None:
    assert with_breaks(folded(None), "plate") is folded(None)
    with pytest.raises(FabricationError, match="print at scale") as raised:
        build(folded(None), "plate")
    assert "--posture plate" not in str(raised.value)


def test_other_postures_say_that_plate_would_cut() -> None:
    printing = PrintOptions(printer=SMALL, scale=1.0)
    solution = solve(abstract(Recipe("shelter", DOWN, PARTS, FoldOptions(slanting=False), printing), DOWN, 1.0))
    with pytest.raises(FabricationError, match="or with --posture plate, which cuts parts"):
        build(solution, "open")


def test_what_fits_stays_whole(assembled: Callable[..., Assembly]) -> None:
    whole = assembled("table", "plate", hinge="filament")
    assert whole.pieces == {}
    assert all(joint.seam is None for joint in whole.joints)
    assert extent(whole, folded=False)[0] > 0
