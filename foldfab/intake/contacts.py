"""Which parts touch by their true shapes, where that is not what their boxes say.

A box holds its part, so what touches has boxes that do; boxes that meet may hold parts that are bent and stay clear
of each other: their triangles are held against each other. And what was left out as hardware holds together what it
touches. Cost: a broad phase over bounds, then the near pairs of triangles, piece by piece, until two are close enough.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from foldfab.geometry.arrays import Array, Bools
from foldfab.geometry.boxes import Boxes, close_pairs, grown, near_pairs
from foldfab.geometry.groups import Groups
from foldfab.geometry.triangles import between, is_inside
from foldfab.intake.notes import note
from foldfab.recipe.contacts import BY_BOXES, Contacts, pair, reach
from foldfab.recipe.model import Mesh, Pair, Part

_AT_ONCE = 1 << 14
"""Pairs of triangles whose distance is found at once."""
_DENSE = 1 << 22
"""Pairs of bounds that are looked at at once."""
MOST_TRIANGLES = 60_000
"""Finer parts, where both may meet, are taken to touch as their boxes do; measuring them would take too long."""
MOST_PAIRS = 1 << 21
"""Near pairs of triangles that are tried before two parts are taken to touch as their boxes do."""


def contacts(parts: tuple[Part, ...], hardware: tuple[Mesh, ...]) -> Contacts:
    """What boxes tell wrong about parts that are no boxes, or that hardware (in true mm) holds together."""
    if len(parts) < 2:
        return BY_BOXES
    within = reach(np.array([part.size for part in parts]))
    boxes = _boxes(parts)
    close = [(i, j) for i, j in zip(*close_pairs(*2 * (grown(boxes, within / 2),)), strict=True) if i < j]
    apart = {_pair(parts, i, j) for i, j in close if not _touch(parts[i], parts[j], within)}
    held = _held(parts, boxes, hardware, within)
    return Contacts(frozenset(held - {_pair(parts, i, j) for i, j in close}), frozenset(apart - held))


def heaps(meshes: list[Mesh]) -> list[list[int]]:
    """Which meshes, by their numbers, hang together by touching; by the first of each."""
    if not meshes:
        return []
    low, high = (np.array([side(mesh.vertices, axis=0) for mesh in meshes]) for side in (np.min, np.max))
    within = reach(high - low)
    i, j = near_pairs((low - within / 2, high + within / 2), (low - within / 2, high + within / 2))
    near = [(a, b) for a, b in zip(i.tolist(), j.tolist(), strict=True) if a < b]
    surfaces = [mesh.vertices[mesh.faces] for mesh in meshes]
    heap = Groups(len(meshes))
    for a, b in near:
        if heap.of(a) != heap.of(b) and are_close(surfaces[a], surfaces[b], within):
            heap.join(a, b)
    return heap.all()


def told(found: Contacts) -> tuple[str, ...]:
    """Notes on what was found."""
    notes = list[str]()
    note(notes, "held together by hardware that was left out", (" and ".join(names) for names in found.touching))
    note(notes, "do not touch, although their boxes do", (" and ".join(names) for names in found.apart))
    return tuple(notes)


def are_close(a: Array, b: Array, within: float, axes: Array | None = None) -> bool:
    """Whether the surfaces of triangles (n, 3, 3) and (m, 3, 3) are that close, or one lies inside the other.

    Args:
        a: triangles.
        b: others.
        within: mm.
        axes: rows (3, 3) along which bounds are tight.
    """
    near = _clipped(a, b, within)
    near = _clipped(*(near if axes is None else (near[0] @ axes.T, near[1] @ axes.T)), within)
    return _surfaces_are_close(*near, within) or is_inside(a[0, 0], b) or is_inside(b[0, 0], a)


def surface(part: Part) -> Array:
    """(n, 3, 3) the triangles of a part, those of its box where it has no shape."""
    if part.shape is not None:
        found: Array = part.shape.vertices[part.shape.faces]
        return found
    corners = part.center + (_CORNERS * part.size) @ part.axes
    box: Array = corners[_FACES]
    return box


_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
_FACES = np.concatenate([_SIDES[:, [0, 1, 2]], _SIDES[:, [0, 2, 3]]])


def _pair(parts: tuple[Part, ...], i: int, j: int) -> Pair:
    return pair(parts[i].name, parts[j].name)


def _boxes(parts: tuple[Part, ...]) -> Boxes:
    center, axes, size = ([getattr(part, name) for part in parts] for name in ("center", "axes", "size"))
    return Boxes(np.array(center), np.array(axes), np.array(size) / 2)


def _touch(one: Part, other: Part, within: float) -> bool:
    """Of parts whose boxes are close."""
    if one.shape is None and other.shape is None:
        return True
    return are_close(surface(one), surface(other), within, one.axes)


def _held(parts: tuple[Part, ...], boxes: Boxes, hardware: tuple[Mesh, ...], within: float) -> set[Pair]:
    """The pairs that one piece of hardware touches both of."""
    if not hardware:
        return set()
    low = np.array([mesh.vertices.min(0) for mesh in hardware])
    high = np.array([mesh.vertices.max(0) for mesh in hardware])
    pieces = Boxes((low + high) / 2, np.tile(np.eye(3), (len(hardware), 1, 1)), (high - low) / 2)
    met: dict[int, list[int]] = {}
    for piece, i in zip(*close_pairs(grown(pieces, within / 2), grown(boxes, within / 2)), strict=True):
        mesh = hardware[piece]
        if parts[i].shape is None or are_close(mesh.vertices[mesh.faces], surface(parts[i]), within):
            met.setdefault(int(piece), []).append(int(i))
    return {_pair(parts, i, j) for some in met.values() for i, j in combinations(some, 2)}


def _clipped(a: Array, b: Array, within: float) -> tuple[Array, Array]:
    """The triangles of both that reach into what the other may."""
    if not len(a) or not len(b):
        return a[:0], b[:0]
    bounds_a, bounds_b = _bounds(a), _bounds(b)
    return a[_meeting(bounds_a, bounds_b, within)], b[_meeting(bounds_b, bounds_a, within)]


def _surfaces_are_close(a: Array, b: Array, within: float) -> bool:
    if not len(a) or not len(b):
        return False
    is_too_fine = max(len(a), len(b)) > MOST_TRIANGLES
    return _corners_are_close(a, b, within) or is_too_fine or _any_pair(a, b, within)


def _meeting(a: tuple[Array, Array], b: tuple[Array, Array], within: float) -> Bools:
    """Which triangles with bounds `a` reach into the bounds of all with bounds `b`, grown."""
    found = np.ones(len(a[0]), dtype=bool)
    # Column by column, as rows of three are what numpy is slowest at.
    for k in range(3):
        found &= (a[0][:, k] <= b[1][:, k].max() + within) & (a[1][:, k] >= b[0][:, k].min() - within)
    return found


def _bounds(a: Array) -> tuple[Array, Array]:
    """Lower and upper corners (n, 3) of triangles (n, 3, 3)."""
    one, other, last = a[:, 0], a[:, 1], a[:, 2]
    return np.minimum(np.minimum(one, other), last), np.maximum(np.maximum(one, other), last)


def _corners_are_close(a: Array, b: Array, within: float) -> bool:
    """Whether two of their first corners already are: most fine parts that touch are found so."""
    from scipy.spatial import cKDTree

    few, many = sorted((a[:, 0], b[:, 0]), key=len)
    distance, _ = cKDTree(few).query(many, distance_upper_bound=within)
    return bool((distance <= within).any())


def _any_pair(a: Array, b: Array, within: float) -> bool:
    looked_at, step = 0, max(1, _DENSE // len(b))
    low, high = _bounds(b)
    for start in range(0, len(a), step):
        some = a[start : start + step]
        i, j = near_pairs(_bounds(some), (low - within, high + within))
        looked_at += len(i)
        if looked_at > MOST_PAIRS:
            return True
        for first in range(0, len(i), _AT_ONCE):
            which = slice(first, first + _AT_ONCE)
            if (between(some[i[which]], b[j[which]]) <= within**2).any():
                return True
    return False
