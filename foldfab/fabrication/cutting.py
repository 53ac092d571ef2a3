"""Where a part that is longer than the bed is cut: into as few pieces as fit, as equal as its hinges let them be.

A line goes straight across the part as it lies on the bed. It keeps clear of the part's own knuckles and of the bores
of their pins, has plain plate around every tongue, and leaves no piece shorter than `LEAST_PIECE`. Places are tried
from the ideal one outwards, those first at which nothing begins or ends; a piece that is still too long is cut again,
either way. Costs a few booleans a place.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from foldfab.errors import FabricationError
from foldfab.fabrication import solids
from foldfab.fabrication.printed import printed
from foldfab.fabrication.seams import MOST_SPLICE, Kind, Tongue, parted, tongues
from foldfab.fabrication.shapes import Shape, cut, placed, prism
from foldfab.fabrication.solids import Outline, Solid
from foldfab.fabrication.walls import thin_sides
from foldfab.geometry.arrays import Array

LEAST_PIECE = 15.0
"""Shorter pieces are not made, mm."""
ROOT = 2.0
"""Plain plate behind a tongue and beyond its socket, mm."""
STEP = 1.0
"""Places are tried at this distance, mm."""
MORE = 2
"""By how many pieces more than needed a part may be cut, where hinges are in the way."""
PLAIN = 2e-3
"""A share of a volume that is rounding."""
SLICE = 0.1
"""Height of the strip in which the width of a plate is taken, mm."""


Ends = tuple[float, float, float, float]
"""Least x and y, greatest x and y of a plate in a section, mm."""


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A part, or a piece of it: open posture, canonical frame."""

    solid: Solid
    shape: Shape


@dataclass(frozen=True, slots=True, eq=False)
class Key:
    """A tongue that was made, canonical frame, mm."""

    kind: Kind
    inside: Array
    """(3,) a point in the tongue."""
    beyond: Array
    """(3,) a point of the plate beyond its socket."""
    line: Array
    """(2, 3) ends of the line that was cut."""
    half: float
    """Half the thickness of the plate there."""
    pull: Array
    """(3,) unit vector from the piece that has it to the one that holds it."""
    corners: Array
    """(8, 3) of what it takes up."""


@dataclass(frozen=True, slots=True, eq=False)
class Stock:
    """What all pieces of a part have in common."""

    name: str
    bed: tuple[float, float]
    fit: float
    turn: Array
    """(3, 3) rows: the bed's x, y and z as the part lies, canonical frame."""
    taken: tuple[Array, ...]
    """(n, 3) corners of each thing that no line may come near, canonical frame."""

    def size(self, piece: Piece) -> tuple[float, float]:
        """Length and width on the bed, mm."""
        x, y = np.ptp(solids.mesh(piece.solid)[0] @ self.turn[:2].T, axis=0).tolist()
        return x, y

    def fits(self, piece: Piece) -> bool:
        """Whether a piece fits the bed, one way round or the other."""
        x, y = self.size(piece)
        return any(x <= width and y <= depth for width, depth in (self.bed, self.bed[::-1]))


def cut_up(whole: Piece, stock: Stock) -> tuple[list[Piece], list[Key]]:
    """The pieces of a part, each of which fits the bed, and the tongues between them.

    Raises:
        FabricationError: there is no place to cut it; the message says what to try.
    """
    done, todo, keys = list[Piece](), [whole], list[Key]()
    while todo:
        piece = todo.pop()
        if stock.fits(piece):
            done.append(piece)
            continue
        parts, made = _cut(piece, stock, [*stock.taken, *(key.corners for key in keys)])
        todo, keys = todo + parts, keys + made
    return sorted(done, key=lambda piece: _place(piece, stock)), keys


def _place(piece: Piece, stock: Stock) -> tuple[float, ...]:
    return tuple(np.round(solids.mesh(piece.solid)[0] @ stock.turn.T, 2).mean(axis=0).tolist())


