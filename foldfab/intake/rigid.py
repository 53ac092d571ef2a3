"""Rigid bodies of robot descriptions, and which of them are parts: a door is one, a carcass of boards is as many.

A link's shapes are one part where they fill half of their common box, as a leaf and its handle do; else each of them
is. Shapes of one name within a link belong together.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.intake.limits import check_bodies, check_triangles, fail
from foldfab.intake.meshes import body, joined, placed
from foldfab.intake.model import Body, Shapes
from foldfab.recipe.model import Mesh

FILLED = 0.5
"""The share of its box that a link's shapes must fill, by their own boxes, to be one part."""
_NUMBERED = re.compile(r"((link|body|base)[ _-]?\d*)?", re.IGNORECASE)
"""Names of links that say less than that of their only shape."""
METRE = 1000.0
"""mm: the unit of both formats."""


@dataclass(frozen=True, slots=True, eq=False)
class Geom:
    """One shape of a link, in the link's frame."""

    name: str
    """Empty where it has none."""
    mesh: Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A rigid body where it stands in the assembled pose."""

    name: str
    geoms: tuple[Geom, ...]
    matrix: Array
    """(4, 4) from the link's frame to the furniture's."""


def shapes_of(path: Path, links: list[Link]) -> Shapes:
    """The parts of the links.

    Raises:
        RecipeError: there are none, too many, or one is out of reach.
    """
    found: list[Body] = []
    apart: list[str] = []
    triangles = 0
    for link in links:
        pieces = _pieces(link)
        if len(pieces) > 1:
            apart.append(f"{link.name or 'world'} ({len(pieces)})")
        for name, mesh in pieces:
            triangles += len(mesh.faces)
            check_triangles(path, triangles)
            check_bodies(path, len(found) + 1)
            moved = placed(body(path, name, mesh.vertices, mesh.faces).mesh, link.matrix)
            found.append(body(path, name, moved.vertices, moved.faces))
    if not found:
        fail(path, "holds no shapes; a link needs a box, cylinder, capsule, sphere or mesh")
    told = (f"rigid bodies taken as several parts: {'; '.join(sorted(apart)[:12])}",) if apart else ()
    return Shapes(tuple(found), millimetres=METRE, notes=told)


def _pieces(link: Link) -> list[tuple[str, Mesh]]:
    """The link's parts by name: itself, or its shapes."""
    groups: dict[tuple[str, int], list[Mesh]] = {}
    for index, geom in enumerate(link.geoms):
        groups.setdefault((geom.name, 0 if geom.name else index), []).append(geom.mesh)
    whole = [(name, joined(meshes)) for (name, _), meshes in groups.items()]
    if len(whole) > 1 and _share([mesh for _, mesh in whole]) < FILLED:
        return [(name or link.name, mesh) for name, mesh in whole]
    own = whole[0][0] if len(whole) == 1 else ""
    name = own if own and _NUMBERED.fullmatch(link.name) else link.name or own
    return [(name, joined([mesh for _, mesh in whole]))] if whole else []


def _share(meshes: list[Mesh]) -> float:
    """How much of the box around all of them their own boxes take up."""
    low = np.array([mesh.vertices.min(0) for mesh in meshes])
    high = np.array([mesh.vertices.max(0) for mesh in meshes])
    common = float((high.max(0) - low.min(0)).prod())
    return float((high - low).prod(1).sum() / common) if common > 0 else 1.0
