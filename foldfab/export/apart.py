"""Do the bodies of a hinge stay apart in the slicer's hands: are there as many outlines as there are bodies?

Where the slicer cuts the mesh for a layer, we cut each body by itself. Each piece of a body must have an outline of its
own in the G-code; an outline that runs through two bodies has fused them, and so has a layer of one body that is laid
straight onto a layer of the other.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from foldfab.export.solid import Solid
from foldfab.geometry.arrays import Array, Bools
from foldfab.slicing.gcode import Layer

if TYPE_CHECKING:
    from manifold3d import CrossSection

STEP_MM = 0.5
"""Outlines are looked at this often along their way."""
AROUND_MM = 0.5
"""How far around its knuckles a hinge is looked at: over the widest gap that is usual, and two layers."""
HAIR_MM = 2e-3
"""By how much a cut may be off: heights are rounded to 1 µm in G-code, and files to 32 bits."""
ROOM_MM = 0.9
"""A piece with room for two lines must have an outline; Arachne leaves out a cone's tip up to 0.65 mm wide."""
LEVEL_MM2 = 1.0
"""A section that changes by more than this within a hair is a cut along a level face."""
LAID_MM2 = 0.02
"""Two bodies of neighbouring layers may share this much by rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class Hinge:
    """A hinge as it will be printed."""

    name: str
    parts: tuple[str, str]
    axis: Array
    """(2, 3) mm."""
    radius: float
    """Of its knuckles, mm."""

    def box(self) -> tuple[Array, Array]:
        """(3,) least and (3,) greatest corner of its knuckles, and of the gaps around them."""
        along = self.axis[1] - self.axis[0]
        reach = self.radius * np.sqrt(np.maximum(0.0, 1 - (along / np.linalg.norm(along)) ** 2)) + AROUND_MM
        return self.axis.min(axis=0) - reach, self.axis.max(axis=0) + reach


@dataclass(frozen=True, slots=True)
class Clash:
    """Two bodies that the slicer makes one, or a body without an outline of its own."""

    kind: str
    """`fused`, `laid` (onto each other) or `lost`."""
    bodies: tuple[str, ...]
    z: float
    """mm."""


@dataclass(frozen=True, slots=True)
class Outlines:
    """What the layers that cut hinges look like."""

    layers: int
    """How many cut a hinge."""
    hinges: int
    """How many of the hinges are cut by a layer."""
    expected: int
    """Pieces of bodies at hinges, over all these layers."""
    found: int
    """Those of them with an outline of their own."""
    clashes: tuple[Clash, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Section:
    """What a cut shows of a body."""

    shape: CrossSection
    is_level: bool
    """Whether it runs along a level face, so that it is the slicer's choice what it shows."""


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """A connected piece of a body's section."""

    body: str
    edges: Array
    """(k, 2, 2) mm."""
    low: Array
    high: Array
    is_wide: bool
    """Whether it must have an outline."""


def outlines(bodies: Sequence[Solid], hinges: Sequence[Hinge], layers: Iterable[Layer]) -> Outlines:
    """Looks at every layer that cuts the knuckles of a hinge. O(layers · bodies)."""
    boxes = [hinge.box() for hinge in hinges]
    seen, cut, counts = 0, set[str](), np.zeros(2, dtype=np.int64)
    clashes: list[Clash] = []
    below: dict[str, _Section] = {}
    for layer in layers:
        z = layer.middle
        active = [(hinge, low, high) for hinge, (low, high) in zip(hinges, boxes, strict=True) if low[2] < z < high[2]]
        sections = _sections(bodies, z) if active else {}
        if active:
            seen += 1
            cut |= {hinge.name for hinge, _, _ in active}
            number, lost = _layer(layer, sections, [(low[:2], high[:2]) for _, low, high in active])
            counts += number
            clashes += lost + _laid(below, sections, [hinge.parts for hinge, _, _ in active], z)
        below = sections
    return Outlines(seen, len(cut), int(counts[0]), int(counts[1]), tuple(clashes))


