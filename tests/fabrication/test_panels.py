"""Panels are named, counted and printable."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.panels import panels
from foldfab.fabrication.plates import plate
from foldfab.fabrication.printed import printed
from foldfab.fabrication.solids import Solid
from foldfab.folding.model import Chain, Thickness
from foldfab.scaffold.model import BasePatch

THICKNESS = Thickness(4.0, 0.3)


@pytest.mark.parametrize(
    ("lengths", "names"),
    [
        ((30.0,), ("leg",)),
        ((25.0, 25.0), ("leg/1", "leg/2")),
        ((20.0, 20.0, 20.0, 20.0), ("leg/1", "leg/2", "leg/3", "leg/4")),
    ],
)
def test_a_panel_for_each_length(
    lengths: tuple[float, ...],
    names: tuple[str, ...],
    make_chain: Callable[..., Chain],
    assert_printable: Callable[[Solid], None],
) -> None:
    chain = make_chain(THICKNESS, lengths=lengths)
    made = [printed(panel) for panel in panels(chain, THICKNESS)]
    assert chain.panels == names
    assert len(made) == len(names)
    for solid in made:
        assert_printable(solids.tidied(solid))


def test_panels_stand_in_a_row_with_the_clearance_between(make_chain: Callable[..., Chain]) -> None:
    made = [printed(panel) for panel in panels(make_chain(THICKNESS, lengths=(20.0, 20.0, 20.0)), THICKNESS)]
    for lower, upper in itertools.pairwise(made):
        assert solids.overlap(lower, upper) == 0
        assert solids.gap(lower, upper, 1.0) == pytest.approx(THICKNESS.gap, abs=0.02)
    low, high = solids.bounds(solids.union(made))
    assert high[2] == pytest.approx(THICKNESS.panel / 2 + THICKNESS.axis_height + 60.0)
    assert np.allclose(np.array([low[1], high[1]]), [-15.0, 15.0])


def test_a_thicker_chain_on_a_thinner_base(
    make_chain: Callable[..., Chain], make_base: Callable[..., BasePatch], assert_printable: Callable[[Solid], None]
) -> None:
    """The stack of figure 19: K of the chain is its own, the gap is the print's."""
    thick = THICKNESS.of(5.5)
    chain = make_chain(thick, lengths=(26.0, 26.0))
    root = THICKNESS.panel / 2 + thick.axis_height
    moved = replace(chain, root=np.array([0.0, 0.0, root]))
    shape, _ = plate(make_base((0, 0, 40, 40)), (moved,), THICKNESS)
    ground, lower, upper = map(printed, (shape, *panels(moved, THICKNESS)))
    for solid in (ground, lower, upper):
        assert_printable(solids.tidied(solid))
    low, high = solids.bounds(upper)
    assert high[0] - low[0] >= thick.panel
    assert solids.gap(ground, lower, 1.0) == pytest.approx(THICKNESS.gap, abs=0.02)
