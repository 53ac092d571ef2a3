"""A plate cut to the outline of the parts that it stands for, seen along its normal.

Around hinges the plain plate stays. Where too little would be left the reason is told instead.
"""

from __future__ import annotations

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.places import FAR, FINE, Place, zone
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, cut
from foldfab.fabrication.solids import Outline
from foldfab.geometry.arrays import Array, Indices

KEPT = 0.8
"""What is left has to be near this share of its plate: with less, it is no longer the part that was analysed."""
HALF = 0.4
"""And it has to be this share itself."""
SMALL = 2.0
"""Bits of less than this are not cut away, mm²."""
TIP = 0.8
"""Half the width at which a tip ends, mm."""


def outlined(place: Place, plain: Shape, meshes: list[tuple[Array, Indices]]) -> Shape | str:
    """The plate without what is around its parts, or why it stays plain.

    `meshes` are those of its parts, vertices (n, 3) and faces (m, 3), canonical frame, mm; they need not be closed.
    """
    seen = solids.silhouette(place.plane.laid(printed(plain)))
    stays = zone(place.kept)
    for points, faces in meshes:
        stays = stays + place.plane.silhouette(points, faces)
    # Tips that run out thinner than a few lines are left out with what is cut away.
    left = solids.grown(solids.grown(seen ^ stays, -TIP), TIP)
    share = share_left(left, seen, place)
    if share < KEPT:
        return f"would leave {share:.0%} of it"
    bits = [bit for bit in _around(seen, left) if (bit ^ seen).area() > SMALL and len(bit.to_polygons()) == 1]
    if not bits:
        return plain
    grown = [solids.grown(bit, FINE / 5) for bit in bits]
    return cut(plain, [hole for bit in grown for hole in place.plane.columns(bit, -FAR, FAR)])


def share_left(left: Outline, seen: Outline, place: Place) -> float:
    """The share of a plate that lies within a thickness of what is left of it; of what is left where that is little."""
    whole = max(seen.area(), 1e-9)
    share = (left ^ seen).area() / whole
    thick = place.layer[1] - place.layer[0]
    return float((solids.grown(left, thick) ^ seen).area() / whole) if share >= HALF else float(share)


def _around(seen: Outline, left: Outline) -> list[Outline]:
    """What lies around an outline, by quarters, and beyond the edges of what is seen: no skin is left along them."""
    x0, y0, x1, y1 = seen.bounds()
    middle, size = np.array([x0 + x1, y0 + y1]) / 2, np.array([x1 - x0, y1 - y0])
    rest = solids.grown(seen, TIP) - left
    quarters = [middle + size * (np.array([x, y]) - 0.5) for x in (0, 1) for y in (0, 1)]
    sides = size + FINE
    return [bit for quarter in quarters for bit in solids.islands(rest ^ solids.rectangle(quarter, sides))]