def _cut(piece: Piece, stock: Stock, taken: list[Array]) -> tuple[list[Piece], list[Key]]:
    """Cuts a piece once."""
    for across, limit in _ways(stock.size(piece), stock.bed):
        side, other, up = stock.turn
        # Rows x, y, z of the seam's frame: right-handed, with z along what is too long.
        frame = np.stack([other, up, side] if across == 0 else [-side, up, other])
        local = solids.placed(piece.solid, np.zeros(3), frame.T)
        reaches = [(float(z.min()), float(z.max())) for z in (corners @ frame[2] for corners in taken)]
        for at, is_strict in _places(local, limit):
            found = _line(local, at, stock.fit, reaches, is_strict=is_strict)
            made = _apart(piece, frame, tuple(tongue for tongue, _ in found), at, stock.fit) if found else []
            if made and all(np.ptp(solids.mesh(p.solid)[0] @ frame[2]) >= LEAST_PIECE for p in made):
                return made, [_key(tongue, ends, at, stock.fit, frame) for tongue, ends in found]
    x, y = stock.size(piece)
    told = f"{stock.name}, {x:.0f} x {y:.0f} mm here, is longer than the bed, and its hinges leave no place to cut it"
    raise FabricationError(f"{told}; print at a smaller scale, or fold along another direction")


def _ways(size: tuple[float, float], bed: tuple[float, float]) -> list[tuple[int, float]]:
    """Across which side of the bed's two it can be cut and how long pieces may be, the fewest pieces first."""
    found = []
    for limits in (bed, bed[::-1]):
        counts = [int(np.ceil(length / limit)) for length, limit in zip(size, limits, strict=True)]
        found += [(counts[0] * counts[1], across, limits[across]) for across in (0, 1) if counts[across] > 1]
    return [(across, limit) for _, across, limit in sorted(set(found))]


def _places(local: Solid, limit: float) -> Iterator[tuple[float, bool]]:
    """Where to cut first, and whether nothing may begin or end there: for the fewest pieces, nearest to equal ones."""
    low, high = (float(corner[2]) for corner in solids.bounds(local))
    usable = limit - MOST_SPLICE
    least = int(np.ceil((high - low - MOST_SPLICE) / usable))
    for count in range(max(least, 2), max(least, 2) + MORE + 1):
        ideal = low + (high - low) / count
        start = max(low + LEAST_PIECE, high - (count - 1) * usable - MOST_SPLICE)
        end = min(low + usable, high - LEAST_PIECE)
        steps = np.arange(-int((ideal - start) / STEP), int((end - ideal) / STEP) + 1)
        places = [round(float(ideal + STEP * k), 3) for k in sorted(steps.tolist(), key=lambda k: (abs(k), k))]
        yield from ((place, True) for place in places)
        yield from ((place, False) for place in places)


def _line(
    local: Solid, at: float, fit: float, taken: list[tuple[float, float]], *, is_strict: bool
) -> list[tuple[Tongue, Ends]]:
    """The tongues of a line at z = `at`, each with the plate that it is in; none where it cannot be there."""
    if any(low - ROOT < at < high + ROOT for low, high in taken):
        return []
    section = solids.section(local, at)
    found = list[tuple[Tongue, Ends]]()
    for bit in section.decompose():
        # A hole in the section is the bore of a pin.
        own = tongues(*_core(bit), at, fit) if len(bit.to_polygons()) == 1 else ()
        if not own:
            return []
        found += [(tongue, bit.bounds()) for tongue in own]
    if not found:
        return []
    start, end = at - ROOT, at + max(tongue.reach for tongue, _ in found) + ROOT
    if any(low < end and start < high for low, high in taken):
        return []
    x0, _, x1, _ = section.bounds()
    spans = [(x0 - 1, x1 + 1)] if is_strict else [tongue.span for tongue, _ in found]
    return found if all(_is_plain(local, section, span, (start, end)) for span in spans) else []


