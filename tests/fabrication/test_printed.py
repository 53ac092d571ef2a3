"""A shape as it is printed has facets on the safe side, and is made once."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.errors import FabricationError
from foldfab.fabrication import solids
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, box, common, cone, cut, facets, hull, placed, prism, rod, union, wrap
from foldfab.fabrication.solids import Solid

CUBE = box((0, 0, 0), (10, 10, 10))
TRIANGLE = [(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)]


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (CUBE, 1000.0),
        (union([CUBE, box((5, 0, 0), (15, 10, 10))]), 1500.0),
        (cut(CUBE, [box((5, -1, -1), (11, 11, 11)), box((-1, -1, 5), (11, 11, 11))]), 250.0),
        (hull([box((0, 0, 0), (1, 1, 1)), box((9, 0, 0), (10, 1, 1))]), 10.0),
        (placed(CUBE, np.array([100.0, 0.0, 0.0]), np.eye(3)[[1, 2, 0]]), 1000.0),
        (prism(TRIANGLE, 1.0, 3.0), 12.0),
        (prism(TRIANGLE[::-1], 1.0, 3.0), 12.0),
        (wrap(np.array([[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]])), 36.0),
        (facets(*solids.mesh(solids.box((0, 0, 0), (1, 2, 3)))), 6.0),
        (common(CUBE, box((5, 5, 5), (15, 15, 15))), 125.0),
    ],
    ids=["box", "union", "cut", "hull", "placed", "prism", "prism back", "wrap", "facets", "common"],
)
def test_volumes(shape: Shape, volume: float) -> None:
    assert printed(shape).volume() == pytest.approx(volume)


def test_a_prism_is_where_its_outline_is() -> None:
    low, high = solids.bounds(printed(prism(TRIANGLE, 1.0, 3.0)))
    assert np.allclose([low, high], [[0, 1, 0], [4, 3, 3]])


def test_facets_lie_inside_what_is_added_and_outside_what_is_taken_away() -> None:
    pin, hole = (printed(rod(2.0, 0.0, 10.0, 0.0, 0.0, is_hole=is_hole)).volume() for is_hole in (False, True))
    assert pin < np.pi * 40.0 < hole
    pin, hole = (printed(cone(2.0, 0.0, 2.0, 0.0, 0.0, is_hole=is_hole)).volume() for is_hole in (False, True))
    assert pin < np.pi * 8.0 / 3 < hole


def test_what_comes_again_is_made_once() -> None:
    known: dict[Shape, Solid] = {}
    drilled = cut(CUBE, [rod(1.0, -1.0, 11.0, 5.0, 5.0, is_hole=True)])
    row = union([placed(drilled, np.array([20.0 * i, 0.0, 0.0]), np.eye(3)) for i in range(5)])
    first = printed(row, known)
    assert len(known) == 1 + 5 + 3
    assert printed(row, known) is first


def test_what_the_kernel_cannot_make_is_an_error() -> None:
    with pytest.raises(FabricationError, match="try another scale or thickness"):
        printed(cut(CUBE, [placed(CUBE, np.array([float("inf"), 0.0, 0.0]), np.eye(3))]))
