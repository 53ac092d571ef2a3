"""Linkages of sheets in the plane of x and z, all hinges along y, and foldings of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, stacked
from foldfab.validity.model import Body, Folding, Hinge, Linkage, no_slip

Y = (0.0, 1.0, 0.0)
WIDTH = 20.0


def make_sheet(
    name: str, start: Sequence[float], end: Sequence[float], thickness: float = 0.0, y: float = 0.0, base: bool = False
) -> Body:
    """A sheet 20 mm wide from (x, z) to (x, z)."""
    a, b = np.array([start[0], y, start[1]]), np.array([end[0], y, end[1]])
    up = (b - a) / np.linalg.norm(b - a)
    normal = np.cross(Y, up)
    half = np.array([thickness, WIDTH, float(np.linalg.norm(b - a))]) / 2
    return Body(name, Boxes((a + b)[None] / 2, np.stack([normal, Y, up])[None], half[None]), normal, base)


def make_hinge(first: str, second: str, x: float, z: float, room: float = 0.0) -> Hinge:
    """A hinge along y."""
    return Hinge(first, second, np.array([x, 0.0, z]), np.array(Y), room)


def make_folding(
    bodies: Sequence[Body], hinges: Sequence[Hinge], angles: Callable[[Array], Array], moments: int = 11
) -> Folding:
    """A folding with angles (k, h) at evenly spaced moments."""
    linkage = Linkage(tuple(bodies), tuple(hinges))
    return Folding(
        "by hand", linkage, np.linspace(0.0, 1.0, moments), angles, lambda times: no_slip(times, len(hinges))
    )


def make_table() -> Linkage:
    """Two bases on two upright legs: the smallest scaffold with a cycle."""
    bodies = (
        make_sheet("ground", (0, 0), (60, 0), base=True),
        make_sheet("top", (0, 40), (60, 40), base=True),
        make_sheet("left", (10, 0), (10, 40)),
        make_sheet("right", (50, 0), (50, 40)),
    )
    hinges = (
        make_hinge("ground", "left", 10, 0),
        make_hinge("top", "left", 10, 40),
        make_hinge("ground", "right", 50, 0),
        make_hinge("top", "right", 50, 40),
    )
    return Linkage(bodies, hinges)


def make_lump(*bodies: Body) -> Body:
    """Several sheets as one body."""
    return Body(bodies[0].name, stacked([b.pieces for b in bodies]), bodies[0].normal, bodies[0].is_base)


@pytest.fixture(scope="session")
def sheet() -> Callable[..., Body]:
    """Makes a sheet from its name, its two ends (x, z), its thickness and its y."""
    return make_sheet


@pytest.fixture(scope="session")
def hinge() -> Callable[..., Hinge]:
    """Makes a hinge along y from two names, x, z and the room of its knuckles."""
    return make_hinge


@pytest.fixture(scope="session")
def folding() -> Callable[..., Folding]:
    """Makes a folding from bodies, hinges and angles over time."""
    return make_folding


@pytest.fixture(scope="session")
def lump() -> Callable[..., Body]:
    """Makes one body of several sheets."""
    return make_lump


@pytest.fixture(scope="session")
def table() -> Linkage:
    """Two bases on two upright legs."""
    return make_table()
