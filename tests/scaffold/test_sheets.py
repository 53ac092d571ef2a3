"""Sheets that lie on each other become one, in the order and with the outcome of comparing all pairs."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.geometry.rotation import cross
from foldfab.scaffold.sheets import Sheet, _are_one, _merged, joined

DISTANCE = 4.3


def crowd(seed: int, count: int) -> list[Sheet]:
    """Sheets in a few planes and near them, of all sizes, many on top of each other."""
    rng = np.random.default_rng(seed)
    found = []
    for index in range(count):
        turn = rng.choice([0.0, 0.5, np.pi / 2]) + rng.uniform(-0.06, 0.06)
        tilt = rng.choice([0.0, 0.6]) + rng.uniform(-0.06, 0.06)
        along = np.array([np.cos(turn), np.sin(turn), 0.0])
        up = np.cos(tilt) * np.array([0.0, 0.0, 1.0]) + np.sin(tilt) * cross(np.array([0.0, 0.0, 1.0]), along)
        center = rng.choice([0.0, 20.0], 3) + rng.uniform(-4, 4, 3)
        width, length = rng.uniform(2, 40, 2)
        found.append(Sheet((f"part-{index:03}",), center, along, up, float(width), float(length), 4.0, True))
    return sorted(found, key=lambda s: (-s.width * s.length, s.parts))


def merged_by_brute_force(rest: list[Sheet]) -> list[Sheet]:
    done: list[Sheet] = []
    for new in rest:
        twin = next((i for i, old in enumerate(done) if _are_one(old, new, DISTANCE)), None)
        if twin is None:
            done.append(new)
        else:
            done[twin] = joined(done[twin], new)
    return done


def facts(many: list[Sheet]) -> list[object]:
    return [(s.parts, *s.center, s.width, s.length) for s in many]


@given(st.integers(0, 2**32 - 1), st.integers(0, 60))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_merging_agrees_with_comparing_all_pairs(seed: int, count: int) -> None:
    rest = crowd(seed, count)
    assert facts(_merged(rest, DISTANCE)) == facts(merged_by_brute_force(rest))


def test_a_crowd_is_merged_at_all() -> None:
    assert len(_merged(crowd(1, 60), DISTANCE)) < 50
