"""Units and the axis that points up."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.errors import RecipeError
from foldfab.intake.model import Body, Shapes, Up, Wishes
from foldfab.intake.scale import check, in_millimetres

from .furniture import box


def shapes(size: float, up: Up = "z", millimetres: float | None = None) -> Shapes:
    return Shapes((Body("a", box((0, 0, size / 2), (size / 4, size / 8, size))),), up, millimetres)


def size(found: Shapes) -> list[float]:
    return [round(float(length), 6) for length in np.ptp(found.bodies[0].mesh.vertices, axis=0)]


@pytest.mark.parametrize(
    ("reach", "units", "true"), [(800, "mm", 800), (1.6, "m", 1600), (80, "cm", 800), (16, "in", 406.4)]
)
def test_a_unit_that_is_not_stated_is_guessed_and_told(reach: float, units: str, true: float) -> None:
    found = in_millimetres(shapes(reach), Wishes())
    assert size(found)[2] == pytest.approx(true)
    assert f"taken as {units}" in found.notes[0]


def test_a_stated_unit_is_kept_and_what_is_asked_for_comes_first() -> None:
    assert size(in_millimetres(shapes(80, millimetres=25.4), Wishes())) == [508, 254, 2032]
    asked = in_millimetres(shapes(80, millimetres=25.4), Wishes(units="cm"))
    assert (size(asked), asked.notes) == ([200, 100, 800], ())


def test_a_default_only_stands_in_for_what_is_not_stated() -> None:
    wishes = Wishes(default_units="in")
    assert size(in_millimetres(shapes(80), wishes))[2] == pytest.approx(2032)
    assert size(in_millimetres(shapes(80, millimetres=1), wishes))[2] == 80


def test_up_by_format_and_as_asked() -> None:
    assert size(in_millimetres(shapes(0.8, "y", 1000), Wishes())) == [200, 800, 100]
    assert size(in_millimetres(shapes(0.8, "y", 1000), Wishes(up="z"))) == [200, 100, 800]
    turned = in_millimetres(shapes(800, millimetres=1), Wishes(up="x"))
    assert size(turned) == [800, 100, 200]
    assert turned.bodies[0].mesh.vertices.max(0)[0] == 0


def test_gltf_as_large_as_a_street_was_written_in_millimetres() -> None:
    found = in_millimetres(shapes(800, "y", 1000), Wishes())
    assert size(found) == [200, 100, 800]
    assert "800 m long; taken as mm with Z up" in found.notes[0]
    assert size(in_millimetres(shapes(800, "y", 1000), Wishes(up="y"))) == [200, 800, 100]
    assert size(in_millimetres(shapes(20, "y", 1000), Wishes())) == [5000, 20000, 2500]


@pytest.mark.parametrize(
    "wishes", [Wishes(units="miles"), Wishes(up="w"), Wishes(smallest=-1), Wishes(smallest=np.nan)]
)
def test_wishes_that_cannot_be(wishes: Wishes) -> None:
    with pytest.raises(RecipeError, match="should be"):
        check(wishes)
