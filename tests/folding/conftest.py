"""An independent check that a folding solution folds: brute force over time, with its own bookkeeping."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding import anatomy
from foldfab.folding.kinematics import configuration
from foldfab.folding.model import Chain, FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, bounds, close_pairs, grown, moved, stacked

SKIN = 0.03
"""Boxes may share this much, mm: the solver's own tolerance, and a little for times between its samples."""
TIMES = 40


@pytest.fixture(scope="session")
def collisions() -> Callable[..., set[tuple[str, str]]]:
    """Which parts of a solution meet along its fold."""
    return find_collisions


@pytest.fixture(scope="session")
def assert_folds() -> Callable[[FoldSolution], None]:
    """Asserts that a solution is a valid folding transform that ends flat."""
    return check_folds


@pytest.fixture(scope="session")
def extent() -> Callable[[FoldSolution, float], tuple[Array, Array]]:
    """Lower and upper corners (3,) of everything at a time."""
    return find_extent


def check_folds(solution: FoldSolution) -> None:
    """A solution starts open, ends flat, takes its modifications from its chains and meets nothing on its way."""
    assert solution.lower_bound <= solution.cost + 1e-12
    assert solution.cost == pytest.approx(sum(m.cost for m in solution.modifications))
    assert {c.patch for c in solution.chains} == {m.patch for m in solution.modifications if not m.is_deleted}
    ends = configuration(solution, np.array([0.0, 1.0]))
    for chain in solution.chains:
        for panel in chain.panels:
            assert np.allclose(ends[panel][0], np.eye(4), atol=1e-9)
            assert abs((ends[panel][1, :3, :3] @ open_normal(chain))[2]) == pytest.approx(1.0)
    assert not find_collisions(solution)


def open_normal(chain: Chain) -> Array:
    """(3,) face normal of an open chain's panels."""
    normal: Array = np.cos(chain.lean) * chain.across - np.sin(chain.lean) * chain.rise
    return normal


def find_collisions(solution: FoldSolution, times: int = TIMES) -> set[tuple[str, str]]:
    """Pairs of names that meet at any of `times` instants: plates, and chains with their knuckles and feet.

    A chain may touch the plates of its own bases and its own feet.
    """
    found: set[tuple[str, str]] = set()
    for t in np.linspace(0.0, 1.0, times):
        things = _placed(solution, float(t))
        for (a, one), (b, other) in itertools.combinations(things, 2):
            if not _are_kin(solution, a, b) and len(close_pairs(grown(one, -SKIN), grown(other, -SKIN))[0]):
                found.add((a, b))
    return found


def find_extent(solution: FoldSolution, t: float) -> tuple[Array, Array]:
    """Lower and upper corners (3,) of all boxes at time t."""
    low, high = bounds(stacked([boxes for _, boxes in _placed(solution, t)]))
    return low.min(0), high.max(0)


def _are_kin(solution: FoldSolution, a: str, b: str) -> bool:
    """Whether two owners may touch: a chain and itself, a chain and the plates of its own bases."""
    kin = {c.patch: {f"base {c.anchor}", f"base {c.far}", c.patch} for c in solution.chains}
    return b in kin.get(a, set()) or a in kin.get(b, set())


def _placed(solution: FoldSolution, t: float) -> list[tuple[str, Boxes]]:
    """Owners, and where their boxes are; a plate's owner is `base` and its name."""
    thick, poses = solution.thickness, configuration(solution, np.array([t]))
    shift = {base.name: poses[base.name][0, :3, 3] for base in solution.scaffold.bases}
    found = [
        (f"base {base.name}", moved(anatomy.base_boxes(base, thick), shift[base.name]))
        for base in solution.scaffold.bases
    ]
    for chain in solution.chains:
        panels = anatomy.moving_boxes(chain, thick, np.array([progress(solution, chain, t)]))[0]
        near = stacked([panels, anatomy.anchor_feet(chain, thick)])
        found.append((chain.patch, moved(near, shift[chain.anchor])))
        if chain.far is not None:
            found.append((chain.patch, moved(anatomy.far_feet(chain, thick), shift[chain.far])))
    return found


def progress(solution: FoldSolution, chain: Chain, t: float) -> float:
    """Fold progress of a chain at time t, from the step that folds it."""
    step = next(step for step in solution.steps if chain.patch in step.fold)
    local = (t - step.start) / (step.end - step.start)
    return float(np.interp(local, step.samples, step.fold[chain.patch]))
