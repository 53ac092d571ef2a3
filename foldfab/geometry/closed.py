"""Whether a surface of triangles encloses something."""

from __future__ import annotations

import numpy as np

from foldfab.geometry.arrays import Indices


def is_closed(faces: Indices) -> bool:
    """Whether each directed edge of (m, 3) faces occurs once, and once the other way round."""
    if len(faces) == 0:
        return False
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    base = int(faces.max()) + 1
    forward, backward = edges @ [base, 1], edges @ [1, base]
    unique = np.unique(forward)
    return len(unique) == len(forward) and np.array_equal(unique, np.unique(backward))
