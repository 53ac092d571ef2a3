"""The door to the kernel: what it cannot make is an error, and facets stay on the safe side."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.errors import FabricationError
from foldfab.fabrication import solids

CUBE = solids.box((0, 0, 0), (10, 10, 10))


def test_an_open_mesh_is_refused() -> None:
    vertices, faces = solids.mesh(CUBE)
    with pytest.raises(FabricationError, match="try another scale or thickness"):
        solids.from_mesh(vertices, faces[1:])


def test_a_bad_number_is_refused() -> None:
    with pytest.raises(FabricationError):
        solids.cut(CUBE, [solids.box((1, 1, 1), (2, 2, 2)).translate([float("inf"), 0.0, 0.0])])


def test_a_mesh_goes_out_and_in() -> None:
    again = solids.from_mesh(*solids.mesh(CUBE))
    assert again.volume() == pytest.approx(1000)
    assert solids.pieces(again) == 1


def test_pieces() -> None:
    assert solids.pieces(solids.union([CUBE, CUBE.translate([20.0, 0.0, 0.0])])) == 2


def test_a_speck_beside_a_body_counts_until_it_is_tidied() -> None:
    speck = solids.box((20, 0, 0), (28, 0.009, 0.0024))
    assert solids.pieces(solids.union([CUBE, speck])) == 2
    assert solids.pieces(solids.tidied(solids.union([CUBE, speck]))) == 1


def test_a_void_and_a_second_body_are_no_specks() -> None:
    hollow = solids.cut(CUBE, [solids.box((4, 4, 4), (6, 6, 6))])
    assert solids.pieces(solids.tidied(hollow)) == 2
    assert solids.pieces(solids.tidied(solids.union([CUBE, solids.box((20, 0, 0), (21, 1, 1))]))) == 2


def test_facets_never_eat_into_a_gap() -> None:
    pin, hole = solids.rod(2.0, 0.0, 10.0, 0.0, 0.0), solids.rod(2.0, 0.0, 10.0, 0.0, 0.0, is_hole=True)
    circle = np.pi * 4.0 * 10.0
    assert pin.volume() < circle < hole.volume()
    low, high = solids.bounds(hole)
    assert (low[1], high[1]) == (0.0, 10.0)
    assert np.hypot(*solids.mesh(pin)[0][:, [0, 2]].T).max() == pytest.approx(2.0)


@pytest.mark.parametrize("tip", [3.0, -3.0])
def test_a_cone_points_to_its_tip(tip: float) -> None:
    low, high = solids.bounds(solids.cone(3.0, 0.0, tip, 1.0, 5.0))
    assert sorted([low[1], high[1]]) == sorted([0.0, tip])
    assert (low[0] + high[0]) / 2 == pytest.approx(1.0)
    assert (low[2] + high[2]) / 2 == pytest.approx(5.0)


def test_placed_turns_into_the_rows_of_axes() -> None:
    body = solids.placed(solids.box((0, 0, 0), (1, 2, 3)), np.array([10.0, 0.0, 0.0]), np.eye(3)[[1, 2, 0]])
    low, high = solids.bounds(body)
    assert np.allclose(low, [10, 0, 0])
    assert np.allclose(high, [13, 1, 2])


def test_gap_and_overlap() -> None:
    assert solids.gap(CUBE, CUBE.translate([10.25, 0.0, 0.0]), 1.0) == pytest.approx(0.25)
    assert solids.overlap(CUBE, CUBE.translate([9.0, 0.0, 0.0])) == pytest.approx(100.0)


def test_parts_are_told_apart_and_keep_their_hollows() -> None:
    hollow = solids.cut(solids.box((0, 0, 0), (10, 10, 10)), [solids.box((2, 2, 2), (5, 5, 5))])
    found = solids.parts(solids.union([solids.box((20, 0, 0), (25, 5, 5)), hollow]))
    assert [part.volume() for part in found] == pytest.approx([973.0, 125.0])
