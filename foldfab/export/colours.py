"""The paper's colours, the same in every file: foldable parts orange, added hinges blue, bases a warm grey."""

from __future__ import annotations

from foldfab.export.shell import Shell
from foldfab.geometry.arrays import Indices

NAMES = ("base", "panel", "hinge")
"""Of the materials, by index."""
COLOURS = ((198, 193, 185), (242, 142, 43), (38, 110, 190))
"""sRGB of the materials, by index."""
HINGE = 2
"""Index of the material of added hinges."""


def materials(shell: Shell) -> Indices:
    """(m,) index of the material of each face."""
    indices = shell.is_hinge * 0 + NAMES.index(shell.kind)
    indices[shell.is_hinge] = HINGE
    return indices
