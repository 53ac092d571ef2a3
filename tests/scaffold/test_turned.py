"""What lies level in print though it stands in the furniture."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold
from foldfab.scaffold.turned import turned

Make = Callable[..., Scaffold]


def test_level_boards_and_what_folds_are_what_they_were(scaffold: Make) -> None:
    for name in ("h_scaffold", "shelf", "slanted_h"):
        assert turned(scaffold(name)) == {}


@pytest.mark.parametrize(("degrees", "counts"), [(5.0, False), (20.0, True)])
def test_a_tilted_seat_counts_from_where_it_shows(
    scaffold: Make, box: Callable[..., Part], degrees: float, counts: bool
) -> None:
    angle = np.radians(degrees)
    axes = np.array([[1.0, 0, 0], [0, np.cos(angle), np.sin(angle)], [0, -np.sin(angle), np.cos(angle)]])
    parts = (box("seat", (0, 0, 72), (200, 60, 4), axes), box("leg", (0, 0, 35), (4, 30, 70)))
    found = turned(scaffold(parts))
    share = np.sin(angle) * 200 * 60 / (200 * 60 + 30 * 70)
    assert found == (pytest.approx({"seat": share}) if counts else {})


def test_how_much_it_counts(scaffold: Make, box: Callable[..., Part]) -> None:
    """Two legs fold under a rail that is set on edge."""
    parts = (
        box("rail", (0, 0, 80), (200, 4, 20)),
        box("left", (-60, 0, 35), (4, 60, 70)),
        box("right", (60, 0, 35), (4, 60, 70)),
    )
    found = turned(scaffold(parts))
    assert found == pytest.approx({"rail": 200 * 20 / (200 * 20 + 2 * 60 * 70)})
