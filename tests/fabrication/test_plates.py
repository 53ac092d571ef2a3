"""Base plates hold together, whatever their outlines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from foldfab.fabrication import plates, solids
from foldfab.fabrication.printed import printed
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.walls import thin_sides
from foldfab.folding import anatomy
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


@pytest.mark.parametrize("beside", [20.0, 5.0, 0.9, 0.2, -1.0])
def test_a_pocket_is_cut_whole_or_open_to_a_near_edge(
    beside: float, make_chain: Callable[..., Chain], make_base: Callable[..., BasePatch],
    assert_printable: Callable[[Solid], None],
) -> None:  # fmt: skip
    """No thin wall is left beside it, and feet stand on its floor."""
    chain = make_chain(THICKNESS, pad=-1.4)
    room = anatomy.pockets(chain, 0, THICKNESS)[0]
    width = float(room.half[1]) + beside
    base = make_base((0, 0, 60, width))
    made = solids.tidied(plate(base, (chain,))[0])
    assert_printable(made)
    assert thin_sides(made) == 0
    skin = solids.box((-60, -width, -2), (60, width, 2 - 1.4 - 0.01))
    assert solids.common(made, skin).volume() == pytest.approx(120 * 2 * width * 2.59, rel=1e-6)
    # Only feet, no wider than the panel is thick, stand in it.
    left = solids.common(made, solids.placed(solids.box(-room.half + 0.01, room.half - 0.01), room.center, room.axes))
    assert 0 < left.volume() < 4 * 30 * 1.4


def test_pockets_beside_each_other_leave_no_thin_wall(
    make_chain: Callable[..., Chain], make_base: Callable[..., BasePatch]
) -> None:
    chain = make_chain(THICKNESS, pad=-1.4)
    room = anatomy.pockets(chain, 0, THICKNESS)[0]
    for apart in (0.2, 1.0, 1.5):
        shift = 2 * float(room.half[1]) + apart
        other = replace(chain, patch="other", root=chain.root + shift * chain.along)
        made = solids.tidied(plate(make_base((0, shift / 2, 80, 80)), (chain, other))[0])
        assert thin_sides(made) == 0


def plate(base: BasePatch, chains: tuple[Chain, ...]) -> tuple[Solid, bool]:
    """A base as it is printed, and whether it had to be filled."""
    shape, is_filled = plates.plate(base, chains, THICKNESS)
    return printed(shape), is_filled
