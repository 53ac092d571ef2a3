"""Figure 22: "We can fold up your whole room!"."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from foldfab.folding.kinematics import size_at
from foldfab.folding.model import FoldSolution


@pytest.mark.parametrize("slanting", [True, False])
def test_figure_22_a_whole_room_folds(shipped: Callable[..., FoldSolution], slanting: bool) -> None:
    """Bed, table, bench and shelf, one unit after another, until little more is left than a heap of plates."""
    made = shipped("room", slanting=slanting)
    assert not any(m.is_deleted for m in made.modifications)
    assert len(made.steps) >= 5
    assert all(first.end == second.start for first, second in pairwise(made.steps))
    open_height, flat_height = (size_at(made, t, np.eye(3))[2] for t in (0.0, 1.0))
    assert flat_height < open_height / 3
