"""Figure 9: where hinges are inserted, for T-scaffolds and for in-place folding from an upright or a slanted start."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.folding.basic import Variant
from foldfab.folding.mechanism import joints, reach, tilts
from foldfab.folding.model import Chain, Side
from foldfab.recipe.model import Part

from .builder import NEARLY, folded_as, leaning, sheet, ways_to_fold

DEPTH = (0.0, 200.0)
LENGTH, RISE = 500.0, 400.0
SHIFT = 300.0
"""A patch of 500 mm whose top stands 300 mm further along the base and 400 mm over it."""
GROUND, CEILING = sheet("ground", (0, 900), DEPTH, 0), sheet("ceiling", (0, 900), DEPTH, RISE)
FLAP = (GROUND, sheet("leg", 450, DEPTH, (0, RISE)))
UPRIGHT = (GROUND, CEILING, sheet("leg", 450, DEPTH, (0, RISE)))
STARTS = {
    "to the right": (GROUND, CEILING, leaning("leg", (300, 0), (300 + SHIFT, RISE), DEPTH)),
    "to the left": (GROUND, CEILING, leaning("leg", (300 + SHIFT, 0), (300, RISE), DEPTH)),
}
SIDES: tuple[Side, Side] = ("l", "r")


@pytest.mark.parametrize("hinges", [1, 2, 3])
def test_figure_09a_a_t_is_split_at_equal_intervals_and_folds_in_a_zigzag(hinges: int) -> None:
    for side in SIDES:
        chain = folded_as(Variant("in-place", hinges, side), "leg", *FLAP)
        assert chain.lengths == pytest.approx(np.full(hinges + 1, RISE / (hinges + 1)), abs=NEARLY)
        assert np.ptp(chain.lengths) < 1e-9
        flat = np.degrees(tilts(chain, np.ones(1))[0])
        first = 90.0 if side == "r" else -90.0
        assert flat == pytest.approx(first * (-1.0) ** np.arange(hinges + 1))


@pytest.mark.parametrize("parts", [FLAP, UPRIGHT, *STARTS.values()], ids=["T", "H", *STARTS])
def test_figure_09_each_number_of_hinges_folds_to_both_sides(parts: tuple[Part, ...]) -> None:
    """And only an odd number of hinges folds an H-scaffold in place."""
    found = [v for v in ways_to_fold("leg", *parts) if v.mechanism == "in-place"]
    counts = {1, 2, 3} if len(parts) == 2 else {1, 3}
    assert sorted((v.hinges, v.side) for v in found) == sorted((n, side) for n in counts for side in SIDES)


@pytest.mark.parametrize("hinges", [1, 3])
def test_figure_09b_an_upright_h_is_split_at_equal_intervals(hinges: int) -> None:
    for side in SIDES:
        chain = folded_as(Variant("in-place", hinges, side), "leg", *UPRIGHT)
        assert chain.lengths == pytest.approx(np.full(hinges + 1, RISE / (hinges + 1)), abs=NEARLY)
        assert np.ptp(chain.lengths) < 1e-9


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("hinges", [1, 3])
def test_figure_09b_from_a_slanted_start_one_panel_is_longer_by_the_shift(start: str, hinges: int) -> None:
    """Panels of a = (L - Δ)/(N_h + 1) and one of a + Δ, at the top where the lowest panel folds against the lean."""
    against: Side = "l" if folded_as(Variant("slanted", 0, "r"), "leg", *STARTS[start]).lean > 0 else "r"
    short = (LENGTH - SHIFT) / (hinges + 1)
    for side in SIDES:
        chain = folded_as(Variant("in-place", hinges, side), "leg", *STARTS[start])
        expected = np.full(hinges + 1, short)
        expected[-1 if side == against else 0] += SHIFT
        assert chain.lengths == pytest.approx(expected, abs=NEARLY)


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("hinges", [1, 3])
def test_figure_09b_the_two_sides_have_hinge_places_of_their_own(start: str, hinges: int) -> None:
    left, right = (folded_as(Variant("in-place", hinges, side), "leg", *STARTS[start]) for side in SIDES)
    assert np.abs(np.cumsum(left.lengths) - np.cumsum(right.lengths))[:-1].max() > 100


@pytest.mark.parametrize("parts", [UPRIGHT, *STARTS.values()], ids=["upright", *STARTS])
@pytest.mark.parametrize("hinges", [1, 3])
@pytest.mark.parametrize("side", SIDES)
def test_figure_09b_the_top_comes_straight_down_and_ends_flat(parts: tuple[Part, ...], hinges: int, side: Side) -> None:
    """Rigid panels joined at their hinges all the time; thickness alone lets the top rise a little before it falls."""
    chain = folded_as(Variant("in-place", hinges, side), "leg", *parts)
    top = reach(chain, np.linspace(0, 1, 400))
    assert np.abs(top[:, 0] - top[0, 0]).max() < 1e-6
    assert top[:, 1].max() - top[0, 1] < 0.1 and (np.diff(top[20:, 1]) < 0).all()
    assert top[0, 1] == pytest.approx(RISE, abs=NEARLY) and top[-1, 1] < NEARLY
    assert_rigid(chain)


def assert_rigid(chain: Chain) -> None:
    """Hinge axes keep their distances, which are the panels' lengths but for the axes' offsets from the panels."""
    axes = joints(chain, tilts(chain, np.linspace(0, 1, 50)))
    spacing = np.linalg.norm(np.diff(axes, axis=1), axis=2)
    assert np.ptp(spacing, axis=0).max() < 1e-9
    assert spacing[0] == pytest.approx(np.hypot(chain.lengths, np.diff(chain.offsets)))
