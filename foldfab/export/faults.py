"""Faults of a mesh, in the words that slicers use, from its triangles alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.geometry.arrays import Array, Indices
from foldfab.geometry.flat_triangles import heights as heights_of

DEGENERATE_MM = 5e-6
"""A triangle that is lower than this is degenerate: half a step of the grid that files are written on."""
SLIVER_MM = 1e-4
"""One that is lower than this has an area, but none that a slicer would see."""


@dataclass(frozen=True, slots=True)
class Faults:
    """How often each occurs; a mesh without any but slivers is closed, oriented and the right way out."""

    open_edges: int
    """Edges of one triangle only."""
    nonmanifold_edges: int
    """Edges of three triangles or more."""
    backwards_edges: int
    """Edges whose two triangles run along them the same way; all of them, where the mesh is inside out."""
    degenerate_facets: int
    slivers: int
    """Facets that are nearly degenerate."""

    @property
    def is_closed(self) -> bool:
        """Whether it is the boundary of a solid."""
        return self.open_edges == self.nonmanifold_edges == self.backwards_edges == 0


def faults(vertices: Array, faces: Indices) -> Faults:
    """Of (n, 3) vertices, mm, and (m, 3) faces that share them."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    # A triangle with two equal corners is degenerate and nothing else.
    edges = edges[edges[:, 0] != edges[:, 1]]
    ends, index, count = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    sense = np.bincount(index.reshape(-1), np.where(edges[:, 0] < edges[:, 1], 1, -1), minlength=len(ends))
    backwards = int(np.sum((count == 2) & (sense != 0)))
    heights = heights_of(vertices[faces])
    is_sound = bool((count == 2).all()) and backwards == 0
    return Faults(
        open_edges=int(np.sum(count == 1)),
        nonmanifold_edges=int(np.sum(count > 2)),
        backwards_edges=len(ends) if is_sound and volume(vertices, faces) <= 0 else backwards,
        degenerate_facets=int(np.sum(heights < DEGENERATE_MM)),
        slivers=int(np.sum((heights >= DEGENERATE_MM) & (heights < SLIVER_MM))),
    )


def volume(vertices: Array, faces: Indices) -> float:
    """mm³; negative where the mesh is inside out."""
    corners = vertices[faces] - vertices.mean(axis=0)
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6)