def _sections(bodies: Sequence[Solid], z: float) -> dict[str, _Section]:
    """What is there both a hair above and below."""
    sections = {}
    for body in bodies:
        if body.low[2] < z < body.high[2]:
            under, over = body.manifold.slice(z - HAIR_MM), body.manifold.slice(z + HAIR_MM)
            # Bevels of 45° along the bed are no level faces.
            bevels = 2 * HAIR_MM * sum(_length(ring) for ring in under.to_polygons())
            sections[body.name] = _Section(under ^ over, abs(under.area() - over.area()) > LEVEL_MM2 + bevels)
    return sections


def _length(ring: Array) -> float:
    return float(np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1).sum())


def _layer(
    layer: Layer, sections: dict[str, _Section], windows: list[tuple[Array, Array]]
) -> tuple[tuple[int, int], list[Clash]]:
    """How many pieces at hinges there are and have an outline, and what went wrong."""
    pieces = [piece for name, section in sections.items() for piece in _pieces(name, section)]
    is_near = [any(bool((p.low < high).all() and (low < p.high).all()) for low, high in windows) for p in pieces]
    groups = [_crossed(pieces, path) for path in layer.outlines]
    clashes, fused = [], set[int]()
    for group in groups:
        names = sorted({pieces[index].body for index in group})
        if len(names) > 1 and any(is_near[index] for index in group):
            clashes.append(Clash("fused", tuple(names), layer.middle))
            fused |= group
    own = {index for group in groups for index in group} - fused
    wanted = {index for index, piece in enumerate(pieces) if is_near[index] and piece.is_wide}
    clashes += [Clash("lost", (pieces[index].body,), layer.middle) for index in sorted(wanted - own - fused)]
    return (len(wanted), len(wanted & own)), clashes


def _pieces(name: str, section: _Section) -> list[_Piece]:
    pieces = []
    for part in section.shape.decompose():
        if part.is_empty():
            continue
        rings = [np.asarray(ring, dtype=np.float64) for ring in part.to_polygons()]
        edges = np.concatenate([np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in rings])
        is_wide = not section.is_level and not part.offset(-ROOM_MM / 2).is_empty()
        pieces.append(_Piece(name, edges, edges.min(axis=(0, 1)), edges.max(axis=(0, 1)), is_wide))
    return pieces


def _crossed(pieces: list[_Piece], path: Array) -> set[int]:
    """The pieces that a path runs through."""
    low, high = path.min(axis=0), path.max(axis=0)
    near = [i for i, piece in enumerate(pieces) if (piece.low < high).all() and (low < piece.high).all()]
    points = _samples(path)
    return {index for index in near if _is_inside(points, pieces[index].edges).any()}


def _samples(path: Array) -> Array:
    """(n, 2) points along a path: its corners, and others between them."""
    parts = [path]
    for start, end in pairwise(path):
        count = int(np.linalg.norm(end - start) / STEP_MM)
        if count:
            parts.append(start + np.linspace(0, 1, count + 2)[1:-1, None] * (end - start))
    return np.concatenate(parts)


def _is_inside(points: Array, edges: Array) -> Bools:
    """(n,) whether a ray to the right of each point crosses an odd number of edges."""
    (ax, ay), (bx, by) = edges[:, 0].T, edges[:, 1].T
    x, y = points[:, :1], points[:, 1:]
    is_across = (ay <= y) != (by <= y)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = ax + (y - ay) / (by - ay) * (bx - ax)
    inside: Bools = (np.sum(is_across & (x < crossing), axis=1) % 2) == 1
    return inside


def _laid(
    below: dict[str, _Section], sections: dict[str, _Section], pairs: list[tuple[str, str]], z: float
) -> list[Clash]:
    """Pairs of which one is printed straight onto the other: no layer of air between them."""
    found = []
    for a, b in pairs:
        for under, over in ((a, b), (b, a)):
            if under in below and over in sections and (below[under].shape ^ sections[over].shape).area() > LAID_MM2:
                found.append(Clash("laid", (under, over), z))
    return found
