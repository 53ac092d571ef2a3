"""Where a part that is longer than the bed is cut: into as few pieces as fit, as equal as its hinges let them be.

A line goes straight across the part as it lies on the bed. It keeps clear of the part's own knuckles and of the bores
of their pins, has plain plate around every tongue, and leaves no piece shorter than `LEAST_PIECE`. Places are tried
from the ideal one outwards, those first at which nothing begins or ends; a piece that is still too long is cut again,
either way. Costs a few booleans a place.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from foldfab.errors import FabricationError
from foldfab.fabrication import solids
from foldfab.fabrication.printed import printed
from foldfab.fabrication.seams import MOST_REACH, Kind, Tongue, parted, tongues
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
ROOM = (MOST_REACH + 2 * ROOT) / 2 + 1.0
"""What is left free on either side of an ideal place for a line, mm, with room for it to move."""
PLAIN = 2e-3
"""A share of a volume that is rounding."""
SLICE = 0.1
"""Height of the strip in which the width of a plate is taken, mm."""
SHARES = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9)
"""Where that is done, in shares of its height."""
ALIKE = 0.9
"""A width that is at least this share of another is about the same."""


Size = tuple[float, float]
"""mm."""


@dataclass(frozen=True, slots=True)
class Plate:
    """What a line cuts, in the frame of its seam, mm."""

    low: float
    high: float
    """From where to where along the line."""
    y: float
    """A height at which it is that wide."""
    half: float
    """Half its thickness."""


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
    bed: Size
    fit: float
    turn: Array
    """(3, 3) rows: the bed's x, y and z as the part lies, canonical frame."""
    taken: tuple[Array, ...]
    """(n, 3) corners of each thing that no line may come near, canonical frame."""

    def size(self, piece: Piece) -> Size:
        """Length and width on the bed, mm."""
        x, y = np.ptp(solids.mesh(piece.solid)[0] @ self.turn[:2].T, axis=0).tolist()
        return x, y

    def fits(self, piece: Piece) -> bool:
        """Whether a piece fits the bed, one way round or the other."""
        return not ways(self.size(piece), self.bed)


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
    for cut_side, limits in ways(stock.size(piece), stock.bed):
        side, other, up = stock.turn
        # Rows x, y, z of the seam's frame: right-handed, with z along what is too long.
        frame = np.stack([other, up, side] if cut_side == 0 else [-side, up, other])
        local = solids.placed(piece.solid, np.zeros(3), frame.T)
        low, high = solids.bounds(local)
        near = [block for block in (corners @ frame.T for corners in taken) if _is_near(block, low, high)]
        reaches = [(float(block[:, 2].min()), float(block[:, 2].max())) for block in near]
        spared = ideals(float(low[0]), float(high[0]), limits[1 - cut_side])
        for at, is_strict in _places(float(low[2]), float(high[2]), limits[cut_side]):
            found = _spared(_line(local, at, stock.fit, reaches, is_strict=is_strict), spared)
            made = _apart(piece, frame, tuple(tongue for tongue, _ in found), at, stock.fit) if found else []
            if made and all(np.ptp(solids.mesh(p.solid)[0] @ frame[2]) >= LEAST_PIECE for p in made):
                return made, [_key(tongue, plate, at, stock.fit, frame) for tongue, plate in found]
    x, y = stock.size(piece)
    told = f"{stock.name}, {x:.0f} x {y:.0f} mm here, is longer than the bed, and its hinges leave no place to cut it"
    raise FabricationError(f"{told}; print at a smaller scale, or fold along another direction")


def _is_near(block: Array, low: Array, high: Array) -> bool:
    """Whether corners (n, 3) reach into what lies between two others (3,)."""
    return bool((block.min(axis=0) < high).all() and (low < block.max(axis=0)).all())


def ways(size: Size, bed: Size) -> list[tuple[int, Size]]:
    """Which of its sides to cut, and how long pieces may be either way, the fewest pieces first; none where it fits."""
    found = []
    for limits in (bed, bed[::-1]):
        counts = [count_of(length, limit) for length, limit in zip(size, limits, strict=True)]
        if counts == [1, 1]:
            return []
        found += [(counts[0] * counts[1], -limits[side], side, limits) for side in (0, 1) if counts[side] > 1]
    return [(side, limits) for _, _, side, limits in sorted(set(found))]


