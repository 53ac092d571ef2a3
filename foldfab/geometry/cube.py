"""A box as triangles: eight corners and twelve faces, for whatever draws or reads boxes as meshes."""

from __future__ import annotations

from itertools import product

import numpy as np

from foldfab.geometry.arrays import Array, Indices

CORNERS: Array = np.array(list(product((-1.0, 1.0), repeat=3)))
"""(8, 3) of the cube from -1 to 1."""
_QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
FACES: Indices = np.concatenate([_QUADS[:, [0, 1, 2]], _QUADS[:, [0, 2, 3]]])
"""(12, 3) corners, counter-clockwise seen from outside."""
