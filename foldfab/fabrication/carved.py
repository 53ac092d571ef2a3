"""A part's own solid in place of its plate: within the layer that it folds in, and beyond it where there is room.

Around hinges the plain plate stays, and the two are one body. Columns of the solid that are too thin are left out.
Where too little would be left the reason is told instead.
"""

from __future__ import annotations

from collections.abc import Iterator

from foldfab.fabrication import solids
from foldfab.fabrication.free import Motion, free_room
from foldfab.fabrication.places import FAR, Place, zone
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, common, union
from foldfab.fabrication.solids import Outline, Solid

KEPT = 0.8
"""The least share of its plate that is left: with less, it is no longer the part that was analysed."""
LEAST, LEAST_SHARE = 1.2, 0.5
"""Least thickness: three lines of a 0.4 mm nozzle, mm, and a share of the plate."""
TIP = 0.8
"""Half the width below which a tip or a wall is left out, mm."""
SMALL = 10.0
"""Room smaller than this is not worth a bump, mm²."""
MUCH = 0.3
"""Nor is room that less than this share of the solid has at that height."""
RISES = 0.75
"""How far a wide part may rise beyond its plate, in thicknesses of panels: for looks, not for bulk."""
NARROW = 1.25
"""A part is narrow that reaches no further than this to either side, in thicknesses of panels."""
SUNK = 0.3
"""What rises from a layer begins this deep in it, mm."""
FINE = 0.05
"""How far an outline may be from the solid's own, mm."""


Room = tuple[Outline, float, float]
"""What is free: over an outline in u and v, from a height to another."""


def carved(
    place: Place, plain: Shape, own: Shape, stays: Outline, motions: list[Motion], gap: float, panel: float
) -> Iterator[Shape | str]:
    """The plate with the part's own solid in its place, or why that cannot be; then with less of what rises from it.

    `own` is the part's own solid, open posture, canonical frame, mm. The plain plate stays around hinges and where
    `stays` says, in u and v; `motions` are all other bodies, `gap` is the clearance and `panel` K of the print, mm.
    """
    laid, seen = place.plane.laid(printed(own)), solids.silhouette(place.plane.laid(printed(plain)))
    low, high = place.layer
    layer = [(seen - zone(place.shy), low, high)]
    sides = [_beyond(place, laid, is_above, seen, motions, gap, panel) for is_above in (True, False)]
    least = max(LEAST, LEAST_SHARE * min(high - low, panel))
    for above, below in ((True, True), (True, False), (False, True), (False, False)):
        if (sides[0] or not above) and (sides[1] or not below):
            rooms = layer + sides[0] * above + sides[1] * below
            yield _filled(place, plain, own, laid, seen, zone(place.kept) + stays, rooms, least)


def _filled(
    place: Place, plain: Shape, own: Shape, laid: Solid, seen: Outline, kept: Outline, rooms: list[Room], least: float
) -> Shape | str:
    """The plain plate where it is kept, and the own solid in the rooms."""
    rooms = _thick_enough(rooms, laid, kept, least)
    left, whole = kept, solids.silhouette(laid)
    for room, _, _ in rooms:
        left = left + (room ^ whole)
    share = (left ^ seen).area() / max(seen.area(), 1e-9)
    columns = [piece for room, low, high in rooms for piece in place.plane.columns(room, low, high)]
    if share < KEPT or not columns:
        return f"would leave {share:.0%} of it, because it is thin or leaves the layer that it folds in"
    core = [common(plain, union(place.plane.columns(kept, -FAR, FAR)))] if not kept.is_empty() else []
    return union([*core, common(own, union(columns))])


def _beyond(
    place: Place, laid: Solid, is_above: bool, seen: Outline, motions: list[Motion], gap: float, panel: float
) -> list[Room]:
    """The free room at one side of the layer."""
    face = place.layer[int(is_above)]
    sunk = min(SUNK, (place.layer[1] - place.layer[0]) / 2)
    most = FAR if _is_narrow(seen, panel) else RISES * panel
    wanted = (solids.silhouette(laid) ^ seen).area()
    found = []
    for free, height in free_room(place, laid, is_above, most, motions, gap):
        room = _smooth(free ^ seen)
        if room.area() >= MUCH * wanted:
            low, high = sorted((face - sunk if is_above else face + sunk, height))
            found.append((room, low, high))
    return found


def _is_narrow(seen: Outline, panel: float) -> bool:
    return bool(solids.grown(seen, -NARROW * panel).is_empty())


def _thick_enough(rooms: list[Room], laid: Solid, kept: Outline, least: float) -> list[Room]:
    """The rooms without columns in which the solid is too thin, and without what then hangs on nothing."""
    made = solids.common(laid, solids.union([solids.raised(room, a, b) for room, a, b in rooms if not room.is_empty()]))
    thick = _smooth(solids.silhouette(solids.common(made, solids.shifted(made, least))))
    pieces = solids.islands(thick + kept)
    whole = max(pieces, key=lambda piece: piece.area()) if pieces else thick
    return [(room ^ thick ^ whole, low, high) for room, low, high in rooms]


def _smooth(outline: Outline) -> Outline:
    """Without tips, bits and detail that no nozzle shows."""
    opened = solids.grown(solids.grown(outline, -TIP), TIP) ^ outline
    bits = [bit for bit in solids.islands(opened) if bit.area() >= SMALL]
    found = solids.nothing()
    for bit in bits:
        found = found + bit
    return found.simplify(FINE)
