"""Base plates hold together, whatever their outlines."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from foldfab.fabrication import plates, solids
from foldfab.fabrication.printed import printed
from foldfab.fabrication.solids import Solid
from foldfab.folding.model import Chain, Thickness
from foldfab.scaffold.model import BasePatch

THICKNESS = Thickness(4.0, 0.3)
Rectangles = tuple[tuple[float, float, float, float], ...]


@pytest.mark.parametrize(
    "rectangles",
    [
        ((0, 0, 30, 20),),
        ((0, 0, 20, 20), (30, 0, 20, 20)),
        ((0, 0, 20, 20), (40, 0, 20, 20)),
        ((0, 0, 20, 20), (40, 40, 20, 20)),
        ((0, 0, 20, 20), (40.3, 40.3, 20, 20)),
        ((0, 0, 20, 20), (40 + 1.9 * plates.GROWTH[-1], 0, 20, 20)),
        ((0, 0, 20, 20), (40, 0, 20, 1)),
    ],
    ids=["one", "overlap", "touch", "touch at a corner", "nearly touch", "apart", "a rod"],
)
def test_outlines_become_one_body(
    rectangles: Rectangles, make_base: Callable[..., BasePatch], assert_printable: Callable[[Solid], None]
) -> None:
    made, is_filled = plate(make_base(*rectangles), ())
    assert_printable(solids.tidied(made))
    assert not is_filled
    low, high = solids.bounds(made)
    assert high[2] - low[2] == pytest.approx(THICKNESS.panel)


def test_outlines_far_apart_are_filled(
    make_base: Callable[..., BasePatch], assert_printable: Callable[[Solid], None]
) -> None:
    made, is_filled = plate(make_base((0, 0, 20, 20), (60, 0, 20, 20)), ())
    assert is_filled
    assert_printable(solids.tidied(made))
    assert made.volume() == pytest.approx(100 * 40 * 4)


def test_a_hinge_beyond_the_edge_gets_plate_below_it(
    make_chain: Callable[..., Chain], make_base: Callable[..., BasePatch], assert_printable: Callable[[Solid], None]
) -> None:
    made, is_filled = plate(make_base((-20, 0, 20, 20)), (make_chain(THICKNESS),))
    assert not is_filled
    assert_printable(solids.tidied(made))


def test_a_plinth_raises_the_axis(make_chain: Callable[..., Chain], make_base: Callable[..., BasePatch]) -> None:
    heights = [
        solids.bounds(plate(make_base((0, 0, 30, 30)), (make_chain(THICKNESS, pad=pad),))[0])[1][2]
        for pad in (0.0, 4.3)
    ]
    assert heights[1] - heights[0] == pytest.approx(4.3)


def plate(base: BasePatch, chains: tuple[Chain, ...]) -> tuple[Solid, bool]:
    """A base as it is printed, and whether it had to be filled."""
    shape, is_filled = plates.plate(base, chains, THICKNESS)
    return printed(shape), is_filled