def _core(bit: Outline) -> tuple[float, float]:
    """From where to where a plate is whole at half its height."""
    x0, y0, x1, y1 = bit.bounds()
    middle = solids.rectangle(np.array([x0 + x1, y0 + y1]) / 2, np.array([x1 - x0 + 1, SLICE]))
    parts = [part.bounds() for part in (bit ^ middle).decompose()]
    return max(((part[0], part[2]) for part in parts), key=lambda ends: ends[1] - ends[0], default=(0.0, 0.0))


def _is_plain(local: Solid, section: Outline, x: tuple[float, float], z: tuple[float, float]) -> bool:
    """Whether what lies between two x and two z looks everywhere as in the section."""
    low, high = solids.bounds(local)
    middle, sides = np.array([sum(x), low[1] + high[1]]) / 2, np.array([x[1] - x[0], high[1] - low[1] + 2])
    wanted = float((section ^ solids.rectangle(middle, sides)).area()) * (z[1] - z[0])
    block = solids.box((x[0], low[1] - 1, z[0]), (x[1], high[1] + 1, z[1]))
    return abs(solids.overlap(local, block) - wanted) <= PLAIN * wanted


def _apart(piece: Piece, frame: Array, own: tuple[Tongue, ...], at: float, fit: float) -> list[Piece]:
    """The bodies on both sides of a line; none where one of them would not print, or could not be told apart."""
    local = solids.mesh(piece.solid)[0] @ frame.T
    low, high = local.min(axis=0) - 1, local.max(axis=0) + 1
    made = list[Piece]()
    for outline in parted(own, at, fit, (low[[0, 2]], high[[0, 2]])):
        hole = placed(prism(outline, low[1], high[1]), np.zeros(3), frame)
        bits = solids.parts(solids.tidied(solids.cut(piece.solid, [printed(hole)])))
        ends = [_ends(bit, frame) for bit in bits]
        for i, bit in enumerate(bits):
            others = [end for k, end in enumerate(ends) if k != i]
            if any(_meet(ends[i], end) for end in others):
                return []
            rest = [placed(_block(end, low[1], high[1]), np.zeros(3), frame) for end in others]
            made.append(Piece(solids.tidied(bit), cut(piece.shape, [hole, *rest])))
    is_sound = all(solids.stays_closed(p.solid) for p in made)
    is_thick = is_sound and sum(thin_sides(p.solid) for p in made) <= thin_sides(piece.solid)
    return made if is_thick else []


def _ends(bit: Solid, frame: Array) -> tuple[Array, Array]:
    """Lower and upper corner (2,), x and z, in the seam's frame."""
    points = solids.mesh(bit)[0] @ frame[[0, 2]].T
    return points.min(axis=0), points.max(axis=0)


def _meet(a: tuple[Array, Array], b: tuple[Array, Array]) -> bool:
    return bool((a[0] <= b[1]).all() and (b[0] <= a[1]).all())


def _block(ends: tuple[Array, Array], low: float, high: float) -> Shape:
    (x0, z0), (x1, z1) = ends[0].tolist(), ends[1].tolist()
    return prism(((x0, z0), (x1, z0), (x1, z1), (x0, z1)), low, high)


def _key(tongue: Tongue, ends: Ends, at: float, fit: float, frame: Array) -> Key:
    (x0, y0, x1, y1), tip = ends, at + tongue.reach
    x, y = tongue.middle, (y0 + y1) / 2
    points = np.array([(x, y, tip - fit), (x, y, tip + fit + ROOT / 2), (x0, y, at), (x1, y, at)])
    block = np.array([(u, v, w) for u in tongue.span for v in (y0, y1) for w in (at - ROOT, tip + ROOT)])
    inside, beyond, *line = points @ frame
    return Key(tongue.kind, inside, beyond, np.stack(line), (y1 - y0) / 2, frame[2], block @ frame)
