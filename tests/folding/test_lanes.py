"""Lanes that are made together are those that are made one by one, and so are the boxes that are swept together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields

import numpy as np
import pytest

from foldfab.folding.anatomy import Ride, anchor_feet, far_feet, moving_boxes, swept_boxes
from foldfab.folding.congruent import repertoire
from foldfab.folding.lanes import Lane, Swept, made
from foldfab.folding.problem import Problem
from foldfab.folding.units import Unit
from foldfab.geometry.boxes import stacked

from .every import whole

Make = Callable[..., Problem]
NAMES = ["shelf", "tower", "corner", "box_with_table", "deep_box", "h_scaffold", "chair"]


def same(a: object, b: object) -> bool:
    """Whether two values are the same to the last bit, arrays wherever they stand included."""
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    return bool(np.array_equal(a, b)) if isinstance(a, np.ndarray) else a == b


def alike(a: Swept, b: Swept) -> bool:
    (one, movers), (other, others) = a, b
    names = [f.name for f in fields(Lane) if f.name not in ("number", "chain")]
    boxes = (same(movers[k].center, others[k].center) and same(movers[k].half, others[k].half) for k in movers)
    return all(same(getattr(one, n), getattr(other, n)) for n in names) and set(movers) == set(others) and all(boxes)


@pytest.mark.parametrize("name", NAMES)
def test_lanes_made_together_are_those_made_one_by_one(problem: Make, name: str) -> None:
    posed = problem(name)
    for unit in posed.units:
        own = whole(posed, unit)
        wanted = [(posed.sites[x.patch], x.variant) for x in own.lanes]
        together = [x for x in made(posed, unit, own.nominal, wanted, 7) if x is not None]
        assert [x.number for x, _ in together] == list(range(7, 7 + len(wanted)))
        for one, found in zip(wanted, together, strict=True):
            (alone,) = made(posed, unit, own.nominal, [one], 0)
            assert alone is not None and alike(alone, found)


def test_what_has_no_lane_takes_no_number(problem: Make) -> None:
    posed = problem("h_scaffold")
    (unit,) = posed.units
    own = whole(posed, unit)
    fits, site = own.lanes[0].variant, posed.sites["leg"]
    short = type(fits)("in-place", 1, "r", (site.clear, 0.0))
    first, none, last = made(posed, unit, own.nominal, [(site, fits), (site, short), (site, fits)], 0)
    assert none is None and first is not None and last is not None
    assert (first[0].number, last[0].number) == (0, 1)
    assert made(posed, unit, own.nominal, [], 0) == []


@pytest.mark.parametrize("name", NAMES)
def test_what_rides_together_is_where_each_would_be_alone(problem: Make, name: str) -> None:
    posed = problem(name)
    progress, way = np.linspace(0, 1, 5), np.linspace([0, 0, 0], [3, 0, -40], 5)
    rides = [
        Ride(x.chain, progress, way / 2, way if x.chain.far is not None else None)
        for unit in posed.units
        for x in _every(posed, unit)
    ]
    boxes, whose = swept_boxes(rides, posed.thickness)
    for i, ride in enumerate(rides):
        own = boxes[:, whose == i]
        for k in range(len(progress)):
            panels = moving_boxes(ride.chain, posed.thickness, progress)[k]
            alone = stacked([panels, anchor_feet(ride.chain, posed.thickness), far_feet(ride.chain, posed.thickness)])
            shift = np.repeat(ride.near[k][None], len(alone), axis=0)
            if ride.far is not None:
                shift[-1] = ride.far[k]
            assert own.center[k] == pytest.approx(alone.center + shift, abs=1e-9)
            assert own.axes[k] == pytest.approx(alone.axes, abs=1e-12) and own.half[k] == pytest.approx(alone.half)


def _every(posed: Problem, unit: Unit) -> list[Lane]:
    whole(posed, unit)
    return repertoire(posed, unit).lanes
