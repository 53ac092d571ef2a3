"""A body's mesh as a file will hold it: on the grid that file formats can keep, still closed.

STL, 3MF readers and GLB hold 32-bit floats. Left to them, the rounding would pinch short edges without anyone
looking; so it is done here once, and the triangles that it flattens are taken out together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from foldfab.export.faults import DEGENERATE_MM
from foldfab.export.frames import to_sheet
from foldfab.fabrication.model import Assembly, Body
from foldfab.geometry.arrays import Array, Bools, Indices
from foldfab.geometry.closed import is_closed
from foldfab.geometry.flat_triangles import flipped, heights

FLAT_MM = 1e-4
"""Triangles lower than this have no area that a slicer would see."""
GRID_DIGITS = 5
"""Vertices stand on a grid of 0.01 µm, about what a 32-bit float resolves at 200 mm."""
SHORT_MM = (1e-3, 3e-3)
"""Edges shorter than this are given up where flat triangles cannot be had out otherwise."""


@dataclass(frozen=True, slots=True, eq=False)
class Shell:
    """One closed mesh, ready to be written."""

    name: str
    kind: Literal["base", "panel"]
    vertices: Array
    """(n, 3) mm, every value a 32-bit float."""
    faces: Indices
    """(m, 3) counter-clockwise seen from outside."""
    is_hinge: Bools
    """(m,) whether the face belongs to a hinge that was added."""


def sheet_shells(assembly: Assembly) -> tuple[Shell, ...]:
    """All bodies, open posture, sheet frame."""
    return tuple(snapped(body, to_sheet(assembly, body.vertices)) for body in assembly.bodies)


def snapped(body: Body, points: Array) -> Shell:
    """The body with its vertices at (n, 3) `points`, rounded to the grid; triangles without an area are taken out."""
    is_hinge = np.zeros(len(body.faces), dtype=bool)
    is_hinge[body.hinge_faces] = True
    found: list[tuple[tuple[int, int], Shell]] = []
    for short in (0.0, *SHORT_MM):
        vertices, faces, is_kept = _welded(_rounded(_drawn_together(points, body.faces, short)), body.faces)
        if is_closed(faces):
            # Flipping may make what is nearly flat quite flat.
            for whole in (flipped(vertices, faces, FLAT_MM), faces):
                lost, flat = (int(np.sum(heights(vertices[whole]) < low)) for low in (DEGENERATE_MM, FLAT_MM))
                found.append(((lost, flat), Shell(body.name, body.kind, vertices, whole, is_hinge[is_kept])))
            if (0, 0) in (worth for worth, _ in found):
                break
    if not found:
        # Welding made two sheets of the body touch along an edge: indices keep them apart.
        return Shell(body.name, body.kind, _rounded(points), body.faces, is_hinge)
    return min(found, key=lambda one: one[0])[1]


def _drawn_together(points: Array, faces: Indices, short: float) -> Array:
    """The points with the ends of each edge shorter than `short` in one place."""
    made = points.copy()
    edges = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    for a, b in np.sort(edges[np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1) < short], axis=1):
        made[b] = made[a]
    return made


def _rounded(points: Array) -> Array:
    return np.round(points, GRID_DIGITS).astype(np.float32).astype(np.float64) + 0.0


def bounds(shells: tuple[Shell, ...]) -> tuple[Array, Array]:
    """(3,) least and (3,) greatest coordinates of all shells, mm."""
    points = np.vstack([shell.vertices for shell in shells])
    return points.min(axis=0), points.max(axis=0)


def _welded(points: Array, faces: Indices) -> tuple[Array, Indices, Bools]:
    _, first, index = np.unique(points, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    renamed = rank[index.reshape(-1)][faces]
    a, b, c = renamed.T
    is_kept = (a != b) & (b != c) & (c != a)
    return points[first[order]], renamed[is_kept], is_kept
