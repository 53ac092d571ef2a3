"""The furniture's own solids, at print scale where its plates stand, and whether they are sound.

A part whose box leans a little where its plate does not is turned about its middle, as its plate is. What is not closed
is told and never mended.
"""

from __future__ import annotations

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.shapes import Shape, facets
from foldfab.geometry.arrays import Array, Indices
from foldfab.geometry.closed import is_closed
from foldfab.geometry.rotation import cross
from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold

LEANS = np.cos(np.radians(30.0))
"""A part whose nearest side is further off its plate than 30° is left as it stands."""
LEVEL = 1e-6
"""A sine below which it is rounding."""
SAME = 1e-6
"""Corners closer than this share of the part's size are one: exports write each face's own."""
FINE = 0.02
"""Detail that no nozzle shows, mm."""


def is_own(scaffold: Scaffold, part: Part) -> bool:
    """Whether a part keeps its own shape."""
    return part.shape is not None and (part.look or scaffold.recipe.print.shape) == "own"


def placed_mesh(scaffold: Scaffold, part: Part, normal: Array) -> tuple[Array, Indices]:
    """Vertices (n, 3) and faces (m, 3) of a part, canonical frame at print scale; of its box where it has no shape.

    `normal` (3,) is that of its plate.
    """
    if is_own(scaffold, part) and part.shape is not None:
        points, faces = part.shape.vertices, part.shape.faces
    else:
        corners, faces = solids.mesh(solids.box(-part.size / 2, part.size / 2))
        points = part.center + corners @ part.axes
    middle = scaffold.rotation @ part.center
    turn = _levelling(part.axes @ scaffold.rotation.T, normal)
    return scaffold.scale * (middle + (points @ scaffold.rotation.T - middle) @ turn.T), faces


def own_solid(scaffold: Scaffold, part: Part, normal: Array) -> Shape | None:
    """The part as a closed solid; None where its mesh is not closed."""
    vertices, faces = placed_mesh(scaffold, part, normal)
    grid = np.round((vertices - vertices.min(0)) / (SAME * float(np.ptp(vertices, axis=0).max())))
    _, first, index = np.unique(grid, axis=0, return_index=True, return_inverse=True)
    places, welded = vertices[first], index.reshape(-1)[faces]
    welded = welded[(welded != np.roll(welded, 1, axis=1)).all(axis=1)]
    if not is_closed(welded):
        return None
    corners = places[welded]
    volume = float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])))
    # Closed but inside out: the file's sense of round, and not a fault of the surface.
    solid = solids.from_mesh(places, welded if volume > 0 else welded[:, ::-1])
    return facets(*solids.mesh(solid.simplify(FINE)))


def _levelling(axes: Array, normal: Array) -> Array:
    """(3, 3) the least turn that brings the nearest of three axes (rows) to a normal."""
    shares = axes @ normal
    k = int(np.argmax(np.abs(shares)))
    axis = axes[k] * np.sign(shares[k])
    spin = cross(axis, normal)
    sine, cosine = float(np.linalg.norm(spin)), float(axis @ normal)
    if sine < LEVEL or cosine < LEANS:
        return np.eye(3)
    x, y, z = spin
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: Array = np.eye(3) + skew + skew @ skew / (1 + cosine)
    return turn
