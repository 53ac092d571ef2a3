"""The motion of sheets without thickness, in closed form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from foldfab.folding.model import FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.validity import flat
from foldfab.validity.claim import moments
from foldfab.validity.verify import violations

Solutions = Callable[..., FoldSolution]


def strip(solution: FoldSolution, hinges: int, lean: float, side: float) -> flat.Strip:
    """A strip of any form, 80 mm high."""
    change = replace(solution.modifications[0], mechanism="in-place", hinges=hinges)
    lengths = flat._intervals(80 / np.cos(lean), lean, side, change, ends_free=False)
    return flat.Strip(solution.chains[0], solution.steps[0], np.zeros(3), lean, side, False, lengths, 80.0)


def far_end(lengths: Array, tilts: Array) -> Array:
    """(k, 2) where the far end stands over the root."""
    return np.stack([(lengths * np.sin(tilts)).sum(1), (lengths * np.cos(tilts)).sum(1)], axis=1)


@pytest.mark.parametrize("hinges", [1, 3, 5])
@pytest.mark.parametrize("lean", [0.0, 0.3, -0.3, 0.6])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_in_place_comes_straight_down_and_ends_flat(hinges: int, lean: float, side: float, solution: Solutions) -> None:
    made = strip(solution("h_scaffold"), hinges, lean, side)
    height = np.linspace(80.0, 0.0, 50)
    tilts = flat.in_place(made, height)
    assert np.allclose(far_end(made.lengths, tilts), np.stack([0 * height + 80 * np.tan(lean), height], 1), atol=1e-6)
    assert np.allclose(tilts[0], lean, atol=1e-12)
    assert np.allclose(np.abs(tilts[-1]), np.pi / 2)
    assert np.sign(tilts[-1, 0]) == side
    assert (np.diff(np.sign(tilts[-1])) != 0).all()


def test_higher_bases_start_first(solution: Solutions, board_at: Any, wall_at: Any) -> None:
    """Figure 11a: the upper wall starts alone, the table's leg when the press has come down to its top."""
    boards = (board_at("low", 0), board_at("middle", 64, 100, 80, 60), board_at("high", 128))
    made = solution(
        (*boards, wall_at("long", -80, 0, 128), wall_at("below", 60, 0, 64), wall_at("above", 60, 64, 128)),
        slanting=False,
    )
    (step,) = made.steps
    assert flat.ways(made, step) == pytest.approx({"low": 0.0, "middle": 64.0, "high": 128.0})
    folding = flat.folding(made)
    angles = np.abs(folding.angles(np.array([0.0, 0.25, 0.5, 0.75, 1.0])))
    by_panel = {hinge.second: angles[:, i] for i, hinge in enumerate(folding.linkage.hinges)}
    assert (by_panel["below/1"][:3] == 0.0).all() and 0.1 < by_panel["below/1"][3] < np.pi / 2
    assert 0.1 < by_panel["above/1"][1] < np.pi / 2 and np.allclose(by_panel["above/1"][2:], np.pi / 2)
    assert (np.diff(by_panel["long/1"]) > 0).all()
    assert violations(made) == ()


def test_moments_are_single_and_whole(solution: Solutions) -> None:
    times = moments(solution("tower"))
    assert times[0] == 0.0 and times[-1] == 1.0 and (np.diff(times) > 1e-12).all()
