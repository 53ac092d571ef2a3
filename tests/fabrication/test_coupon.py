"""The coupon: every hinge at its own clearance, holding, with its number on the plate."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from foldfab.errors import FabricationError
from foldfab.fabrication import coupon as room
from foldfab.fabrication import solids
from foldfab.fabrication.coupon import coupon
from foldfab.fabrication.model import Body
from foldfab.fabrication.numbers import strokes, text_width
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import union
from foldfab.recipe.model import Posture


@pytest.mark.parametrize("posture", ["open", "folded"])
@pytest.mark.parametrize("thickness", [3.0, 4.0])
def test_bodies_are_apart_by_their_clearance(
    posture: Posture, thickness: float, assert_printable: Callable[[Body], None]
) -> None:
    made = coupon(thickness, posture)
    for body in made.bodies:
        assert_printable(body)
    parts = {body.name: solids.from_mesh(body.vertices, body.faces) for body in made.bodies}
    for gap in made.clearances:
        flap = parts[f"{gap:.2f}"]
        assert solids.gap(parts["plate"], flap, 1.0) == pytest.approx(gap, rel=0.08)
    flaps = [parts[f"{gap:.2f}"] for gap in made.clearances]
    assert all(solids.overlap(a, b) == 0.0 for a, b in itertools.combinations(flaps, 2))
    assert min(float(body.vertices[:, 2].min()) for body in made.bodies) == pytest.approx(0.0, abs=1e-9)


def test_clearances_at_which_a_thin_hinge_falls_apart_are_left_out() -> None:
    assert 0.5 in coupon(4.0, "open").clearances
    assert 0.5 not in coupon(3.0, "open").clearances


def test_a_coupon_without_any_hinge_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "CLEARANCES", (0.9,))
    with pytest.raises(FabricationError, match="hold at no clearance"):
        coupon(2.0, "open")


def test_digits_differ_and_are_as_wide_as_they_say() -> None:
    shapes = [printed(union(strokes(str(d), 0.0, 1.0, np.zeros(3), np.eye(3)))) for d in range(10)]
    for a, b in itertools.combinations(shapes, 2):
        assert abs(a.volume() - b.volume()) + (a - b).volume() + (b - a).volume() > 1.0
    low, high = solids.bounds(printed(union(strokes("0.25", 0.0, 1.0, np.zeros(3), np.eye(3)))))
    assert high[0] - low[0] == pytest.approx(text_width("0.25"))
