"""How much of the printer's room a solution takes in a posture, before there are any solids."""

from __future__ import annotations

import numpy as np

from foldfab.fabrication.posture import bed_turn, open_turn
from foldfab.folding.anatomy import base_boxes
from foldfab.folding.kinematics import size_at
from foldfab.folding.model import FoldSolution, Thickness
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import bounds
from foldfab.recipe.model import Posture, Recipe
from foldfab.scaffold.model import BasePatch

PLATE_RIM = 1.0
"""By how much a base's plate may reach beyond its outlines, mm."""


def share_of_bed(solution: FoldSolution, posture: Posture) -> float:
    """How much of the build volume it takes, 1 where it just fits; of its largest part where each lies for itself."""
    bed = np.array(solution.scaffold.recipe.print.printer.build_volume)
    if posture == "plate":
        return max(_share(np.append(size, 0.0), bed) for size in _footprints(solution))
    if posture == "open":
        return _share(size_at(solution, 0.0, open_turn(solution.scaffold)), bed)
    up = solution.chains[0].along if posture == "edge" and solution.chains else None
    return _share(size_at(solution, 1.0, bed_turn(up)), bed)


def largest_scale(recipe: Recipe, posture: Posture, size: Array, bed: Array) -> float:
    """A first guess at the largest scale that fits: `size` (3,) true, d as its z unless open; `bed` (3,) mm."""
    size = np.maximum(size, 1e-9)
    if posture == "plate":
        widest = np.array([np.sort(part.size)[:0:-1] for part in recipe.parts]).max(axis=0)
        size = np.array([*widest, 1e-9])
    elif posture == "edge":
        standing = [[size[0], 1e-9, size[1]], [size[1], 1e-9, size[0]]]
        return max(1 / _share(np.array(s), bed) for s in standing)
    elif posture == "folded":
        size = np.array([size[0], size[1], 1e-9])
    return 1 / _share(size, bed)


def footprint(base: BasePatch, thickness: Thickness) -> tuple[Array, Array]:
    """Lower and upper corner (2,) of a base's plate, mm."""
    low, high = bounds(base_boxes(base, thickness))
    return low.min(axis=0)[:2] - PLATE_RIM, high.max(axis=0)[:2] + PLATE_RIM


def _share(size: Array, bed: Array) -> float:
    """Either way round."""
    return float(min((size / bed).max(), (size[[1, 0, 2]] / bed).max()))


def _footprints(solution: FoldSolution) -> list[Array]:
    """(2,) length and width of each part, flat on the bed, mm."""
    found = []
    for base in solution.scaffold.bases:
        low, high = footprint(base, solution.thickness)
        found.append(high - low)
    for chain in solution.chains:
        width = float(np.ptp(chain.span))
        found += [np.array([float(length) + 2 * chain.panel, width]) for length in chain.lengths]
    return found
