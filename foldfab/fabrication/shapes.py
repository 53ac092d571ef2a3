"""What a printed body is made of: a tree of boxes, rods, cones, prisms and meshes, joined, cut, wrapped and placed.

A tree is a description: `printed.py` makes a solid of facets of it, `analytic.py` one with true cylinders and cones.
Trees are values: equal ones are equal shapes, so that whoever evaluates them does so once. Lengths in mm.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from foldfab.geometry.arrays import Array, Indices

Point: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Box:
    """An axis-aligned box."""

    low: Point
    high: Point


@dataclass(frozen=True, slots=True)
class Rod:
    """A cylinder along +y around (x, z)."""

    radius: float
    start: float
    end: float
    x: float
    z: float
    is_hole: bool = False
    """Whether facets have to lie outside of the cylinder instead of inside."""


@dataclass(frozen=True, slots=True)
class Cone:
    """A cone along y around (x, z), `radius` wide at `base` and pointed at `tip`."""

    radius: float
    base: float
    tip: float
    x: float
    z: float
    is_hole: bool = False
    """Whether facets have to lie outside of the cone instead of inside."""


@dataclass(frozen=True, slots=True)
class Prism:
    """A simple polygon of the xz plane, in either sense, drawn along +y."""

    outline: tuple[tuple[float, float], ...]
    start: float
    end: float


@dataclass(frozen=True, slots=True)
class Facets:
    """A closed mesh, as it came with the furniture: what is equal byte for byte is an equal shape."""

    vertices: bytes
    """(n, 3) 64-bit floats, mm."""
    faces: bytes
    """(m, 3) 64-bit integers, counter-clockwise seen from outside."""


@dataclass(frozen=True, slots=True)
class Wrap:
    """The convex hull of points."""

    points: tuple[Point, ...]


@dataclass(frozen=True, slots=True)
class Union:
    """All parts as one."""

    parts: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class Cut:
    """The body without the holes."""

    body: Shape
    holes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class Common:
    """What two bodies share."""

    first: Shape
    second: Shape


@dataclass(frozen=True, slots=True)
class Hull:
    """The convex hull of all parts."""

    parts: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class Placed:
    """A body turned and moved: its x, y and z become the rows of `axes`, its origin becomes `origin`."""

    body: Shape
    origin: Point
    axes: tuple[Point, Point, Point]


Shape: TypeAlias = Box | Rod | Cone | Prism | Facets | Wrap | Union | Cut | Common | Hull | Placed


def box(low: Iterable[float], high: Iterable[float]) -> Shape:
    """The axis-aligned box between two corners (3,)."""
    return Box(_point(low), _point(high))


def rod(radius: float, start: float, end: float, x: float, z: float, *, is_hole: bool = False) -> Shape:
    """A cylinder along +y from `start` to `end` around (x, z); a hole is circumscribed by its facets."""
    return Rod(float(radius), float(start), float(end), float(x), float(z), is_hole)


def cone(radius: float, base: float, tip: float, x: float, z: float, *, is_hole: bool = False) -> Shape:
    """A cone along y around (x, z) with its mouth at `base`, pointing to `tip`: of 45° where it is as high as wide."""
    return Cone(float(radius), float(base), float(tip), float(x), float(z), is_hole)


def prism(outline: Iterable[tuple[float, float]], start: float, end: float) -> Shape:
    """A simple polygon of points (x, z) drawn along +y from `start` to `end`."""
    return Prism(tuple((float(x), float(z)) for x, z in outline), float(start), float(end))


def facets(vertices: Array, faces: Indices) -> Shape:
    """A closed mesh: vertices (n, 3), mm, and faces (m, 3), counter-clockwise seen from outside."""
    return Facets(np.asarray(vertices, np.float64).tobytes(), np.asarray(faces, np.int64).tobytes())


def wrap(points: Array) -> Shape:
    """The convex hull of points (n, 3)."""
    return Wrap(tuple(_point(point) for point in points))


def union(parts: list[Shape]) -> Shape:
    """All parts as one."""
    return Union(tuple(parts)) if len(parts) > 1 else parts[0]


def cut(body: Shape, holes: list[Shape]) -> Shape:
    """The body without the holes."""
    return Cut(body, tuple(holes)) if holes else body


def common(first: Shape, second: Shape) -> Shape:
    """What two bodies share."""
    return Common(first, second)


def hull(parts: list[Shape]) -> Shape:
    """The convex hull of all parts."""
    return Hull(tuple(parts))


def placed(body: Shape, origin: Array, axes: Array) -> Shape:
    """The body with its x, y and z turned into the rows of `axes` (3, 3) and its origin at `origin` (3,)."""
    x, y, z = (_point(row) for row in np.asarray(axes))
    return Placed(body, _point(origin), (x, y, z))


def _point(values: Iterable[float]) -> Point:
    x, y, z = map(float, values)
    return x, y, z
