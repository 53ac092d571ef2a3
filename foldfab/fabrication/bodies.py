"""Solids become the bodies of an assembly: their meshes, with what pictures and checks want to know of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.model import Body
from foldfab.fabrication.solids import Solid
from foldfab.folding.mechanism import frames, joints, tilts
from foldfab.folding.model import Chain, FoldSolution
from foldfab.geometry.arrays import Array, Indices

HINGE_SKIN = 0.05
"""Faces this close to a knuckle's radius are shown as hinge, mm."""


def bodies(solution: FoldSolution, made: Mapping[str, Solid]) -> tuple[Body, ...]:
    """The bodies of a solution, sorted by name."""
    return tuple(body(solution, name, name, made[name]) for name in sorted(made))


def body(solution: FoldSolution, name: str, part: str, solid: Solid) -> Body:
    """One body, under a name of its own: a part, or a piece of it."""
    vertices, faces = solids.mesh(solid)
    volume = float(solid.volume())
    chain = next((c for c in solution.chains if part in c.panels), None)
    if chain is None:
        return Body(name, "base", vertices, faces, np.array([0.0, 0.0, 1.0]), volume, np.zeros(0, np.int64))
    index = chain.panels.index(part)
    normal = frames(chain, np.zeros(1))[1][0, index, 0]
    return Body(name, "panel", vertices, faces, normal, volume, _hinge_faces(chain, index, vertices, faces))


def _hinge_faces(chain: Chain, index: int, vertices: Array, faces: Indices) -> Indices:
    """Faces of the knuckles of inserted hinges."""
    plane = np.stack([chain.across, chain.rise])
    axes = joints(chain, tilts(chain, np.zeros(1)))[0]
    center = (vertices[faces].mean(axis=1) - chain.root) @ plane.T
    inserted = [j for j in (index, index + 1) if 0 < j < len(chain.lengths)]
    near = np.zeros(len(faces), dtype=bool)
    for j in inserted:
        near |= np.linalg.norm(center - axes[j], axis=1) < chain.panel / 2 + HINGE_SKIN
    return np.nonzero(near)[0]
