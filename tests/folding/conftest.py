"""Problems for the parts of the solver; and an independent check that a folding solution folds.

The check is brute force over time, with its own bookkeeping.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding import anatomy
from foldfab.folding.kinematics import configuration
from foldfab.folding.model import Chain, FoldSolution, Thickness
from foldfab.folding.ordering import after, floors, greedy
from foldfab.folding.problem import Problem
from foldfab.folding.scene import Scene, open_scene
from foldfab.folding.solve import posed
from foldfab.folding.unit_fold import UnitFold
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, bounds, grown, moved, overlaps, stacked
from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold

SKIN = 0.03
"""Boxes may share this much, mm: the solver's own tolerance, and a little for times between its samples."""
TIMES = 40


@pytest.fixture(scope="session")
def problem(scaffold: Callable[..., Scaffold]) -> Callable[..., Problem]:
    """Makes the problem that named furniture or parts pose, with options of the fold."""

    def make(what: object, **options: object) -> Problem:
        made = scaffold(what, **options)
        return posed(made, Thickness(made.recipe.print.thickness, made.recipe.print.clearance))

    return make


@pytest.fixture(scope="session")
def folded() -> Callable[..., tuple[Scene, list[tuple[Scene, UnitFold]]]]:
    """Folds all units greedily: the scene at the end, and each fold with the scene before it."""

    def fold(problem: Problem) -> tuple[Scene, list[tuple[Scene, UnitFold]]]:
        scene = open_scene(problem)
        found = greedy(problem, scene, floors(problem))
        assert not found.refusals
        steps = []
        for step in found.folds:
            steps.append((scene, step))
            scene = after(problem, scene, step)
        return scene, steps

    return fold


@pytest.fixture(scope="session")
def levels(board_at: Callable[..., Part], wall_at: Callable[..., Part]) -> tuple[Part, ...]:
    """Three boards in one unit: a wall stands in each storey, and one beside them from the lowest to the highest."""
    return (
        board_at("low", 0), board_at("middle", 64, 100, x=-40), board_at("high", 128),
        wall_at("lower", -40, 0, 64), wall_at("upper", -40, 64, 128), wall_at("side", 80, 0, 128),
    )  # fmt: skip


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
    """Pairs of owners that meet at any of `times` instants: plates, chains with their knuckles, and their feet."""
    things = _placed(solution, np.linspace(0.0, 1.0, times))
    return {
        (a, b)
        for (a, one), (b, other) in itertools.combinations(things, 2)
        if not _are_kin(solution, a, b) and _ever_meet(grown(one, -SKIN), grown(other, -SKIN))
    }


def find_extent(solution: FoldSolution, t: float) -> tuple[Array, Array]:
    """Lower and upper corners (3,) of all boxes at time t."""
    low, high = bounds(stacked([boxes[0] for _, boxes in _placed(solution, np.array([t]))]))
    return low.min(0), high.max(0)


def _ever_meet(a: Boxes, b: Boxes) -> bool:
    """Whether any boxes of (times, n) and (times, m) overlap at the same time."""
    (low_a, high_a), (low_b, high_b) = bounds(a), bounds(b)
    near = (low_a[:, :, None] <= high_b[:, None]).all(-1) & (low_b[:, None] <= high_a[:, :, None]).all(-1)
    time, i, j = np.nonzero(near)
    return bool(overlaps(a[time, i], b[time, j]).any())


def _are_kin(solution: FoldSolution, a: str, b: str) -> bool:
    """Whether two owners may touch: feet, and the chain and the plates that they hinge together."""
    held = {f"{c.patch} foot": {c.patch, f"{c.patch} foot", c.anchor, c.far} for c in solution.chains}
    return b.removeprefix("base ") in held.get(a, ()) or a.removeprefix("base ") in held.get(b, ())


def _placed(solution: FoldSolution, times: Array) -> list[tuple[str, Boxes]]:
    """Owners, and where their boxes (times, n) are: `base ground`, `leg` and `leg foot`."""
    thick, poses = solution.thickness, configuration(solution, times)
    shift = {base.name: poses[base.name][:, None, :3, 3] for base in solution.scaffold.bases}
    found = [
        (f"base {base.name}", _carried(anatomy.base_boxes(base, thick), shift[base.name]))
        for base in solution.scaffold.bases
    ]
    for chain in solution.chains:
        panels = anatomy.moving_boxes(chain, thick, progress(solution, chain, times))
        found.append((chain.patch, moved(panels, shift[chain.anchor])))
        found.append((f"{chain.patch} foot", _carried(anatomy.anchor_feet(chain, thick), shift[chain.anchor])))
        if chain.far is not None:
            found.append((f"{chain.patch} foot", _carried(anatomy.far_feet(chain, thick), shift[chain.far])))
    return found


def _carried(boxes: Boxes, shift: Array) -> Boxes:
    """Boxes (n,) that move by a shift (times, 1, 3), as (times, n)."""
    count = (len(shift), len(boxes))
    return Boxes(
        boxes.center + shift,
        np.broadcast_to(boxes.axes, (*count, 3, 3)),
        np.broadcast_to(boxes.half, (*count, 3)),
    )


def progress(solution: FoldSolution, chain: Chain, times: Array) -> Array:
    """Fold progress of a chain at some times, from the step that folds it."""
    step = next(step for step in solution.steps if chain.patch in step.fold)
    found: Array = np.interp((times - step.start) / (step.end - step.start), step.samples, step.fold[chain.patch])
    return found
