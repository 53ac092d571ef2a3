"""Where everything is at any time: rigid, hinged, open at t = 0 and flat at t = 1."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.folding import anatomy
from foldfab.folding.kinematics import configuration, key_times, size_at
from foldfab.folding.mechanism import joints, tilts
from foldfab.folding.model import Chain, FoldSolution
from foldfab.folding.press import PLAY_SHARE
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import bounds

Make = Callable[..., FoldSolution]
CASES = [
    ("t_scaffold", True), ("slanted_h", True), ("slanted_h", False), ("two_ways", True), ("roof", False),
    ("deep_box", False), ("box_with_table", True), ("shelf", False), ("three_walls", True), ("chair", True),
]  # fmt: skip
cases = pytest.mark.parametrize(("name", "slanting"), CASES)
ROUNDING = 1e-6
BETWEEN_SAMPLES = 0.04
"""What a motion that is interpolated between its samples may be off, mm."""


def open_normal(chain: Chain) -> Array:
    """(3,) face normal of an open chain's panels."""
    normal: Array = np.cos(chain.lean) * chain.across - np.sin(chain.lean) * chain.rise
    return normal


@cases
def test_everything_that_is_kept_has_a_pose_by_its_name(solution: Make, name: str, slanting: bool) -> None:
    made = solution(name, slanting=slanting)
    panels = {panel for chain in made.chains for panel in chain.panels}
    assert set(configuration(made, np.zeros(1))) == panels | {base.name for base in made.scaffold.bases}


@cases
def test_at_the_start_nothing_has_moved(solution: Make, name: str, slanting: bool) -> None:
    for pose in configuration(solution(name, slanting=slanting), np.zeros(1)).values():
        assert pose[0] == pytest.approx(np.eye(4), abs=1e-9)


@cases
def test_at_the_end_every_panel_is_perpendicular_to_the_direction(solution: Make, name: str, slanting: bool) -> None:
    made = solution(name, slanting=slanting)
    poses = configuration(made, np.ones(1))
    for chain in made.chains:
        for panel in chain.panels:
            assert np.abs(poses[panel][0, :3, :3] @ open_normal(chain)) == pytest.approx([0, 0, 1], abs=1e-9)


@given(st.sampled_from(CASES), st.floats(0.0, 1.0))
@settings(deadline=None, derandomize=True, max_examples=30)
def test_all_motions_are_rigid_and_bases_only_translate(solution: Make, case: tuple[str, bool], t: float) -> None:
    made = solution(case[0], slanting=case[1])
    poses = configuration(made, np.array([t]))
    for pose in poses.values():
        assert pose[0, :3, :3] @ pose[0, :3, :3].T == pytest.approx(np.eye(3), abs=1e-9)
        assert np.linalg.det(pose[0, :3, :3]) == pytest.approx(1.0)
        assert pose[0, 3].tolist() == [0, 0, 0, 1]
    for base in made.scaffold.bases:
        assert (poses[base.name][0, :3, :3] == np.eye(3)).all()
    assert poses[made.scaffold.bases[0].name][0] == pytest.approx(np.eye(4))


def hinges(chain: Chain) -> Iterator[tuple[str, str, Array]]:
    """For each hinge the names of its neighbours, and two points (2, 3) on its axis in the open posture."""
    plane = np.array([chain.across, chain.rise])
    flat = joints(chain, tilts(chain, np.zeros(1)))[0]
    bodies = (chain.anchor, *chain.panels, *((chain.far,) if chain.far else ()))
    for i, (below, above) in enumerate(pairwise(bodies)):
        yield below, above, chain.root + flat[i] @ plane + chain.hinge_spans[i][:, None] * chain.along


def widest_gap(solution: FoldSolution, times: Array) -> float:
    """How far the axes of any hinge's two neighbours are ever apart, mm."""
    poses = configuration(solution, times)
    found = [0.0]
    for chain in solution.chains:
        for below, above, axis in hinges(chain):
            ends = [
                axis @ poses[body][:, :3, :3].transpose(0, 2, 1) + poses[body][:, None, :3, 3]
                for body in (below, above)
            ]
            found.append(float(np.linalg.norm(ends[0] - ends[1], axis=-1).max()))
    return max(found)


@cases
def test_hinges_hold_both_neighbours_together_within_their_play(solution: Make, name: str, slanting: bool) -> None:
    made = solution(name, slanting=slanting)
    assert widest_gap(made, np.linspace(0.0, 1.0, 997)) <= PLAY_SHARE * made.thickness.gap + BETWEEN_SAMPLES


@pytest.mark.parametrize("name", ["t_scaffold", "h_scaffold", "slanted_h", "tower", "table"])
def test_hinges_of_a_chain_that_is_alone_have_no_play_at_all(solution: Make, name: str) -> None:
    made = solution(name)
    assert widest_gap(made, key_times(made)) <= ROUNDING


@cases
def test_key_times_rise_from_open_to_flat_and_hold_every_step(solution: Make, name: str, slanting: bool) -> None:
    made = solution(name, slanting=slanting)
    times = key_times(made)
    assert times[0] == 0.0 and times[-1] == 1.0 and (np.diff(times) > 0).all()
    assert {step.start for step in made.steps} | {step.end for step in made.steps} <= set(times.tolist())


@cases
def test_steps_follow_one_another_and_move_only_their_own_unit(solution: Make, name: str, slanting: bool) -> None:
    made = solution(name, slanting=slanting)
    assert made.steps[0].start == 0.0 and made.steps[-1].end == 1.0
    assert all(a.end == b.start for a, b in pairwise(made.steps))
    for step in made.steps:
        ends = configuration(made, np.array([step.start, step.end]))
        for chain in made.chains:
            turned = any(np.abs(np.diff(ends[panel][:, :3, :3], axis=0)).max() > 1e-9 for panel in chain.panels)
            assert turned == (chain.patch in step.patches)


@pytest.mark.parametrize("name", ["t_scaffold", "h_scaffold", "shelf", "box_with_table", "deep_box", "chair"])
def test_folded_furniture_is_as_high_as_its_stack(solution: Make, name: str) -> None:
    made = solution(name, slanting=False)
    ends = configuration(made, np.ones(1))
    low, high = np.inf, -np.inf
    for base in made.scaffold.bases:
        corners = bounds(anatomy.base_boxes(base, made.thickness))
        shift = ends[base.name][0, 2, 3]
        low, high = min(low, corners[0][:, 2].min() + shift), max(high, corners[1][:, 2].max() + shift)
    if all(chain.far is not None for chain in made.chains):
        assert size_at(made, 1.0, np.eye(3))[2] == pytest.approx(high - low)
    assert size_at(made, 1.0, np.eye(3))[2] < 50
