"""Where parts are cut: few and equal pieces, clear of what must not be cut; a refusal where there is no place."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.errors import FabricationError
from foldfab.fabrication import solids
from foldfab.fabrication.cutting import LEAST_PIECE, Piece, Stock, count_of, cut_up, ideals, ways
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, box, cut, union
from foldfab.geometry.arrays import Array

BED = (100.0, 80.0)
FIT = 0.15


def stock(*taken: Array) -> Stock:
    return Stock("board", BED, FIT, np.eye(3), taken)


def piece(shape: Shape) -> Piece:
    return Piece(solids.tidied(printed(shape)), shape)


def block(low: tuple[float, float, float], high: tuple[float, float, float]) -> Array:
    """(8, 3) corners."""
    return solids.mesh(solids.box(low, high))[0]


def lengths(pieces: list[Piece], side: int) -> list[float]:
    return [float(np.ptp(solids.mesh(p.solid)[0][:, side])) for p in pieces]


def test_what_fits_is_left_whole() -> None:
    board = piece(box((0, 0, 0), (60, 95, 4)))
    assert cut_up(board, stock()) == ([board], [])


def test_pieces_are_as_few_and_as_long_as_each_other() -> None:
    made, keys = cut_up(piece(box((0, 0, 0), (180, 60, 4))), stock())
    assert sorted(lengths(made, 0)) == pytest.approx([90 - FIT, 90 + keys[0].corners[:, 0].max() - 92], abs=0.01)
    assert {key.kind for key in keys} == {"dovetail"}


def test_each_piece_fits_and_its_shape_is_its_solid() -> None:
    whole = piece(box((0, 0, 0), (230, 150, 4)))
    made, _ = cut_up(whole, stock())
    assert len(made) == 6
    for one in made:
        assert stock().fits(one)
        assert min(lengths([one], 0)[0], lengths([one], 1)[0]) >= LEAST_PIECE
        assert printed(one.shape).volume() == pytest.approx(one.solid.volume(), rel=1e-4)
    total = sum(one.solid.volume() for one in made)
    assert 0.985 * whole.solid.volume() < total < whole.solid.volume()
    for i, one in enumerate(made):
        assert all(solids.overlap(one.solid, other.solid) == 0 for other in made[:i])


def test_a_line_keeps_clear_of_what_is_taken() -> None:
    knuckle = block((80, 0, 0), (100, 60, 8))
    _, keys = cut_up(piece(box((0, 0, 0), (180, 60, 4))), stock(knuckle))
    for key in keys:
        assert key.corners[:, 0].max() <= 80 or key.corners[:, 0].min() >= 100


def test_a_line_keeps_clear_of_bores() -> None:
    bored = cut(box((0, 0, 0), (160, 60, 8)), [box((75, 25, 3), (161, 28, 5))])
    _, keys = cut_up(piece(bored), stock())
    for key in keys:
        # The tip of the tongue, too.
        assert key.inside[0] + FIT <= 75


def test_both_arms_of_a_fork_get_tongues_and_become_pieces() -> None:
    arms = [box((50, 0, 0), (180, 12, 4)), box((50, 48, 0), (180, 60, 4))]
    made, keys = cut_up(piece(union([box((0, 0, 0), (60, 60, 4)), *arms])), stock())
    assert len(made) == 3
    assert len(keys) == 2
    for one in made:
        assert printed(one.shape).volume() == pytest.approx(one.solid.volume(), rel=1e-4)


def test_a_narrow_part_is_spliced() -> None:
    _, keys = cut_up(piece(box((0, 0, 0), (150, 5, 4))), stock())
    assert [key.kind for key in keys] == ["splice"]


def test_a_refusal_names_the_part_its_size_and_what_to_try() -> None:
    taken = block((0, 0, 0), (180, 60, 8))
    with pytest.raises(FabricationError, match=r"board, 180 x 60 mm here, .*print at a smaller scale"):
        cut_up(piece(box((0, 0, 0), (180, 60, 4))), stock(taken))
    with pytest.raises(FabricationError, match="no place to cut it"):
        cut_up(piece(box((0, 0, 0), (150, 3, 4))), stock())


def test_ways_are_told_with_the_fewest_pieces_first() -> None:
    assert ways((60.0, 90.0), BED) == []
    assert ways((180.0, 60.0), BED)[0] == (0, (100.0, 80.0))
    assert [side for side, _ in ways((180.0, 150.0), BED)][:2] == [0, 1]


def test_counting_leaves_room_for_tongues() -> None:
    assert [count_of(length, 100.0) for length in (100, 101, 190, 191)] == [1, 2, 2, 3]
    assert ideals(0.0, 280.0, 100.0) == pytest.approx([280 / 3, 560 / 3])
