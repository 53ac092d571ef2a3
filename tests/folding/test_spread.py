"""All sheets of the furniture stand and lie where each of them does when it is played by itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding.model import FoldSolution
from foldfab.folding.press import follow_down
from foldfab.folding.sheets import panels, sheet
from foldfab.folding.spread import spread
from foldfab.geometry.boxes import bounds

Solutions = Callable[..., FoldSolution]
NAMES = ["t_scaffold", "slanted_t", "slanted_h", "same_way", "two_lean", "box_with_table", "shelf", "passage", "chair"]
NEAR = 1e-6


@pytest.mark.parametrize("slanting", [True, False])
@pytest.mark.parametrize("name", NAMES)
def test_they_stand_lie_and_pass_as_they_do_alone(name: str, slanting: bool, solution: Solutions) -> None:
    made = solution(name, slanting=slanting)
    table = spread(made.scaffold, made.chains)
    assert table.owner[table.first :] == [c.patch for c in made.chains]
    for i, chain in enumerate(made.chains):
        own, clear = sheet(made.scaffold, chain), chain.far is not None and chain.mechanism == "in-place"
        heights = {b.name: b.bottom for b in made.scaffold.bases}
        fall = abs(heights[chain.far or chain.anchor] - heights[chain.anchor])
        times = np.linspace(0.0, 1.0, 60)
        played = bounds(panels(own, follow_down(own, times * fall) if clear else times))
        low, high = played[0].min(1), played[1].max(1)
        at = table.first + i
        assert np.allclose([low[0], high[0]], [table.low[at], table.high[at]], atol=NEAR)
        assert np.allclose([low[-1], high[-1]], bounds(table.flat[i]), atol=NEAR)
        assert (low > table.swept[0][i] - NEAR).all() and (high < table.swept[1][i] + NEAR).all()


@pytest.mark.parametrize("name", ["slanted_h", "h_scaffold", "same_way"])
def test_what_slants_is_seen_from_its_far_base_as_well(name: str, solution: Solutions) -> None:
    made = solution(name)
    table = spread(made.scaffold, made.chains)
    for i, chain in enumerate(made.chains):
        assert chain.mechanism == "slanted"
        own = sheet(made.scaffold, chain)
        moved = panels(own, np.linspace(0.0, 1.0, 60))
        tip = moved.center + moved.axes[..., 2, :] * moved.half[..., 2:]
        moved.center[:] -= tip - tip[0]
        low, high = bounds(moved)
        assert (low.min((0, 1)) > table.hung[0][i] - NEAR).all() and (high.max((0, 1)) < table.hung[1][i] + NEAR).all()


def test_what_is_laid_flat_lies_in_the_plane_of_its_base(solution: Solutions) -> None:
    made = solution("shelf")
    table = spread(made.scaffold, made.chains)
    before = table.boxes.center.copy()
    table.lay(np.array([1]))
    at, chain = table.first + 1, made.chains[1]
    assert table.low[at, 2] == table.high[at, 2] == pytest.approx(made.scaffold.base(chain.anchor).bottom)
    rest = np.delete(np.arange(len(before)), at)
    assert np.array_equal(table.boxes.center[rest], before[rest])
