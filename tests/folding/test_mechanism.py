"""How one chain moves: the formulas of section 5.3 and of the thick accordion, by the last digit."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.folding.basic import Variant, chain
from foldfab.folding.mechanism import descent, ends, frames, joints, open_height, peak, reach, start, tilts
from foldfab.folding.model import Chain, Mechanism, Side, Thickness
from foldfab.folding.site import sites
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold

Folding = Callable[..., Chain]
THICK = Thickness(4.0, 0.3)
EXACT = 1e-9
CLEAR, HIGH = 156.0, 160.0
LEANS = (-0.4, -0.15, 0.0, 0.15, 0.4)
SIDES: tuple[Side, Side] = ("l", "r")
PROGRESS, FINE = np.linspace(0.0, 1.0, 101), np.linspace(0.0, 1.0, 2001)
CASES = list(itertools.product(LEANS, (1, 3, 5), SIDES))


@pytest.fixture(scope="module")
def folding(
    scaffold: Callable[..., Scaffold], board_at: Callable[..., Part], leaning_at: Callable[..., Part]
) -> Folding:
    """Makes a chain 156 mm high between two boards, or on one, from its lean, hinges and side."""

    def make(lean: float, hinges: int, side: Side, *, has_top: bool = True) -> Chain:
        reach = HIGH * np.tan(lean) / 2
        boards = (board_at("ground", 0, 400), board_at("ceiling", HIGH, 400))
        made = scaffold((*boards[: 1 + has_top], leaning_at("leg", -reach, reach, 0, HIGH)))
        (site,) = sites(made, THICK)
        # A hinge direction is a line: which way along it is positive is not promised, nor is the sign of a lean.
        assert abs(site.lean) == pytest.approx(abs(lean), abs=EXACT)
        mechanism: Mechanism = "in-place" if hinges else "slanted"
        found = chain(site, Variant(mechanism, hinges, side), site.span, THICK)
        assert found is not None
        return found

    return make


def heights(made: Chain, progress: Array) -> Array:
    """Clear heights between the base faces."""
    found: Array = reach(made, progress)[:, 1] + 2 * THICK.axis_height
    return found


@pytest.mark.parametrize(("lean", "hinges", "side"), CASES)
def test_at_the_start_the_chain_is_the_open_patch(folding: Folding, lean: float, hinges: int, side: Side) -> None:
    made = folding(lean, hinges, side)
    angles = tilts(made, np.zeros(1))
    assert angles == pytest.approx(np.full((1, hinges + 1), made.lean), abs=EXACT)
    assert heights(made, np.zeros(1)) == pytest.approx([CLEAR], abs=EXACT)
    across, rise = reach(made, np.zeros(1))[0]
    assert across == pytest.approx(rise * np.tan(made.lean), abs=EXACT)


@pytest.mark.parametrize(("lean", "hinges", "side"), CASES)
def test_at_the_end_every_panel_lies_flat_on_its_stack(folding: Folding, lean: float, hinges: int, side: Side) -> None:
    made = folding(lean, hinges, side)
    end = tilts(made, np.ones(1))[0]
    assert np.abs(end) == pytest.approx(np.full(hinges + 1, np.pi / 2), abs=EXACT)
    assert end[0] == pytest.approx(np.pi / 2 if side == "r" else -np.pi / 2, abs=EXACT)
    assert (np.sign(end[1:]) == -np.sign(end[:-1])).all()
    stack = (hinges + 1) * (4.0 + 0.3) + 0.3
    assert heights(made, np.ones(1)) == pytest.approx([stack], abs=EXACT)


@pytest.mark.parametrize(("lean", "hinges", "side"), CASES)
def test_in_place_the_far_base_never_drifts_sideways(folding: Folding, lean: float, hinges: int, side: Side) -> None:
    across = reach(folding(lean, hinges, side), PROGRESS)[:, 0]
    assert across == pytest.approx(np.full(101, across[0]), abs=EXACT)


@pytest.mark.parametrize(("lean", "hinges", "side"), CASES)
def test_in_place_the_motion_is_continuous(folding: Folding, lean: float, hinges: int, side: Side) -> None:
    angles = tilts(folding(lean, hinges, side), FINE)
    assert np.abs(np.diff(angles, axis=0)).max() < 0.03


@pytest.mark.parametrize(("lean", "hinges", "side"), [c for c in CASES if c[0] == 0 or c[1] == 1])
def test_after_its_snap_the_far_base_only_falls(folding: Folding, lean: float, hinges: int, side: Side) -> None:
    """Of upright accordions and two-bar linkages; leaning ones of more panels snap again where they pass upright."""
    made = folding(lean, hinges, side)
    height = heights(made, FINE)
    assert height.max() - height[0] == pytest.approx(peak(made)[0], abs=1e-3)
    assert (np.diff(height[int(np.argmax(height)) :]) < 0).all()


@pytest.mark.parametrize(("hinges", "side"), list(itertools.product((1, 3, 5), SIDES)))
def test_an_upright_accordion_stands_as_high_as_its_angle_says(folding: Folding, hinges: int, side: Side) -> None:
    """y(θ) = (N+1) L cos θ + N (K+g) sin θ + (K+2g), with L = (H-K-2g)/(N+1)."""
    made = folding(0.0, hinges, side)
    angle = np.abs(tilts(made, PROGRESS)[:, 0])
    length = (CLEAR - 4.0 - 0.6) / (hinges + 1)
    expected = (hinges + 1) * length * np.cos(angle) + hinges * 4.3 * np.sin(angle) + 4.6
    assert heights(made, PROGRESS) == pytest.approx(expected, abs=EXACT)
    assert angle == pytest.approx(PROGRESS * np.pi / 2, abs=EXACT)


@pytest.mark.parametrize("hinges", [1, 3, 5])
def test_the_snap_of_an_upright_accordion_is_the_top_of_that_curve(folding: Folding, hinges: int) -> None:
    straight, off = CLEAR - 4.6, hinges * 4.3
    rise, at = peak(folding(0.0, hinges, "r"))
    assert rise == pytest.approx(np.hypot(straight, off) - straight, abs=1e-4)
    assert at == pytest.approx(np.arctan2(off, straight) / (np.pi / 2), abs=1 / 256)


@pytest.mark.parametrize("hinges", [0, 1, 3])
def test_both_sides_are_mirror_images_of_an_upright_patch(folding: Folding, hinges: int) -> None:
    left, right = (tilts(folding(0.0, hinges, side), PROGRESS) for side in SIDES)
    assert left == pytest.approx(-right, abs=EXACT)


@pytest.mark.parametrize(("lean", "hinges", "side"), list(itertools.product(LEANS, (0, 1, 2, 3), SIDES)))
def test_a_t_scaffold_folds_flat_in_a_zigzag(folding: Folding, lean: float, hinges: int, side: Side) -> None:
    made = folding(lean, hinges, side, has_top=False)
    assert tilts(made, np.zeros(1)) == pytest.approx(np.full((1, hinges + 1), made.lean), abs=EXACT)
    first = np.pi / 2 if side == "r" else -np.pi / 2
    zigzag = first * (-1.0) ** np.arange(hinges + 1)
    assert tilts(made, np.ones(1))[0] == pytest.approx(zigzag, abs=EXACT)


@pytest.mark.parametrize(("lean", "side"), list(itertools.product(LEANS, SIDES)))
def test_a_slanted_patch_swings_as_one_panel(folding: Folding, lean: float, side: Side) -> None:
    """Figure 4 a and b: the far end runs through a circular arc around the root."""
    made = folding(lean, 0, side)
    way = reach(made, PROGRESS)
    assert np.hypot(*way.T) == pytest.approx(np.full(101, made.lengths[0]), abs=EXACT)
    assert heights(made, np.ones(1)) == pytest.approx([4.0 + 2 * 0.3], abs=EXACT)


@given(st.sampled_from(CASES), st.floats(0.0, 1.0))
@settings(deadline=None, derandomize=True, max_examples=40)
def test_panels_are_rigid_and_hang_together_at_any_time(
    folding: Folding, case: tuple[float, int, Side], progress: float
) -> None:
    made = folding(*case)
    origins, axes = frames(made, np.array([progress]))
    assert np.einsum("kmij,kmlj->kmil", axes, axes) == pytest.approx(np.broadcast_to(np.eye(3), axes.shape), abs=EXACT)
    assert np.linalg.det(axes) == pytest.approx(np.ones(axes.shape[:2]))
    place = joints(made, tilts(made, np.array([progress])))[0] @ np.array([made.across, made.rise]) + made.root
    off, length = made.offsets, made.lengths
    for i in range(len(length)):
        normal, _, up = axes[0, i]
        assert origins[0, i] + off[i] * normal == pytest.approx(place[i], abs=EXACT)
        assert origins[0, i] + off[i + 1] * normal + length[i] * up == pytest.approx(place[i + 1], abs=EXACT)


@pytest.mark.parametrize(("lean", "hinges", "side"), CASES)
def test_what_is_looked_up_for_a_mirror_image_is_the_chains_own(
    folding: Folding, lean: float, hinges: int, side: Side
) -> None:
    made = folding(lean, hinges, side)
    progress, height, top = descent(made)
    own = reach(made, progress)
    assert (height == own[:, 1] - own[0, 1]).all() and top == int(np.argmax(height))
    first, last = reach(made, np.array([0.0, 1.0]))
    assert start(made) == pytest.approx(first @ made.plane, abs=EXACT)
    assert ends(made) == pytest.approx((last - first) @ made.plane, abs=EXACT)
    assert open_height(made) == first[1]
    assert made.to_the_right.turn > 0 and (made.to_the_right == made.shape) == (side == "r")
