"""The snap-through is as the formula says, and what exceeds the play is refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.errors import FabricationError
from foldfab.fabrication.build import build
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.snaps import snap_findings, snaps
from foldfab.folding.model import FoldSolution


def test_the_rise_is_the_formulas(assembled: Callable[..., Assembly]) -> None:
    (snap,) = snaps(assembled("shelter").solution)
    height, thickness, gap = 80.0, 4.0, 0.3
    assert snap.estimate == pytest.approx((thickness + gap) ** 2 / (2 * (height - thickness - 2 * gap)))
    assert snap.rise == pytest.approx(snap.estimate, rel=0.05)
    assert snap.play <= snap.limit
    assert snap_findings(assembled("shelter").solution) == []


def test_furniture_without_accordions_has_none(assembled: Callable[..., Assembly]) -> None:
    assert snaps(assembled("table").solution) == ()


def test_more_than_the_play_is_refused(assembled: Callable[..., Assembly]) -> None:
    strained = with_play(assembled("shelter").solution, 0.5)
    (finding,) = snap_findings(strained)
    assert finding.is_fatal
    assert "wall has to give 0.50 mm" in finding.text
    assert "can give 0.41 mm" in finding.text
    with pytest.raises(FabricationError, match="snap"):
        build(strained, "open")


def with_play(solution: FoldSolution, play: float) -> FoldSolution:
    """The same solution, but its chains would have to give so much halfway."""
    steps = []
    for step in solution.steps:
        bump = play * np.sin(np.pi * step.samples)
        bump *= play / bump.max()
        steps.append(replace(step, play=dict.fromkeys(step.play, bump)))
    return replace(solution, steps=tuple(steps))
