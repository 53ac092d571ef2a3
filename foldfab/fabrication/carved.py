"""A part's own solid in place of its plate: within the layer that it folds in, and beyond it where there is room.

Around hinges the plain plate stays, and the two are one body. Columns of the solid that are too thin are left out.
Where too little would be left the reason is told instead.
"""

from __future__ import annotations

from collections.abc import Iterator

from foldfab.fabrication import solids
from foldfab.fabrication.free import Motion, used_room
from foldfab.fabrication.outlines import KEPT, share_left
from foldfab.fabrication.places import FAR, FINE, Place, zone
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, common, union
from foldfab.fabrication.solids import Outline, Solid

LEAST, LEAST_SHARE = 1.2, 0.5
"""Least thickness: three lines of a 0.4 mm nozzle, mm, and a share of the plate."""
TIP = 0.8
"""Half the width below which a tip or a wall is left out, mm."""
SMALL = 10.0
"""Room smaller than this is not worth a bump, mm²."""
MUCH = 0.6
"""Nor is room that less than this share of the solid has at that height."""
RISES = 0.75
"""How far a wide part may rise beyond its plate, in thicknesses of panels: for looks, not for bulk."""
NARROW = 1.25
"""A part is narrow that reaches no further than this to either side, in thicknesses of panels."""
SUNK = 0.3
"""What rises from a layer begins this deep in it, mm."""
INSET, BEYOND = 0.02, 1.0
"""How far rooms keep from faces of plates and from one another, where faces that coincide would leave slivers; and how
far they reach beyond a plate, mm."""
ODD = (0.0137, 0.0071)
"""Off which corners cuts are set, mm."""
HAIR = 0.12
"""What is less beside something good is not worth a cut, mm."""


Room = tuple[Outline, float, float]
"""What is free: over an outline in u and v, from a height to another."""


def carved(
    place: Place, plain: Shape, own: Shape, stays: Outline, motions: list[Motion], gap: float, panel: float
) -> Iterator[Shape | str]:
    """The plate with the part's own solid in its place, or why that cannot be; then with less of what rises from it.

    `own` is the part's own solid, open posture, canonical frame, mm. The plain plate stays around hinges and where
    `stays` says, in u and v; `motions` are all other bodies, `gap` is the clearance and `panel` K of the print, mm.
    """
    seen = solids.silhouette(place.plane.laid(printed(plain)))
    # Where a part ends flush with its plate all rooms reach beyond it, and one cut ends it.
    around, laid = solids.grown(seen, BEYOND), solids.common(place.plane.laid(printed(own)), _raised(seen))
    low, high = place.layer
    layer = [(around - zone(place.shy), low + INSET, high - INSET)]
    sides = [_beyond(place, laid, is_above, around, motions, gap, panel) for is_above in (True, False)]
    least, kept = max(LEAST, LEAST_SHARE * min(high - low, panel)), zone(place.kept) + stays
    for above, below in ((True, True), (True, False), (False, True), (False, False)):
        if (sides[0] or not above) and (sides[1] or not below):
            rooms = layer + sides[0] * above + sides[1] * below
            made = solids.common(laid, solids.union([solids.raised(*room) for room in rooms if not room[0].is_empty()]))
            yield _filled(place, plain, own, made, seen, kept, rooms, _thick_enough(made, kept, least))


def _filled(
    place: Place, plain: Shape, own: Shape, made: Solid, seen: Outline, kept: Outline, rooms: list[Room], thick: Outline
) -> Shape | str:
    """The plain plate where it is kept, and the own solid in the rooms where it is thick enough."""
    share = share_left(kept + thick, seen, place)
    inset = [(solids.grown(room, -INSET * i), low, high) for i, (room, low, high) in enumerate(rooms)]
    trim = _without(solids.grown(seen, -INSET), solids.silhouette(made), thick)
    inset, trim = [(_aside(room), low, high) for room, low, high in inset], _aside(trim)
    columns, ends = ([p for room in some for p in place.plane.columns(*room)] for some in (inset, [(trim, -FAR, FAR)]))
    if share < KEPT or not columns or not ends:
        return f"would leave {share:.0%} of it, because it is thin or leaves the layer that it folds in"
    core = [common(plain, union(place.plane.columns(kept, -FAR, FAR)))] if not kept.is_empty() else []
    return union([*core, common(common(own, union(ends)), union(columns))])


def _aside(outline: Outline) -> Outline:
    """The outline a trifle off: drawn from the corners of a solid, it would else cut just through them."""
    return outline.translate(ODD)


def _raised(outline: Outline) -> Solid:
    return solids.raised(outline, -FAR, FAR)


def _beyond(
    place: Place, laid: Solid, is_above: bool, around: Outline, motions: list[Motion], gap: float, panel: float
) -> list[Room]:
    """The free room at one side of the layer, within what lies around the plate."""
    face = place.layer[int(is_above)]
    sunk = min(SUNK, (place.layer[1] - place.layer[0]) / 2)
    most = FAR if _is_narrow(around, panel) else RISES * panel
    whole = solids.silhouette(laid)
    found = []
    for used, height in used_room(place, laid, is_above, most, motions, gap):
        free = around - used - zone(place.bare[int(is_above)])
        room = _without(free, free ^ whole, _smooth(free ^ whole))
        if (room ^ whole).area() >= MUCH * whole.area():
            low, high = sorted((face - sunk if is_above else face + sunk, height))
            found.append((room, low, high))
    return found


def _is_narrow(around: Outline, panel: float) -> bool:
    return bool(solids.grown(around, -BEYOND - NARROW * panel).is_empty())


def _thick_enough(made: Solid, kept: Outline, least: float) -> Outline:
    """Where a solid is thick enough, but for what then hangs on nothing that is kept."""
    thick = _smooth(solids.silhouette(solids.common(made, solids.shifted(made, least))))
    pieces = solids.islands(thick + kept)
    return thick ^ max(pieces, key=lambda piece: piece.area()) if pieces else thick


def _without(room: Outline, whole: Outline, good: Outline) -> Outline:
    """A room without what of the whole is not good; what lies within a hair of it is."""
    return room - solids.grown(whole - solids.grown(good, HAIR), HAIR / 2)


def _smooth(outline: Outline) -> Outline:
    """Without tips, bits and detail that no nozzle shows."""
    opened = solids.grown(solids.grown(outline, -TIP), TIP) ^ outline
    bits = [bit for bit in solids.islands(opened) if bit.area() >= SMALL]
    found = solids.nothing()
    for bit in bits:
        found = found + bit
    return found.simplify(FINE)
