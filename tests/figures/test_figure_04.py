"""Figure 4: the four folding mechanisms, and what they do with the top of the patch; hybrids are not considered."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding.mechanism import reach
from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

from .builder import NEARLY, changes, leaning, sheet, way, ways_to_fold

Fold = Callable[..., FoldSolution]
DEPTH = (0.0, 200.0)
GROUND, CEILING = sheet("ground", (0, 600), DEPTH, 0), sheet("ceiling", (0, 600), DEPTH, 300)
FLAP = sheet("leg", 300, DEPTH, (0, 250))
UPRIGHT, SLANTED = sheet("leg", 300, DEPTH, (0, 300)), leaning("leg", (250, 0), (350, 300), DEPTH)
T_SCAFFOLD, H_SCAFFOLD, SLANTED_H = (GROUND, FLAP), (GROUND, CEILING, UPRIGHT), (GROUND, CEILING, SLANTED)
SLANTED_T = (GROUND, leaning("leg", (250, 0), (330, 250), DEPTH))


def test_figure_04a_the_tip_of_a_slanted_t_swings_onto_the_base_about_its_hinge(fold: Fold) -> None:
    made = fold(*T_SCAFFOLD)
    (chain,) = made.chains
    tip = reach(chain, np.linspace(0, 1, 31))
    assert (chain.mechanism, len(chain.lengths), made.cost) == ("slanted", 1, 0.0)
    assert np.hypot(*tip.T) == pytest.approx(np.full(31, chain.lengths[0]))
    assert tip[0, 1] == pytest.approx(250, abs=NEARLY) and tip[-1, 1] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("parts", [H_SCAFFOLD, SLANTED_H], ids=["upright", "slanted start"])
def test_figure_04b_the_top_of_a_slanted_h_swings_along_an_arc(fold: Fold, parts: tuple[Part, ...]) -> None:
    made = fold(*parts)
    (chain,) = made.chains
    start = reach(chain, np.zeros(1))[0] @ np.stack([chain.across, chain.rise])
    arc = start + way(made, "ceiling")
    assert (chain.mechanism, len(chain.lengths), made.cost) == ("slanted", 1, 0.0)
    # Between its samples a step's travel is a chord of the arc.
    assert np.linalg.norm(arc, axis=1) == pytest.approx(np.full(len(arc), chain.lengths[0]), abs=0.1)
    assert np.abs(arc[-1, :2] - start[:2]).max() > 200
    assert arc[-1, 2] == pytest.approx(0, abs=1e-6)


def test_figure_04c_the_tip_of_an_in_place_t_comes_down_to_its_foot(fold: Fold) -> None:
    """The ground is so narrow that a flap that slants would leave the bounding box."""
    made = fold(sheet("ground", (150, 450), DEPTH, 0), FLAP, stay_in_box=True)
    (chain,) = made.chains
    tip = reach(chain, np.linspace(0, 1, 31))
    assert chain.mechanism == "in-place" and len(chain.lengths) == 2
    assert np.abs(tip[:, 0]).max() < NEARLY
    assert (np.diff(tip[:, 1]) < NEARLY / 31).all() and tip[-1, 1] < NEARLY


@pytest.mark.parametrize("parts", [H_SCAFFOLD, SLANTED_H], ids=["upright", "slanted start"])
def test_figure_04c_the_top_of_an_in_place_h_moves_only_along_d(fold: Fold, parts: tuple[Part, ...]) -> None:
    made = fold(*parts, slanting=False)
    fall = way(made, "ceiling")
    assert changes(made)["leg"].mechanism == "in-place" and changes(made)["leg"].hinges == 1
    assert np.abs(fall[:, :2]).max() == 0.0
    assert fall[-1, 2] == pytest.approx(-300, abs=NEARLY)


@pytest.mark.parametrize("max_hinges", [1, 2, 3, 5])
@pytest.mark.parametrize(
    "parts", [T_SCAFFOLD, SLANTED_T, H_SCAFFOLD, SLANTED_H], ids=["T", "slanted T", "H", "slanted H"]
)
def test_figure_04d_no_hybrid_of_slanting_and_hinges_is_considered(parts: tuple[Part, ...], max_hinges: int) -> None:
    found = ways_to_fold("leg", *parts, max_hinges=max_hinges)
    assert {v.mechanism for v in found} == {"slanted", "in-place"}
    assert {v.hinges for v in found if v.mechanism == "slanted"} == {0}
    assert min(v.hinges for v in found if v.mechanism == "in-place") == 1
