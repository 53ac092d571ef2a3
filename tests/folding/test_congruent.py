"""Copies of a unit get what it can do, unless something that this depends on is not the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding.congruent import pose, repertoire
from foldfab.folding.model import Thickness
from foldfab.folding.problem import Problem
from foldfab.folding.solve import posed
from foldfab.folding.unit_fold import least_choice
from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold

HEIGHT = 73.0


@pytest.fixture
def stacked(pair: Callable[..., tuple[Part, ...]], scaffold: Callable[..., Scaffold]) -> Scaffold:
    """Two pairs on each other, which fold flat only with pockets in their bases."""
    lower = pair(HEIGHT)
    upper = tuple(replace(p, name=f"upper-{p.name}", center=p.center + np.array([0.0, 0.0, HEIGHT])) for p in lower[1:])
    return scaffold((*lower, *upper), slanting=False)


def made(scaffold: Scaffold) -> Problem:
    return posed(scaffold, Thickness(4.0, 0.3))


def test_copies_of_a_unit_are_found(stacked: Scaffold) -> None:
    problem = made(stacked)
    first, second = problem.units
    assert pose(problem, first).signature == pose(problem, second).signature
    least_choice(problem, repertoire(problem, first))
    assert len(repertoire(problem, second).lanes) == len(repertoire(problem, first).lanes)
    assert repertoire(problem, second).tables.keys() == repertoire(problem, first).tables.keys()


def test_a_unit_that_cannot_sink_as_deep_is_no_copy(stacked: Scaffold) -> None:
    """The plate on top looks the same but has parts at several heights: no pocket is cut into it."""
    top = max(stacked.bases, key=lambda base: base.top)
    uneven = replace(top, outlines=tuple(replace(o, extent=(top.bottom, top.top)) for o in top.outlines))
    problem = made(replace(stacked, bases=tuple(uneven if base is top else base for base in stacked.bases)))
    first, second = problem.units
    assert np.isfinite(least_choice(problem, repertoire(problem, first)).weight)
    alone = made(problem.scaffold)
    wanted = least_choice(alone, repertoire(alone, alone.units[1]))
    assert least_choice(problem, repertoire(problem, second)).weight == wanted.weight == np.inf