def count_of(length: float, limit: float) -> int:
    """How many pieces it takes, all but the last with a tongue at its end."""
    return 1 if length <= limit else max(2, int(np.ceil((length - MOST_REACH) / (limit - MOST_REACH))))


def ideals(low: float, high: float, limit: float) -> list[float]:
    """Where lines would make the fewest pieces that are as long as each other, mm."""
    count = count_of(high - low, limit)
    return [low + (high - low) * k / count for k in range(1, count)]


def _places(low: float, high: float, limit: float) -> Iterator[tuple[float, bool]]:
    """Where to cut first, and whether nothing may begin or end there: for the fewest pieces, nearest to equal ones."""
    usable, least = limit - MOST_REACH, count_of(high - low, limit)
    for count in range(least, least + MORE + 1):
        ideal = low + (high - low) / count
        start = max(low + LEAST_PIECE, high - (count - 1) * usable - MOST_REACH)
        end = min(low + usable, high - LEAST_PIECE)
        steps = np.arange(-int((ideal - start) / STEP), int((end - ideal) / STEP) + 1)
        places = [round(float(ideal + STEP * k), 3) for k in sorted(steps.tolist(), key=lambda k: (abs(k), k))]
        yield from ((place, True) for place in places)
        yield from ((place, False) for place in places)


def _line(
    local: Solid, at: float, fit: float, taken: list[tuple[float, float]], *, is_strict: bool
) -> list[tuple[Tongue, Plate]]:
    """The tongues of a line at z = `at`, each with the plate that it is in; none where it cannot be there."""
    if any(low - ROOT < at < high + ROOT for low, high in taken):
        return []
    section = solids.section(local, at)
    found = list[tuple[Tongue, Plate]]()
    for bit in section.decompose():
        # A hole in the section is the bore of a pin.
        plate = _core(bit)
        own = tongues(plate.low, plate.high, at, fit) if len(bit.to_polygons()) == 1 else ()
        if not own:
            return []
        found += [(tongue, plate) for tongue in own]
    if not found:
        return []
    start, end = at - ROOT, at + max(tongue.reach for tongue, _ in found) + ROOT
    if any(low < end and start < high for low, high in taken):
        return []
    x0, _, x1, _ = section.bounds()
    spans = [(x0 - 1, x1 + 1)] if is_strict else [tongue.span for tongue, _ in found]
    return found if all(_is_plain(local, section, span, (start, end)) for span in spans) else []


def _spared(found: list[tuple[Tongue, Plate]], lines: list[float]) -> list[tuple[Tongue, Plate]]:
    """Those tongues that are not where another line will cross this one; all, where there would be too few."""
    free = [one for one in found if not any(one[0].span[0] < x + ROOM and x - ROOM < one[0].span[1] for x in lines)]
    return free if {plate for _, plate in free} == {plate for _, plate in found} else found


def _core(bit: Outline) -> Plate:
    """Where a plate is widest; of heights at which it is about as wide, the one nearest to its middle."""
    x0, y0, x1, y1 = bit.bounds()
    found = list[Plate]()
    for share in SHARES:
        y = y0 + share * (y1 - y0)
        strip = bit ^ solids.rectangle(np.array([(x0 + x1) / 2, y]), np.array([x1 - x0 + 1, SLICE]))
        found += [Plate(part.bounds()[0], part.bounds()[2], y, (y1 - y0) / 2) for part in strip.decompose()]
    most = max(plate.high - plate.low for plate in found)
    return next(plate for plate in found if plate.high - plate.low >= ALIKE * most)


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


def _key(tongue: Tongue, plate: Plate, at: float, fit: float, frame: Array) -> Key:
    x, y, tip = tongue.middle, plate.y, at + tongue.reach
    points = np.array([(x, y, tip - fit), (x, y, tip + fit + ROOT / 2), (plate.low, y, at), (plate.high, y, at)])
    sides = (tongue.span, (y - plate.half, y + plate.half), (at - ROOT, tip + ROOT))
    block = np.array(list(itertools.product(*sides)))
    inside, beyond, *line = points @ frame
    return Key(tongue.kind, inside, beyond, np.stack(line), plate.half, frame[2], block @ frame)
