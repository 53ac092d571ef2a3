"""Composites: furniture arranged in grids of columns × rows, for measuring how the solver scales (section 6, Table 1).

    bench     rows of benches end to end, side by side; neighbours in a row share a frame, and rows one base
    building  storeys with a table in each room
    hexagon   a honeycomb of shelves with upright dividers
    shelf     bays of five storeys that share their boards

How many units and patches there are is nowhere written down here: it follows from how the parts touch. Lengths are true
millimetres; at a print scale of 1:5 a cell is about 200 mm long and boards of 20 mm are as thick as panels.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType

import numpy as np

from foldfab.errors import Problem, RecipeError
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import FoldOptions, Part, PrintOptions, Recipe
from foldfab.recipe.printers import DEFAULT_PRINTER

MOST_CELLS = 32
"""In a column or a row; all composites up to 32 × 32 make recipes that can be read again."""
SCALE = 0.2
"""Print size over true size; given, because a large composite fits no bed."""
BOARD = 20.0
"""Thickness of every board, mm."""


def compose(kind: str, columns: int, rows: int) -> Recipe:
    """The composite of `columns` × `rows` cells; the same call always gives the same recipe.

    Raises:
        RecipeError: there is no such kind, or too few or too many cells.
    """
    problems = []
    if kind not in KINDS:
        problems.append(Problem("kind", f"should be one of {', '.join(KINDS)}, not {kind!r}"))
    if not (1 <= columns <= MOST_CELLS and 1 <= rows <= MOST_CELLS):
        text = f"should have 1 to {MOST_CELLS} columns and as many rows, such as 4x4, not {columns}x{rows}"
        problems.append(Problem("grid", text))
    if problems:
        raise RecipeError("compose", tuple(problems))
    direction, about, parts = KINDS[kind]
    return Recipe(
        f"{kind}-{columns}x{rows}",
        np.array(direction),
        tuple(parts(columns, rows)),
        FoldOptions(),
        PrintOptions(printer=DEFAULT_PRINTER, scale=SCALE),
        about=f"{about}: {columns} × {rows} cells as in the scalability test of section 6 (Table 1, Figure 20).",
    )


def grid(text: str) -> tuple[int, int]:
    """The columns and rows of a grid such as `4x3`.

    Raises:
        RecipeError: the text is not of this form.
    """
    found = re.fullmatch(r"\s*([0-9]{1,6})\s*[x×]\s*([0-9]{1,6})\s*", text)
    if found is None:
        problem = Problem("grid", f"should be columns x rows, such as 4x4, not {text!r}")
        raise RecipeError("compose", (problem,))
    return int(found[1]), int(found[2])


BAY, ROW = 393.0, 900.0
"""A bench: from frame to frame, and from one row to the next, mm."""
BAYS = 3


def _benches(columns: int, rows: int) -> Iterator[Part]:
    """Along -x: frames are bases; a seat and a back reach over three bays from frame to frame.

    Each bay is a folding unit of its own where no cycle of the hinge graph passes through two: neighbours in a row
    share one frame and rows nothing but their first frames, which rails between the feet hold together.
    """
    for row in range(rows):
        y = ROW * row
        for frame in range(BAYS * columns + 1):
            x = BAY * frame
            yield _box(f"leg-front-{row}-{frame}", (x, y - 175, 190), (BOARD, 50, 380))
            yield _box(f"leg-back-{row}-{frame}", (x, y + 175, 190), (BOARD, 50, 380))
            yield _box(f"bearer-{row}-{frame}", (x, y, 405), (BOARD, 400, 50))
            yield _box(f"post-{row}-{frame}", (x, y + 175, 640), (BOARD, 50, 420))
        for column in range(columns):
            middle, length = BAYS * BAY * (column + 0.5), BAYS * BAY
            yield _box(f"seat-{row}-{column}", (middle, y - 40, 440), (length, 320, BOARD))
            yield _box(f"back-{row}-{column}", (middle, y + 140, 690), (length, BOARD, 280))
        if row:
            yield _box(f"rail-{row}", (0, y - ROW / 2, 75), (BOARD, ROW - 400, 50))


ROOM, STOREY, DEEP = 1250.0, 520.0, 800.0
"""A room: its width from wall to wall, its height from slab to slab and its depth, mm."""
TABLE, TABLE_WIDE, TABLE_AT = 220.0, 520.0, 480.0
"""Height of a table's board over the slab's, its width, and how far its middle is from the left wall, mm: the right
wall can swing over beside it."""


def _building(columns: int, rows: int) -> Iterator[Part]:
    """Along -z: walls stand between slabs that the rooms of a storey share; in each stands a table on three boards.

    The walls of a storey are one unit, through the cycles of wall and slab, and so is each table.
    """
    width = ROOM * columns
    for floor in range(rows + 1):
        yield _box(f"slab-{floor}", (width / 2, 0, STOREY * floor), (width + BOARD, DEEP, BOARD))
    for row in range(rows):
        low = STOREY * row
        for wall in range(columns + 1):
            yield _upright(f"wall-{row}-{wall}", ROOM * wall, low, low + STOREY, DEEP)
        for column in range(columns):
            middle = ROOM * column + TABLE_AT
            yield _box(f"table-{row}-{column}", (middle, 0, low + TABLE), (TABLE_WIDE, DEEP / 2, BOARD))
            for number, x in enumerate((-0.45, 0.0, 0.45), 1):
                name = f"table-leg-{number}-{row}-{column}"
                yield _upright(name, middle + x * TABLE_WIDE, low, low + TABLE, DEEP / 2)


EDGE, HALF, HEXAGON_DEEP = 800.0, 320.0, 300.0
"""A hexagon: its level edge, half its height and its depth, mm."""
LEAN = HALF * float(np.tan(np.radians(30.0)))
"""How far a slanted wall reaches sideways, mm."""
LEDGE, RECESS, APART = 60.0, 120.0, 200.0
"""A ledge at the outer joints; how far a middle shelf keeps off the walls; from divider to divider, mm."""


def _hexagons(columns: int, rows: int) -> Iterator[Part]:
    """Along -z: walls lean to and fro between columns of cells that are offset by half a cell, from ground to roof.

    At every second level a column has a board from wall to wall, where it is narrow, and at the levels between a
    middle shelf that touches no wall; three dividers stand in each half of a cell. Two columns and more are one unit,
    because each bridges the boards of its neighbour; a single column hangs together by one board from cell to cell,
    and each of its cells is a unit.
    """
    pitch, levels = EDGE + LEAN, 2 * rows
    left, right = _vertex(0, 0) - LEDGE, _vertex(columns, 0) + LEDGE
    for end, level in (("ground", 0), ("roof", levels)):
        yield _box(end, ((left + right) / 2, 0, HALF * level), (right - left, HEXAGON_DEEP, BOARD))
    for level in range(levels):
        for line in range(columns + 1):
            foot, top = _vertex(line, level), _vertex(line, level + 1)
            yield _leaning(f"wall-{level}-{line}", foot, top, HALF * level, HALF * (level + 1), HEXAGON_DEEP)
        for column in range(columns):
            middle = pitch * (column + 0.5)
            for number in (1, 2, 3):
                name = f"divider-{number}-{level}-{column}"
                yield _upright(name, middle + APART * (number - 2), HALF * level, HALF * (level + 1), HEXAGON_DEEP)
    for level in range(1, levels):
        yield from _honeycomb_level(columns, level)


def _honeycomb_level(columns: int, level: int) -> Iterator[Part]:
    """The boards and middle shelves of one level, and ledges where walls meet at neither."""
    pitch, height = EDGE + LEAN, HALF * level
    for column in range(columns):
        is_narrow = (column + level) % 2 == 0
        name, width = ("board", EDGE + BOARD) if is_narrow else ("shelf", EDGE + 2 * LEAN - 2 * RECESS)
        yield _box(f"{name}-{level}-{column}", (pitch * (column + 0.5), 0, height), (width, HEXAGON_DEEP, BOARD))
    for line, side in ((0, -1), (columns, 1)):
        if (_vertex(line, level) - pitch * line) * side > 0:
            x = _vertex(line, level) + side * (LEDGE - BOARD) / 2
            yield _box(f"ledge-{level}-{line}", (x, 0, height), (LEDGE, HEXAGON_DEEP, BOARD))


def _vertex(line: int, level: int) -> float:
    """Where the line of walls before column `line` is at a level, x in mm: to the right where that column is narrow."""
    return (EDGE + LEAN) * line + (LEAN / 2 if (line + level) % 2 == 0 else -LEAN / 2)


SHELVES, CLEAR, BAY_WIDE, SHELF_DEEP = 5, 250.0, 900.0, 300.0
"""A bay of shelves: its storeys, their height from board to board, its width and its depth, mm."""


def _shelves(columns: int, rows: int) -> Iterator[Part]:
    """Along -z: five storeys a bay, three uprights a storey; the bays of a row share their boards.

    A storey is a unit, through the cycles of upright and board.
    """
    width = BAY_WIDE * columns
    for level in range(SHELVES * rows + 1):
        yield _box(f"board-{level}", (width / 2, 0, CLEAR * level), (width, SHELF_DEEP, BOARD))
    for level in range(SHELVES * rows):
        for column in range(columns):
            for number, share in enumerate((1 / 6, 1 / 2, 5 / 6), 1):
                name, x = f"upright-{number}-{level}-{column}", BAY_WIDE * (column + share)
                yield _upright(name, x, CLEAR * level, CLEAR * (level + 1), SHELF_DEEP)


KINDS: Mapping[str, tuple[tuple[float, float, float], str, Callable[[int, int], Iterator[Part]]]] = MappingProxyType(
    {
        "bench": ((-1.0, 0.0, 0.0), "Benches in rows", _benches),
        "building": ((0.0, 0.0, -1.0), "A building of rooms with tables", _building),
        "hexagon": ((0.0, 0.0, -1.0), "A honeycomb of shelves", _hexagons),
        "shelf": ((0.0, 0.0, -1.0), "Bays of shelves", _shelves),
    }
)
"""By name: the folding direction, what it is, and its parts by columns and rows."""


def _box(name: str, center: tuple[float, ...], size: tuple[float, ...], axes: Array | None = None) -> Part:
    return Part(name, np.array(center), np.array(size), np.eye(3) if axes is None else axes)


def _upright(name: str, x: float, low: float, high: float, depth: float) -> Part:
    """A board that faces x, from the face of the board whose middle is at `low` to that of the one at `high`."""
    return _box(name, (x, 0, (low + high) / 2), (BOARD, depth, high - low - BOARD))


def _leaning(name: str, foot: float, top: float, low: float, high: float, depth: float) -> Part:
    """The same, leaning from x = `foot` to x = `top`."""
    tilt = float(np.arctan2(top - foot, high - low))
    sine, cosine = np.sin(tilt), np.cos(tilt)
    axes = np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])
    length = float(np.hypot(top - foot, high - low)) - BOARD / cosine
    return _box(name, ((foot + top) / 2, 0, (low + high) / 2), (BOARD, depth, length), axes)
