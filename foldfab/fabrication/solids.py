"""The door to the solid kernel: the only module that imports manifold3d.

manifold3d returns an empty solid instead of raising, so every solid that leaves this module has its status checked.
Volumes in mm³, lengths in mm. Curved faces are polygons of `SIDES` sides: inscribed where material is added, and
circumscribed where it is taken away, so that facets never eat into a gap.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

import numpy as np
from manifold3d import CrossSection, Error, FillRule, JoinType, Manifold, Mesh64, OpType

from foldfab.errors import FabricationError
from foldfab.geometry.arrays import Array, Indices
from foldfab.geometry.flat_triangles import heights

Solid: TypeAlias = Manifold
"""A closed solid of the kernel."""

Outline: TypeAlias = CrossSection
"""A flat outline of the kernel."""

SIDES = 32
"""Sides of the polygon that stands for a circle."""

SLIVERS = (1e-3, 3e-3, 1e-2, 2e-2, 3e-2, 5e-2)
"""Detail that may be given up, mm; the finest that leaves a sound mesh is taken."""
FLAT = 2e-5
"""A triangle that is lower than this, mm, may have no area any more on the grid of a file, wherever it is turned."""
CRUMB = 1e-3
"""A shell of less than this is dust that a boolean left behind, mm³: a tenth of a millimetre each way."""
WELD_DIGITS = 5
"""Vertices closer than this many decimals of a millimetre are one in a file."""


def box(low: Iterable[float], high: Iterable[float]) -> Solid:
    """The axis-aligned box between two corners (3,)."""
    a, b = np.asarray(list(low), dtype=np.float64), np.asarray(list(high), dtype=np.float64)
    return Manifold.cube((b - a).tolist()).translate(a.tolist())


def rod(radius: float, start: float, end: float, x: float, z: float, *, is_hole: bool = False) -> Solid:
    """A cylinder along +y from `start` to `end` around (x, z); a hole is circumscribed."""
    size = radius / np.cos(np.pi / SIDES) if is_hole else radius
    angle = 2 * np.pi * (np.arange(SIDES) + 0.5) / SIDES
    circle = np.stack([size * np.cos(angle), size * np.sin(angle)], axis=1)
    # Extruded along +z, then turned so that +z becomes +y: (x, y, z) -> (x, z, -y).
    prism = Manifold.extrude(CrossSection([circle]), end - start)
    turn = np.array([[1.0, 0.0, 0.0, x], [0.0, 0.0, 1.0, start], [0.0, -1.0, 0.0, z]])
    return prism.transform(turn)


def cone(radius: float, base: float, tip: float, x: float, z: float, *, is_hole: bool = False) -> Solid:
    """A cone along y around (x, z) with its mouth at `base`, pointing to `tip`: of 45° where it is as high as wide."""
    size = radius / np.cos(np.pi / SIDES) if is_hole else radius
    shape = Manifold.cylinder(abs(tip - base), size, 0.0, SIDES)
    sign = 1.0 if tip > base else -1.0
    turn = np.array([[1.0, 0.0, 0.0, x], [0.0, 0.0, sign, base], [0.0, -sign, 0.0, z]])
    return shape.transform(turn)


def prism(outline: Iterable[tuple[float, float]], start: float, end: float) -> Solid:
    """A simple polygon of points (x, z), in either sense, drawn along +y from `start` to `end`."""
    points = np.array([*outline], dtype=np.float64)
    x, z = points.T
    is_clockwise = np.dot(x, np.roll(z, -1)) < np.dot(z, np.roll(x, -1))
    # Extruded along +z as for a rod, which turns (x, y) into (x, -z): a polygon that was clockwise is not any more.
    flat = np.stack([x, -z], axis=1)[:: 1 if is_clockwise else -1]
    turn = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, start], [0.0, -1.0, 0.0, 0.0]])
    return Manifold.extrude(CrossSection([flat]), end - start).transform(turn)


def hull_of(points: Array) -> Solid:
    """The convex hull of points (n, 3)."""
    return checked(Manifold.hull_points(np.asarray(points, dtype=np.float64).tolist()))


def grown(outline: Outline, margin: float) -> Outline:
    """The outline, `margin` mm wider on all sides."""
    return outline.offset(margin, JoinType.Miter, 2.0)


def nothing() -> Outline:
    """An empty outline."""
    return CrossSection()


def silhouette(body: Solid) -> Outline:
    """What a body covers seen along z."""
    return CrossSection(list(body.project().to_polygons()), FillRule.Positive)


def between(body: Solid, low: float, high: float) -> Solid:
    """What of a body lies between two heights."""
    least, most = (float(corner[2]) for corner in bounds(body))
    if least < low < most:
        body = body.trim_by_plane((0.0, 0.0, 1.0), low)
    if least < high < most:
        body = body.trim_by_plane((0.0, 0.0, -1.0), -high)
    return checked(body) if least < high and most > low else Manifold()


def shifted(body: Solid, height: float) -> Solid:
    """The body, higher."""
    return body.translate((0.0, 0.0, height))


def covered(triangles: Array) -> Outline:
    """What triangles (n, 3, 2), counter-clockwise, cover together."""
    return CrossSection(list(triangles), FillRule.NonZero)


def islands(outline: Outline) -> list[Outline]:
    """The pieces of an outline that hang together, none for an empty one."""
    return [piece for piece in outline.decompose() if not piece.is_empty()]


def rectangle(middle: Array, sides: Array) -> Outline:
    """A rectangle around `middle` (2,) with `sides` (2,), mm."""
    return CrossSection.square(tuple(sides.tolist()), center=True).translate(tuple(middle.tolist()))


def section(body: Solid, height: float) -> Outline:
    """What a body shows, x and y, where it is cut at a height z."""
    return body.slice(height)


def raised(outline: Outline, low: float, high: float) -> Solid:
    """What stands over an outline of x and y, between two heights."""
    return outline.extrude(high - low).translate((0.0, 0.0, low))


def union(parts: list[Solid]) -> Solid:
    """All parts as one."""
    return checked(Manifold.batch_boolean(parts, OpType.Add)) if len(parts) > 1 else parts[0]


def cut(body: Solid, holes: list[Solid]) -> Solid:
    """The body without the holes."""
    return checked(body - Manifold.batch_boolean(holes, OpType.Add)) if holes else body


def common(a: Solid, b: Solid) -> Solid:
    """What two bodies share."""
    return checked(a ^ b)


def placed(body: Solid, origin: Array, axes: Array) -> Solid:
    """The body with its x, y and z turned into the rows of `axes` (3, 3) and its origin at `origin` (3,)."""
    return body.transform(np.concatenate([np.asarray(axes).T, np.asarray(origin)[:, None]], axis=1))


def moved(body: Solid, pose: Array) -> Solid:
    """The body moved by a rigid motion (4, 4)."""
    return body.transform(np.asarray(pose)[:3, :4])


def hull(parts: list[Solid]) -> Solid:
    """The convex hull of all parts."""
    return checked(Manifold.batch_hull(parts))


def tidied(body: Solid) -> Solid:
    """The body without the slivers that booleans of nearly coplanar faces leave, which 32-bit files would pinch shut.

    Detail is given up only as far as it takes for the mesh to stay closed when it is written; where that does not do,
    facets that come from different pieces are merged as well.
    """
    for whole in (body, body.as_original()):
        for detail in SLIVERS:
            tidy = without_crumbs(checked(whole.simplify(detail)))
            if stays_closed(tidy):
                return tidy
    return tidy


def merged(body: Solid) -> Solid:
    """The body with facets of one plane merged, wherever they come from; nothing moves more than the least detail."""
    return checked(body.as_original().simplify(SLIVERS[0]))


def stays_closed(body: Solid) -> bool:
    """Whether each edge still belongs to two triangles when vertices are welded on the grid of a 32-bit file.

    A triangle that has no height on that grid any more does not count as one.
    """
    vertices, faces = mesh(body)
    grid: Array = np.round(vertices, WELD_DIGITS).astype(np.float32).astype(np.float64)
    welded = _numbered(grid)[faces]
    edges = np.concatenate([welded[:, [0, 1]], welded[:, [1, 2]], welded[:, [2, 0]]])
    _, counts = np.unique(edges.min(axis=1) * len(grid) + edges.max(axis=1), return_counts=True)
    return bool((counts == 2).all()) and float(heights(vertices[faces]).min(initial=np.inf)) > FLAT


def _numbered(points: Array) -> Indices:
    """(n,) numbers of points (n, 3), the same where points are."""
    number = np.zeros(len(points), dtype=np.int64)
    for column in points.T:
        _, rank = np.unique(column, return_inverse=True)
        _, number = np.unique(number * len(points) + rank.reshape(-1), return_inverse=True)
    return number.reshape(-1)


def without_crumbs(body: Solid) -> Solid:
    """The body without the specks that booleans of nearly coplanar faces leave beside it."""
    parts = body.decompose()
    kept = [part for part in parts if abs(part.volume()) > CRUMB]
    return kept[0] if len(kept) == 1 and len(parts) > 1 else body


def pieces(body: Solid) -> int:
    """How many separate shells it has: specks and voids count, as they do for whoever reads its file."""
    return len(body.decompose())


def parts(body: Solid) -> list[Solid]:
    """The separate bodies that it is, by where they begin: without specks, and hollows stay with theirs."""
    found = body.decompose()
    whole = [part for part in found if part.volume() > CRUMB]
    if any(part.volume() < -CRUMB for part in found):
        whole = [checked(part ^ body) for part in whole]
    return sorted(whole, key=lambda part: part.bounding_box())


def overlap(a: Solid, b: Solid) -> float:
    """Volume that two solids share, mm³."""
    return float((a ^ b).volume())


def within(body: Solid, low: Array, high: Array) -> Solid:
    """What of a body lies between two corners (3,)."""
    return checked(body ^ box(low, high))


def gap(a: Solid, b: Solid, within: float) -> float:
    """Least distance between two solids, at most `within`."""
    return float(a.min_gap(b, within))


def bounds(body: Solid) -> tuple[Array, Array]:
    """Lower and upper corner (3,)."""
    corners = np.array(body.bounding_box(), dtype=np.float64)
    return corners[:3], corners[3:]


def mesh(body: Solid) -> tuple[Array, Indices]:
    """Vertices (n, 3) and triangles (m, 3)."""
    raw = checked(body).to_mesh64()
    return np.array(raw.vert_properties[:, :3], dtype=np.float64), np.array(raw.tri_verts, dtype=np.int64)


def from_mesh(vertices: Array, faces: Indices) -> Solid:
    """The solid of a closed mesh."""
    return checked(Manifold(Mesh64(np.array(vertices, np.float64, order="C"), np.array(faces, np.uint64, order="C"))))


def checked(body: Solid) -> Solid:
    """The body itself.

    Raises:
        FabricationError: the kernel could not make it.
    """
    if body.status() != Error.NoError:
        raise FabricationError(f"the solid kernel failed with {body.status().name}; try another scale or thickness")
    return body
