"""Seams: pieces a fit apart everywhere, that nothing pulls open along the part."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from foldfab.fabrication import solids
from foldfab.fabrication.inspect import HELD
from foldfab.fabrication.joinery import PULL_FITS
from foldfab.fabrication.seams import LEAST_SPLICE, MOST_REACH, fit_of, parted, tongues
from foldfab.fabrication.solids import Solid

AT, LENGTH, THICK = 50.0, 100.0, 4.0


def pieces(width: float, fit: float) -> tuple[Solid, Solid, Solid]:
    """A plate of some width, and the two pieces of it."""
    plate = solids.box((0, 0, 0), (width, THICK, LENGTH))
    own = tongues(0.0, width, AT, fit)
    holes = parted(own, AT, fit, (np.zeros(2), np.array([width, LENGTH])))
    one, other = (solids.cut(plate, [solids.prism(hole, -1, THICK + 1)]) for hole in holes)
    return plate, one, other


@pytest.mark.parametrize(("width", "kind", "count"), [(5, "splice", 1), (8, "dovetail", 1), (100, "dovetail", 2)])
def test_what_holds_a_seam_depends_on_its_width(width: float, kind: str, count: int) -> None:
    found = tongues(0.0, width, AT, 0.15)
    assert [tongue.kind for tongue in found] == [kind] * count
    assert max(tongue.reach for tongue in found) <= MOST_REACH


def test_too_narrow_a_plate_has_no_seam() -> None:
    assert tongues(0.0, LEAST_SPLICE - 0.1, AT, 0.15) == ()


@given(st.floats(LEAST_SPLICE, 200.0), st.floats(0.1, 0.3))
def test_pieces_are_a_fit_apart_and_make_up_the_plate(width: float, fit: float) -> None:
    plate, one, other = pieces(width, fit)
    assert solids.pieces(one) == solids.pieces(other) == 1
    assert solids.overlap(one, other) == 0
    assert solids.gap(one, other, 1.0) == pytest.approx(fit, abs=1e-3)
    # All that is lost is the gap, which is at least a straight line's.
    lost = plate.volume() - one.volume() - other.volume()
    assert width * fit * THICK <= lost + 1e-6
    assert lost <= 4 * width * fit * THICK


@pytest.mark.parametrize("width", [8.0, 30.0, 100.0])
def test_the_gap_is_nowhere_wider(width: float) -> None:
    fit = 0.15
    plate, one, other = pieces(width, fit)
    path = width
    for tongue in tongues(0.0, width, AT, fit):
        (_, low, tip), (last, *_) = tongue.outline[:3], tongue.outline[3:]
        path += 2 * np.hypot(tip[0] - low[0], tip[1] - low[1]) + 2 * (tip[0] - low[0])
        assert last == (pytest.approx(2 * tongue.middle - tip[0]), tip[1])
    lost = plate.volume() - one.volume() - other.volume()
    assert lost / THICK == pytest.approx(path * fit, rel=0.03)


@given(st.floats(LEAST_SPLICE, 200.0), st.floats(0.1, 0.5))
@example(9.0, 0.5)
def test_pieces_cannot_be_pulled_apart(width: float, fit: float) -> None:
    _, one, other = pieces(width, fit)
    assert solids.overlap(one, other.translate((0, 0, PULL_FITS * fit))) > HELD


def test_the_fit_is_tighter_than_a_hinge_and_no_tighter_than_printers_can() -> None:
    assert fit_of(0.3) == pytest.approx(0.15)
    assert fit_of(0.15) == 0.1
